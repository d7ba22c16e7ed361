//! Cameras and lights of Python's numbers.

use dotray_geometry::Vec3;
use dotray_scene::model::Attenuation;
use dotray_scene::model::Camera;
use dotray_scene::model::Light;
use pyo3::exceptions::PyValueError;
use pyo3::prelude::*;
use pyo3::types::PyDict;

/// A camera: eye, direction, up, half of the vertical angle.
pub type CameraNumbers = ([f64; 3], [f64; 3], [f64; 3], f64);

/// The camera of these numbers.
pub fn camera((position, direction, up, half_angle): CameraNumbers) -> Camera {
    let [position, direction, up] = [position, direction, up].map(Vec3::from_array);
    Camera { position, direction, up, half_angle }
}

/// A light as the Python half describes it: numbers that a kind has no use for are ignored.
#[derive(FromPyObject)]
pub struct LightNumbers {
    kind: String,
    color: [f64; 3],
    position: [f64; 3],
    direction: [f64; 3],
    attenuation: [f64; 3],
    cutoff: f64,
    dropoff: f64,
    radius: f64,
}

/// The light of these numbers.
pub fn light(numbers: &LightNumbers) -> PyResult<Light> {
    let [color, position, direction] =
        [numbers.color, numbers.position, numbers.direction].map(Vec3::from_array);
    let [constant, linear, quadratic] = numbers.attenuation;
    let attenuation = Attenuation { constant, linear, quadratic };
    let &LightNumbers { cutoff, dropoff, radius, .. } = numbers;
    Ok(match numbers.kind.as_str() {
        "point" => Light::Point { color, position, attenuation },
        "spot" => Light::Spot { color, position, direction, attenuation, cutoff, dropoff },
        "directional" => Light::Directional { color, direction },
        "area" => Light::Area { color, position, direction, radius, attenuation },
        other => return Err(PyValueError::new_err(format!("kind is {other:?}: no such light"))),
    })
}

/// The numbers of a camera.
pub fn camera_numbers(camera: &Camera) -> CameraNumbers {
    let Camera { position, direction, up, half_angle } = camera;
    (position.to_array(), direction.to_array(), up.to_array(), *half_angle)
}

/// The numbers of a light; 0 for those that its kind has no use for.
pub fn light_numbers<'py>(py: Python<'py>, light: &Light) -> PyResult<Bound<'py, PyDict>> {
    let none = Vec3::ZERO;
    let steady = Attenuation { constant: 1.0, linear: 0.0, quadratic: 0.0 };
    let (kind, color, position, direction, fading, cutoff, dropoff, radius) = match *light {
        Light::Point { color, position, attenuation } => {
            ("point", color, position, none, attenuation, 0.0, 0.0, 0.0)
        }
        Light::Spot { color, position, direction, attenuation, cutoff, dropoff } => {
            ("spot", color, position, direction, attenuation, cutoff, dropoff, 0.0)
        }
        Light::Directional { color, direction } => {
            ("directional", color, none, direction, steady, 0.0, 0.0, 0.0)
        }
        Light::Area { color, position, direction, radius, attenuation } => {
            ("area", color, position, direction, attenuation, 0.0, 0.0, radius)
        }
    };
    let told = PyDict::new(py);
    told.set_item("kind", kind)?;
    told.set_item("color", color.to_array())?;
    told.set_item("position", position.to_array())?;
    told.set_item("direction", direction.to_array())?;
    told.set_item("attenuation", [fading.constant, fading.linear, fading.quadratic])?;
    told.set_item("cutoff", cutoff)?;
    told.set_item("dropoff", dropoff)?;
    told.set_item("radius", radius)?;
    Ok(told)
}

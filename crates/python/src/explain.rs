//! Why a ray has its colour, as nested dictionaries.

use dotray_geometry::Vec3;
use dotray_render::inspect::Branch;
use dotray_render::inspect::End;
use dotray_render::inspect::LightTerm;
use dotray_render::inspect::Meeting;
use dotray_render::inspect::RayKind;
use dotray_render::inspect::RayNode;
use dotray_render::inspect::Shadow;
use pyo3::prelude::*;
use pyo3::types::PyDict;
use pyo3::types::PyList;

fn vector(v: Vec3) -> [f64; 3] {
    v.to_array()
}

/// A ray and all that came of it.
pub fn ray<'py>(py: Python<'py>, node: &RayNode) -> PyResult<Bound<'py, PyDict>> {
    let told = PyDict::new(py);
    let kind = match node.kind {
        RayKind::Eye => "eye",
        RayKind::Reflected => "reflected",
        RayKind::Refracted => "refracted",
    };
    told.set_item("kind", kind)?;
    told.set_item("depth", node.depth)?;
    told.set_item("origin", vector(node.ray.origin))?;
    told.set_item("direction", vector(node.ray.direction))?;
    told.set_item("contribution", vector(node.contribution))?;
    told.set_item("weight", vector(node.weight))?;
    told.set_item("box_tests", node.tests.boxes)?;
    told.set_item("shape_tests", node.tests.shapes)?;
    told.set_item("hit", node.meeting.as_ref().map(|met| hit(py, met)).transpose()?)?;
    told.set_item("color", vector(node.color))?;
    Ok(told)
}

fn hit<'py>(py: Python<'py>, met: &Meeting) -> PyResult<Bound<'py, PyDict>> {
    let told = PyDict::new(py);
    told.set_item("shape", met.nearest.number)?;
    told.set_item("t", met.nearest.hit.t)?;
    told.set_item("point", vector(met.surface.point))?;
    told.set_item("object_point", vector(met.surface.in_object.point))?;
    told.set_item("st", met.surface.in_object.texcoord.get().to_array())?;
    told.set_item("material", met.material)?;
    told.set_item("entering", met.entering)?;
    told.set_item("normal", vector(met.normal))?;
    told.set_item("geometric_normal", vector(met.geometric_normal))?;
    told.set_item("mirrored", vector(met.mirrored))?;
    told.set_item("texture", vector(met.texture))?;
    told.set_item("own_light", vector(met.own_light))?;
    let lights = met.lights.iter().map(|term| light(py, term)).collect::<PyResult<Vec<_>>>()?;
    told.set_item("lights", PyList::new(py, lights)?)?;
    told.set_item("reflected", branch(py, &met.reflected)?)?;
    told.set_item("refracted", branch(py, &met.refracted)?)?;
    Ok(told)
}

fn light<'py>(py: Python<'py>, term: &LightTerm) -> PyResult<Bound<'py, PyDict>> {
    let told = PyDict::new(py);
    told.set_item("light", term.light)?;
    told.set_item("sample", term.sample)?;
    told.set_item("samples", term.samples)?;
    told.set_item("towards", term.incident.map(|incident| vector(incident.towards)))?;
    told.set_item("distance", term.incident.map(|incident| incident.distance))?;
    told.set_item("cosine", term.cosine)?;
    told.set_item("diffuse", vector(term.diffuse))?;
    told.set_item("highlight", vector(term.highlight))?;
    told.set_item("lit", vector(term.lit))?;
    told.set_item("filter", vector(term.filter))?;
    let blocker = match &term.shadow {
        Shadow::Blocked { number, .. } => Some(*number),
        Shadow::NotAsked | Shadow::Crossed(_) => None,
    };
    told.set_item("blocked_by", blocker)?;
    Ok(told)
}

/// The ray that was traced, or why there is none.
fn branch<'py>(py: Python<'py>, branch: &Branch) -> PyResult<Bound<'py, PyAny>> {
    let ended = match branch {
        Branch::Traced(node) => return Ok(ray(py, node)?.into_any()),
        Branch::Ended(End::Limit) => "recursion limit",
        Branch::Ended(End::NoWeight) => "no weight",
        Branch::Ended(End::Threshold { .. }) => "below the cutoff",
        Branch::Ended(End::TotalReflection) => "total reflection",
    };
    Ok(ended.into_pyobject(py)?.into_any())
}

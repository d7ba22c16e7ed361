//! The camera of a scene that has none.

use crate::bounds::radius_about;
use crate::bounds::world_bounds;
use crate::diagnostic::Diagnostic;
use crate::model::Camera;
use crate::number::General;
use crate::resolved::Resolved;
use dotray_geometry::Vec3;

/// The camera of an empty scene.
pub const FALLBACK: Camera =
    Camera { position: Vec3::ZERO, direction: Vec3::NEG_Z, up: Vec3::Y, half_angle: 0.4 };

/// A camera that looks down -z and just frames the bounding sphere of the scene.
pub fn framing(scene: &Resolved) -> Camera {
    let bounds = world_bounds(scene);
    if bounds.is_empty() {
        return FALLBACK;
    }
    let center = bounds.center();
    let distance = radius_about(scene, center) / libm::sin(FALLBACK.half_angle);
    let position = center + Vec3::Z * distance;
    if position.is_finite() { Camera { position, ..FALLBACK } } else { FALLBACK }
}

/// Says that a default camera is used, and which.
pub fn warning(camera: &Camera) -> Diagnostic {
    let Camera { position, direction, up, half_angle } = camera;
    let numbers = [position, direction, up].map(|v| v.to_array().map(|x| General(x).to_string()).join(" "));
    let help = format!("the same in words: `#camera {} {half_angle}`", numbers.join(" "));
    let message = "the scene has no camera: one that looks down -z and just frames the scene is used";
    Diagnostic::warning("no-camera", message).help(help)
}

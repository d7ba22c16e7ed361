//! Wrong cameras.

use dotray_geometry::Affine;
use dotray_geometry::Mat3;
use dotray_geometry::Transform;
use dotray_scene::Resolved;
use std::f64::consts::PI;

const WIDEST: f64 = 0.499 * PI;

pub fn full_angle(resolved: &mut Resolved, _: (u32, u32)) {
    resolved.camera.half_angle *= 0.5;
}

pub fn half_angle_doubled(resolved: &mut Resolved, _: (u32, u32)) {
    resolved.camera.half_angle = (2.0 * resolved.camera.half_angle).min(WIDEST);
}

pub fn horizontal_angle(resolved: &mut Resolved, (width, height): (u32, u32)) {
    let tangent = libm::tan(resolved.camera.half_angle) * f64::from(height) / f64::from(width);
    resolved.camera.half_angle = libm::atan(tangent);
}

pub fn angle_in_degrees(resolved: &mut Resolved, _: (u32, u32)) {
    resolved.camera.half_angle *= PI / 180.0;
}

/// The horizontal angle is taken to be the vertical one. The camera cannot be stretched, but the world can: by X0/Y0
/// along the picture's width, about the eye. Lighting then is not quite that of the honest scene.
pub fn stretched(resolved: &mut Resolved, (width, height): (u32, u32)) {
    let camera = &resolved.camera;
    let right = camera.direction.cross(camera.up).normalize_or_zero();
    let factor = f64::from(width) / f64::from(height) - 1.0;
    let along = Mat3::from_cols(right * right.x, right * right.y, right * right.z);
    let matrix3 = Mat3::IDENTITY + along * factor;
    let stretch = Affine { matrix3, translation: camera.position - matrix3 * camera.position };
    if Transform::new(stretch).is_err() {
        return;
    }
    for frame in resolved.frames.iter_mut().skip(1) {
        *frame = Transform::new(stretch * *frame).map_or(*frame, |stretched| stretched.world_from_object);
    }
    // The first frame is the world and must stay it.
    let new = resolved.frames.len() as u32;
    resolved.frames.push(stretch);
    resolved.runs.iter_mut().filter(|run| run.frame == 0).for_each(|run| run.frame = new);
}

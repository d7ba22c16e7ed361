//! From a place in the picture to a ray (SPEC 3).

use dotray_geometry::Ray;
use dotray_geometry::Vec3;
use dotray_scene::model;

/// The camera with everything that does not depend on the pixel computed once.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Camera {
    position: Vec3,
    forward: Vec3,
    right_per_pixel: Vec3,
    up_per_pixel: Vec3,
    half_width: f64,
    half_height: f64,
}

impl Camera {
    /// The camera of a picture of `width` × `height` pixels.
    pub fn new(camera: &model::Camera, width: u32, height: u32) -> Self {
        let forward = camera.direction.normalize();
        let right = forward.cross(camera.up).normalize();
        let up = right.cross(forward);
        let (columns, rows) = (f64::from(width), f64::from(height));
        let tan_h = libm::tan(camera.half_angle);
        let tan_w = tan_h * columns / rows;
        Self {
            position: camera.position,
            forward,
            right_per_pixel: right * (2.0 * tan_w / columns),
            up_per_pixel: up * (2.0 * tan_h / rows),
            half_width: columns / 2.0,
            half_height: rows / 2.0,
        }
    }

    /// Where rays start.
    pub fn position(&self) -> Vec3 {
        self.position
    }

    /// How far ahead of the eye something lies that is `offset` away from it.
    pub fn depth(&self, offset: Vec3) -> f64 {
        offset.dot(self.forward)
    }

    /// (x, y) of what lies `offset` away from the eye, ahead of it: the inverse of [`Camera::ray`].
    pub fn place(&self, offset: Vec3) -> (f64, f64) {
        let at = |per_pixel: Vec3, half: f64| {
            offset.dot(per_pixel) / (self.depth(offset) * per_pixel.length_squared()) + half
        };
        (at(self.right_per_pixel, self.half_width), at(self.up_per_pixel, self.half_height))
    }

    /// The ray through (x, y), in pixels from the lower left corner; its direction has length 1.
    #[inline]
    pub fn ray(&self, x: f64, y: f64) -> Ray {
        let direction = self.forward
            + self.right_per_pixel * (x - self.half_width)
            + self.up_per_pixel * (y - self.half_height);
        Ray::new(self.position, direction.normalize())
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn corners_follow_the_angles() {
        let camera = model::Camera {
            position: Vec3::new(1.0, 2.0, 3.0),
            direction: Vec3::new(0.0, 0.0, -2.0),
            up: Vec3::new(0.0, 3.0, 0.0),
            half_angle: std::f64::consts::FRAC_PI_4,
        };
        let camera = Camera::new(&camera, 200, 100);
        let middle = camera.ray(100.0, 50.0);
        assert_eq!(middle.origin, Vec3::new(1.0, 2.0, 3.0));
        assert!((middle.direction - Vec3::NEG_Z).length() < 1e-15);
        // tan θ_W = 2 tan θ_H: the upper right corner lies at (2, 1, -1).
        let corner = camera.ray(200.0, 100.0).direction;
        assert!((corner - Vec3::new(2.0, 1.0, -1.0).normalize()).length() < 1e-15);
        for (x, y) in [(100.0, 50.0), (200.0, 100.0), (3.25, 99.5), (-40.0, 170.0)] {
            let (again_x, again_y) = camera.place(camera.ray(x, y).direction * 7.0);
            assert!((again_x - x).abs() < 1e-10 && (again_y - y).abs() < 1e-10);
        }
    }
}

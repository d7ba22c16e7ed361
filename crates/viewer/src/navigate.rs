//! The camera under the user's hands: orbit, pan, dolly, fly, frame.

use dotray_geometry::Aabb;
use dotray_geometry::Mat3;
use dotray_geometry::Vec3;
use dotray_scene::model::Camera;

/// A camera that can be led about, and the point that it turns around.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Navigator {
    camera: Camera,
    pivot: Vec3,
    home: Camera,
    home_pivot: Vec3,
    /// The scene's size: what a step of flying is measured by.
    size: f64,
}

/// How near the view may come to straight up or down, in radians.
const POLE: f64 = 0.01;

/// The smallest part of the scene's size that the eye may come near its pivot.
const NEAREST: f64 = 1e-6;

impl Navigator {
    /// Starts at the file's camera and turns around what lies ahead of it in the middle of the scene.
    pub fn new(camera: Camera, bounds: &Aabb) -> Self {
        let size = if bounds.is_empty() { 1.0 } else { bounds.size().length().max(f64::MIN_POSITIVE) };
        let middle = if bounds.is_empty() { camera.position } else { bounds.center() };
        let direction = camera.direction.normalize();
        let ahead = (middle - camera.position).dot(direction);
        let ahead = if ahead > NEAREST * size { ahead } else { size / 2.0 };
        let pivot = camera.position + direction * ahead;
        // The file's camera is kept as it is written, to the last bit: so is its picture.
        Self { camera, pivot, home: camera, home_pivot: pivot, size }
    }

    /// The same view of a scene that has been read again: what the user did stays, home is the new file's camera.
    #[must_use]
    pub fn moved_to(self, camera: Camera, bounds: &Aabb) -> Self {
        let fresh = Self::new(camera, bounds);
        if self.camera == self.home {
            fresh
        } else {
            Self { camera: self.camera, pivot: self.pivot, ..fresh }
        }
    }

    /// The camera now.
    pub fn camera(&self) -> Camera {
        self.camera
    }

    /// What it turns around.
    pub fn pivot(&self) -> Vec3 {
        self.pivot
    }

    /// Whether it still is the file's camera.
    pub fn at_home(&self) -> bool {
        self.camera == self.home
    }

    /// Back to the file's camera.
    pub fn reset(&mut self) {
        (self.camera, self.pivot) = (self.home, self.home_pivot);
    }

    /// Makes this the camera that [`Navigator::reset`] goes back to.
    pub fn settle(&mut self, camera: Camera) {
        self.camera = camera;
        (self.home, self.home_pivot) = (camera, self.pivot);
    }

    /// Right, up and ahead, each of length 1.
    pub fn axes(&self) -> [Vec3; 3] {
        let ahead = self.camera.direction.normalize();
        let right = ahead.cross(self.camera.up).normalize();
        [right, right.cross(ahead), ahead]
    }

    /// Turns around the pivot: to the right about the file's up, and up, by these angles.
    pub fn orbit(&mut self, right: f64, up: f64) {
        let turn = self.turn(right, up);
        let offset = turn * (self.camera.position - self.pivot);
        self.camera.direction = (turn * self.camera.direction).normalize();
        self.camera.position = self.pivot + offset;
    }

    /// Turns the head: the eye stays where it is.
    pub fn look(&mut self, right: f64, up: f64) {
        let turn = self.turn(right, up);
        let reach = self.reach();
        self.camera.direction = (turn * self.camera.direction).normalize();
        self.pivot = self.camera.position + self.camera.direction * reach;
    }

    /// The rotation about the vertical and about the horizontal axis; it stops short of the poles.
    fn turn(&self, right: f64, up: f64) -> Mat3 {
        let vertical = self.camera.up.normalize();
        let [across, _, ahead] = self.axes();
        let angle = libm::acos(ahead.dot(vertical).clamp(-1.0, 1.0));
        let up = up.clamp(-(std::f64::consts::PI - POLE - angle).max(0.0), (angle - POLE).max(0.0));
        Mat3::from_axis_angle(vertical, -right) * Mat3::from_axis_angle(across, up)
    }

    fn reach(&self) -> f64 {
        self.pivot.distance(self.camera.position).max(NEAREST * self.size)
    }

    /// Shifts the eye such that the pivot follows the pointer: by pixels of a picture `height` high.
    pub fn pan(&mut self, right: f64, up: f64, height: f64) {
        let [across, above, _] = self.axes();
        let pixel = 2.0 * libm::tan(self.camera.half_angle) * self.reach() / height.max(1.0);
        self.shift(-(across * right + above * up) * pixel);
    }

    /// Comes nearer (a factor below 1) or goes away.
    pub fn dolly(&mut self, factor: f64) {
        let reach = (self.reach() * factor).clamp(NEAREST * self.size, 1e4 * self.size);
        let [.., ahead] = self.axes();
        self.camera.position = self.pivot - ahead * reach;
    }

    /// Flies: parts of the scene's size to the right, up, and ahead.
    pub fn fly(&mut self, by: Vec3) {
        let [right, up, ahead] = self.axes();
        self.shift((right * by.x + up * by.y + ahead * by.z) * self.size);
    }

    fn shift(&mut self, by: Vec3) {
        self.camera.position += by;
        self.pivot += by;
    }

    /// Looks at a box from where it is, such that the box fills a picture of this width-to-height ratio.
    pub fn frame(&mut self, bounds: &Aabb, aspect: f64) {
        if bounds.is_empty() {
            return;
        }
        let radius = (bounds.size().length() / 2.0).max(NEAREST * self.size);
        let half_height = self.camera.half_angle;
        let half_width = libm::atan(libm::tan(half_height) * aspect);
        let reach = radius / libm::sin(half_height.min(half_width));
        let [.., ahead] = self.axes();
        self.pivot = bounds.center();
        self.camera.position = self.pivot - ahead * reach;
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn navigator() -> Navigator {
        let camera = Camera {
            position: Vec3::new(0.0, 0.0, 5.0),
            direction: Vec3::new(0.0, 0.0, -2.0),
            up: Vec3::Y * 3.0,
            half_angle: 0.5,
        };
        Navigator::new(camera, &Aabb::new(Vec3::splat(-1.0), Vec3::splat(1.0)))
    }

    fn near(a: Vec3, b: Vec3) -> bool {
        (a - b).length() < 1e-9
    }

    #[test]
    fn orbiting_keeps_the_distance_and_the_pivot_in_the_middle() {
        let mut moved = navigator();
        moved.orbit(std::f64::consts::FRAC_PI_2, 0.0);
        let camera = moved.camera();
        // Dragging to the right turns the scene to the right: the eye goes to the left.
        assert!(near(camera.position, Vec3::new(-5.0, 0.0, 0.0)), "{camera:?}");
        assert!(near(camera.direction, Vec3::X));
        for (right, up) in [(0.3, 0.4), (1.0, -9.0), (-2.0, 9.0)] {
            moved.orbit(right, up);
            let camera = moved.camera();
            assert!((camera.position.length() - 5.0).abs() < 1e-9);
            assert!(near(camera.direction, -camera.position / 5.0));
            // Never so near to a pole that the picture could tip over.
            assert!(camera.direction.cross(camera.up).length() > POLE / 2.0);
        }
        assert!(!moved.at_home());
        moved.reset();
        assert!(moved.at_home() && near(moved.camera().position, Vec3::Z * 5.0));
    }

    #[test]
    fn panning_moves_the_pivot_by_as_many_pixels() {
        let mut moved = navigator();
        moved.pan(0.0, 100.0, 200.0);
        // Half the height at distance 5 is 5 tan 0.5: the pivot's old place now lies at the upper edge.
        assert!(near(moved.pivot(), Vec3::NEG_Y * (5.0 * libm::tan(0.5))));
        assert!(near(moved.camera().position - moved.pivot(), Vec3::Z * 5.0));
    }

    #[test]
    fn framing_touches_the_edges_and_dolly_ends() {
        let mut moved = navigator();
        let bounds = Aabb::new(Vec3::new(9.0, -1.0, -1.0), Vec3::new(11.0, 1.0, 1.0));
        moved.frame(&bounds, 2.0);
        let reach = 3f64.sqrt() / libm::sin(0.5);
        assert!(near(moved.camera().position, Vec3::new(10.0, 0.0, reach)));
        for _ in 0..1000 {
            moved.dolly(0.5);
        }
        assert!(moved.camera().position.distance(moved.pivot()) > 0.0);
        moved.fly(Vec3::X);
        assert!(near(moved.pivot(), Vec3::new(10.0 + 12f64.sqrt(), 0.0, 0.0)));
    }

    #[test]
    fn a_scene_read_again_keeps_what_the_user_did() {
        let bounds = Aabb::new(Vec3::splat(-1.0), Vec3::splat(1.0));
        let other = Camera { position: Vec3::Z * 9.0, ..navigator().camera() };
        assert!(near(navigator().moved_to(other, &bounds).camera().position, Vec3::Z * 9.0));
        let mut moved = navigator();
        moved.dolly(0.5);
        let mut again = moved.moved_to(other, &bounds);
        assert!(near(again.camera().position, Vec3::Z * 2.5));
        again.reset();
        assert!(near(again.camera().position, Vec3::Z * 9.0));
    }
}

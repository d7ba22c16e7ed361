//! What part of the view's frame is on the screen.

use glam::Vec3;

/// The planes through the eye and the edges of the screen, and the one through the eye across the view: what lies on
/// the outer side of one of them is not seen.
#[derive(Clone, Copy, Debug)]
pub struct Sight {
    eye: Vec3,
    inward: [Vec3; 5],
}

/// What single precision may be off, in parts of the scene's size.
const SLACK: f32 = 1e-5;

impl Sight {
    /// Of the shader's numbers: the fourth of `right` and of `up` are tangents of half the view's angles.
    pub fn new(eye: [f32; 4], right: [f32; 4], up: [f32; 4], ahead: [f32; 4]) -> Self {
        let three = |[x, y, z, _]: [f32; 4]| Vec3::new(x, y, z);
        let (across, upward) = (three(right), three(up));
        let (wide, high) = (three(ahead) * right[3], three(ahead) * up[3]);
        let inward = [wide + across, wide - across, high + upward, high - upward, three(ahead)];
        Self { eye: three(eye), inward: inward.map(Vec3::normalize_or_zero) }
    }

    /// Whether nothing of a box is seen.
    pub fn misses(&self, [low, high]: [Vec3; 2]) -> bool {
        let center = (low + high) * 0.5 - self.eye;
        let half = (high - low) * 0.5;
        let slack = SLACK * (1.0 + center.length());
        self.inward.iter().any(|inward| inward.dot(center) + inward.abs().dot(half) < -slack)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn boxes_beside_the_screen_are_missed_and_no_others() {
        // From (0, 0, 2) towards -z; 45 degrees to the sides, about 27 up and down.
        let sight = Sight::new(
            [0.0, 0.0, 2.0, 1.0],
            [1.0, 0.0, 0.0, 1.0],
            [0.0, 1.0, 0.0, 0.5],
            [0.0, 0.0, -1.0, 1e-5],
        );
        let around = |x: f32, y: f32, z: f32, r: f32| {
            let center = Vec3::new(x, y, z);
            sight.misses([center - r, center + r])
        };
        assert!(!around(0.0, 0.0, 0.0, 0.1) && !around(1.9, 0.0, 0.0, 0.05) && !around(0.0, -0.9, 0.0, 0.05));
        assert!(around(2.3, 0.0, 0.0, 0.1) && around(-2.3, 0.0, 0.0, 0.1));
        assert!(around(0.0, 1.3, 0.0, 0.1) && around(0.0, -1.3, 0.0, 0.1));
        assert!(around(0.0, 0.0, 2.5, 0.1));
        // What reaches onto the screen from outside, and what is around the eye.
        assert!(!around(3.0, 0.0, 0.0, 1.0) && !around(0.0, 0.0, 2.5, 1.0) && !around(5.0, 5.0, 5.0, 9.0));
    }
}

//! A half-line.

use crate::vector::{Affine, Vec3};

/// `origin + t * direction`. The direction need not have length 1: a ray taken into object coordinates keeps
/// the `t` of the world ray, so that hits stay comparable between shapes of different groups.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Ray {
    /// Where t = 0.
    pub origin: Vec3,
    /// What one unit of t adds.
    pub direction: Vec3,
}

impl Ray {
    /// A ray from `origin` along `direction`.
    #[inline]
    pub const fn new(origin: Vec3, direction: Vec3) -> Self {
        Self { origin, direction }
    }

    /// The point at parameter `t`.
    #[inline]
    pub fn at(&self, t: f64) -> Vec3 {
        self.origin + self.direction * t
    }

    /// The same points in other coordinates, each at the same `t`.
    #[inline]
    pub fn transformed(&self, to_from_here: &Affine) -> Self {
        Self {
            origin: to_from_here.transform_point3(self.origin),
            direction: to_from_here.transform_vector3(self.direction),
        }
    }
}

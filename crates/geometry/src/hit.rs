//! Two-step hits: [`Hit`] for every candidate, [`Surface`] only for the winner.

use crate::vector::{Vec2, Vec3};

/// Where a ray crosses a shape's surface: cheap, made for every candidate.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Hit {
    /// The ray's parameter.
    pub t: f64,
    /// Which part of the surface: the shape's own numbering (side, cap, face of a box …).
    pub face: u8,
}

/// Everything that shading wants to know of the point hit, in the shape's object coordinates.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Surface {
    /// The point, put onto the surface where that can be had for nothing.
    pub point: Vec3,
    /// The outward unit normal of the shape itself: tells enter from exit.
    pub geometric_normal: Vec3,
    /// The normal that shades: interpolated (not renormalised yet, never zero) on a triangle, elsewhere the
    /// geometric one.
    pub shading_normal: Vec3,
    /// (s, t) of SPEC 7.
    pub texcoord: Vec2,
}

/// The surface points that one ray meets on one shape, in ascending order of t (which may be negative):
/// at most four (a torus), at most two on a convex shape.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Crossings {
    hits: [Hit; 4],
    count: u8,
}

impl Crossings {
    /// No crossing.
    pub const NONE: Self = Self { hits: [Hit { t: 0.0, face: 0 }; 4], count: 0 };

    /// One crossing.
    #[inline]
    pub const fn one(hit: Hit) -> Self {
        let mut hits = Self::NONE.hits;
        hits[0] = hit;
        Self { hits, count: 1 }
    }

    /// Where the ray enters and where it leaves a convex shape; `enter.t <= leave.t`.
    #[inline]
    pub const fn two(enter: Hit, leave: Hit) -> Self {
        let mut hits = Self::NONE.hits;
        hits[0] = enter;
        hits[1] = leave;
        Self { hits, count: 2 }
    }

    /// The crossings, nearest first.
    #[inline]
    pub fn as_slice(&self) -> &[Hit] {
        &self.hits[..usize::from(self.count)]
    }

    /// The first one with `t_min < t <= t_max`.
    #[inline]
    pub fn first_within(&self, t_min: f64, t_max: f64) -> Option<Hit> {
        self.as_slice().iter().copied().find(|hit| t_min < hit.t && hit.t <= t_max)
    }
}

//! A ray made ready in double precision: cut to the scene's box, with the slack that its rounding errors need.
//!
//! **The slack.** Callers test shapes in double precision, whose own rounding can place a hit a little outside the
//! item's box: a few units in the last place of the largest coordinate that takes part, which is the ray's origin or
//! a corner of the scene. Every box and every cell is therefore treated as if it were larger on all sides by
//! `slack = 2^-46 (|origin| + |scene|)`, that is 128 half units in the last place (2^-53 is one) of the sum of both.
//! The errors of this file's own arithmetic are far below: a plane's t is `(plane - origin) * inverse`, three
//! roundings, which displace the plane by at most `3 * 2^-53 (|plane| + |origin|)`.
//!
//! **No NaN.** A direction's component of 0 (or next to it) is replaced by 2^-80 of the same sign: while the ray
//! crosses the scene this moves it by less than `2^-80 * 4 (|origin| + |scene|)`, far below the slack, and the
//! reciprocal
//! stays finite, so that no infinity meets a zero.

use crate::query::Query;
use dotray_geometry::Aabb;
use dotray_geometry::Vec3;

/// The smallest magnitude of a direction's component.
pub(crate) const TINY: f64 = 1.0 / (1_u128 << 80) as f64;

/// The share of the coordinates by which boxes are treated as larger.
pub(crate) const SLACK: f64 = 1.0 / (1_u64 << 46) as f64;

/// A ray cut to a box, in double precision.
#[derive(Clone, Copy, Debug)]
pub struct ClippedRay {
    /// Where t = 0.
    pub origin: [f64; 3],
    /// What one unit of t adds; no component is closer to 0 than 2^-80.
    pub direction: [f64; 3],
    /// The reciprocals of the direction.
    pub inverse: [f64; 3],
    /// By how much every box is treated as larger, on all sides.
    pub slack: f64,
    /// Nothing of interest lies before this t.
    pub start: f64,
    /// Nor behind this.
    pub end: f64,
}

impl ClippedRay {
    /// Cuts the query's ray to `scene`, or tells with `None` that it misses.
    #[inline(always)]
    pub fn new(query: &Query, scene: &Aabb) -> Option<Self> {
        let origin = query.ray.origin.to_array();
        let direction = query.ray.direction.to_array().map(away_from_zero);
        let inverse = direction.map(|component| 1.0 / component);
        let slack = SLACK * (largest(query.ray.origin) + largest(scene.min).max(largest(scene.max)));
        let mut ray = Self { origin, direction, inverse, slack, start: query.t_min, end: query.t_max };
        let (low, high) = (scene.min.to_array(), scene.max.to_array());
        for axis in 0..3 {
            let (near, far) = ray.slab(axis, low[axis], high[axis]);
            ray.start = ray.start.max(near);
            ray.end = ray.end.min(far);
        }
        (ray.start <= ray.end).then_some(ray)
    }

    /// Where the ray enters and leaves the slab between two planes across `axis`, the slack included.
    #[inline(always)]
    pub fn slab(&self, axis: usize, low: f64, high: f64) -> (f64, f64) {
        let a = (low - self.slack - self.origin[axis]) * self.inverse[axis];
        let b = (high + self.slack - self.origin[axis]) * self.inverse[axis];
        if self.inverse[axis] > 0.0 { (a, b) } else { (b, a) }
    }

    /// Which components of the direction are negative, as the bits 1, 2 and 4.
    #[inline(always)]
    pub fn negative(&self) -> usize {
        (0..3).map(|axis| usize::from(self.direction[axis] < 0.0) << axis).sum()
    }

    /// The largest t that still counts where the nearest hit lies at `t_max`.
    #[inline(always)]
    pub fn limit(&self, t_max: f64) -> f64 {
        t_max + self.slack
    }
}

/// The component itself, or ±2^-80 where it is closer to 0 than that.
#[inline(always)]
fn away_from_zero(component: f64) -> f64 {
    if component.abs() < TINY { TINY.copysign(component) } else { component }
}

/// The largest magnitude of the three coordinates.
#[inline(always)]
pub fn largest(point: Vec3) -> f64 {
    point.x.abs().max(point.y.abs()).max(point.z.abs())
}

#[cfg(test)]
mod tests {
    use super::*;
    use dotray_geometry::Ray;

    fn clip(origin: Vec3, direction: Vec3) -> Option<ClippedRay> {
        let query = Query { ray: Ray::new(origin, direction), t_min: 0.0, t_max: f64::INFINITY };
        ClippedRay::new(&query, &Aabb::new(Vec3::ZERO, Vec3::ONE))
    }

    #[test]
    fn a_ray_in_the_plane_of_a_face_stays() {
        for (origin, direction) in [
            (Vec3::new(-1.0, 1.0, 0.0), Vec3::X),
            (Vec3::new(0.0, 0.0, 9.0), Vec3::NEG_Z),
            (Vec3::ONE, Vec3::Y),
        ] {
            let ray = clip(origin, direction).expect("it touches");
            assert!(ray.start.is_finite() && ray.end.is_finite());
        }
    }

    #[test]
    fn a_ray_that_misses_is_told() {
        assert!(clip(Vec3::new(-1.0, 1.1, 0.5), Vec3::X).is_none());
        assert!(clip(Vec3::splat(2.0), Vec3::X).is_none());
        assert!(clip(Vec3::splat(f64::MAX), Vec3::X).is_none_or(|ray| !ray.start.is_nan()));
    }

    #[test]
    fn the_cut_is_where_the_box_is() {
        let ray = clip(Vec3::new(-1.0, 0.5, 0.5), Vec3::X).expect("it meets the box");
        assert!(ray.start <= 1.0 && ray.start > 1.0 - 1e-12);
        assert!(ray.end >= 2.0 && ray.end < 2.0 + 1e-12);
    }
}

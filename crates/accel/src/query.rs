//! What a walk asks and whom it calls.

use crate::simd::Simd;
use dotray_geometry::Ray;

/// One ray and the part of it that counts.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Query {
    /// The ray, in the world; its direction has length 1.
    pub ray: Ray,
    /// Items are looked for from here …
    pub t_min: f64,
    /// … to here, which shrinks as hits are found.
    pub t_max: f64,
}

/// Several rays that travel together, and what happens at the leaves.
///
/// The two leaf calls test items and answer with the new upper bound of t: the old one, the t of a nearer hit, or
/// `f64::NEG_INFINITY` to end this ray's walk (an occlusion ray that is blocked). The walk guarantees that every item
/// whose surface crosses the ray at some `t` in `[t_min, bound]` is shown at least once, where `bound` is what the calls
/// before answered; items may be shown more than once (octree and BSP), in any order.
pub trait Batch {
    /// How many rays there are.
    fn len(&self) -> usize;

    /// Ray number `i`.
    fn query(&self, i: usize) -> Query;

    /// Tests the items at positions `first .. first + count` (of the accelerator's own order, [`crate::Built::order`]).
    fn leaf_range<S: Simd>(&mut self, simd: S, i: usize, first: u32, count: u32, t_max: f64) -> f64;

    /// Tests the items at the positions listed.
    fn leaf_list<S: Simd>(&mut self, simd: S, i: usize, positions: &[u32], t_max: f64) -> f64;

    /// Ray `i` is finished after this many box (or cell) tests.
    fn finished(&mut self, i: usize, box_tests: u64);

    /// Whether there is no ray.
    fn is_empty(&self) -> bool {
        self.len() == 0
    }
}

//! Whom a walk calls.

use crate::narrow::NarrowRay;
use crate::packet::LANES;
use crate::packet::Packet;
use crate::simd::Simd;

/// What happens at the leaves to the rays of a batch.
///
/// The leaf calls test items and answer with the new upper bound of t: the old one, the t of a nearer hit, or
/// `f64::NEG_INFINITY` to end this ray's walk (an occlusion ray that is blocked). The walk guarantees that every item
/// whose surface crosses the ray at some `t` in `[t_min, bound]` is shown at least once, where `bound` is what the
/// calls before answered; items may be shown more than once (octree and BSP), in any order.
///
/// The walks of trees are compiled once a SIMD level and batch, with the level's token at hand, so that what tests a
/// leaf need not look the level up for every leaf; octree, BSP and brute force call through `dyn Batch`.
pub trait Batch {
    /// Tests the items at positions `first .. first + count` (of the accelerator's own order,
    /// [`crate::Built::order`]) for ray `i`.
    fn leaf_range(&mut self, i: usize, first: u32, count: u32, t_max: f64) -> f64;

    /// Tests the items at the positions listed.
    fn leaf_list(&mut self, i: usize, positions: &[u32], t_max: f64) -> f64;

    /// As `leaf_range`, for at most eight items; `narrow` is the ray in single precision, to rule items out.
    #[inline(always)]
    fn leaf_block<S: Simd>(
        &mut self,
        simd: S,
        narrow: &NarrowRay,
        i: usize,
        [first, count]: [u32; 2],
        t_max: f64,
    ) -> f64
    where
        Self: Sized,
    {
        let _ = (simd, narrow);
        self.leaf_range(i, first, count, t_max)
    }

    /// The same items will be asked for soon: what is known of them may be brought nearer.
    #[inline(always)]
    fn expect(&self, first: u32, count: u32) {
        let _ = (first, count);
    }

    /// Tests the items at positions `first .. first + count` for the rays of the groups `active` (bit by bit) of a
    /// packet, as `leaf_range` does for one, and sets their new bounds ([`Packet::set_t_max`]). Returns whether any
    /// bound has changed.
    #[inline(always)]
    fn leaf_packet<S: Simd>(
        &mut self,
        simd: S,
        packet: &mut Packet,
        active: u32,
        [first, count]: [u32; 2],
    ) -> bool
    where
        Self: Sized,
    {
        let _ = simd;
        let mut changed = false;
        let mut left = active;
        while left != 0 {
            let number = left.trailing_zeros() as usize;
            left &= left - 1;
            let group = *packet.group(number);
            let alive = group.alive();
            for lane in (0..LANES).filter(|lane| alive >> lane & 1 == 1) {
                let answer = self.leaf_range(group.rays[lane] as usize, first, count, group.t_max[lane]);
                if answer < group.t_max[lane] {
                    packet.set_t_max(number, lane, answer);
                    changed = true;
                }
            }
        }
        changed
    }

    /// Ray `i` is finished after this many box (or cell) tests.
    fn finished(&mut self, i: usize, box_tests: u64);
}

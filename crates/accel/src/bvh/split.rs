//! Where to part a range of references: the surface-area heuristic over bins of their centres.

use crate::bvh::partition::Extent;
use crate::bvh::partition::Member;
use crate::bvh::partition::PIECE;
use crate::bvh::partition::Reference;
use crate::bvh::partition::Span;
use crate::input::Quality;
use rayon::prelude::*;

/// A place to part a range: references whose centre falls into a bin below `bin` go first.
#[derive(Clone, Copy, Debug)]
pub struct Split {
    axis: usize,
    bin: usize,
    low: f32,
    scale: f32,
    /// What the two parts are expected to cost, in surface times items.
    pub cost: f32,
}

impl Split {
    /// On which side a reference falls.
    #[inline(always)]
    pub fn below(&self, reference: &Reference) -> bool {
        (bin(reference.center()[self.axis], self.low, self.scale) as usize) < self.bin
    }
}

/// The number of the bin into which a centre falls, in the lowest bits: one number is counted and parted by.
///
/// Adding 1.5 * 2^23 rounds to the nearest whole number and leaves it in the lowest bits of the mantissa, which is
/// several instructions less than a conversion that saturates.
#[inline(always)]
fn bin(center: f32, low: f32, scale: f32) -> u32 {
    ((center - low) * scale - 0.5 + 12_582_912.0).to_bits() & 63
}

/// What testing `count` items costs, where the test of a node costs 1: reaching the leaf, and each item.
#[inline(always)]
pub fn leaf_cost(count: usize) -> f32 {
    LEAF_COST + ITEM_COST * count as f32
}

/// The cost of reaching a leaf.
const LEAF_COST: f32 = 1.0;

/// The cost of one item.
const ITEM_COST: f32 = 0.3;

/// Ranges that are parted by half the bins.
const FEW: usize = 32;

/// The best of the splits tried, or none where all centres lie in one bin.
pub fn best_split(members: &[impl Member], span: &Span, quality: Quality) -> Option<Split> {
    match quality {
        Quality::Fast => Bins::<8>::of(members, span).best(),
        // Few members fall into few bins, and most splits are of few members. (Twice the bins for all of a small scene
        // were tried: lattice12 has 11 % fewer box tests of it, and takes as long.)
        Quality::Balanced if members.len() <= FEW => Bins::<8>::of(members, span).best(),
        Quality::Balanced => Bins::<16>::of(members, span).best(),
        Quality::Best => Bins::<32>::of(members, span).best(),
    }
}

/// Members counted by where their centres lie, on each axis.
#[derive(Clone)]
struct Bins<const N: usize> {
    low: [f32; 4],
    scale: [f32; 4],
    extents: [[Extent; N]; 3],
    counts: [[u32; N]; 3],
}

impl<const N: usize> Bins<N> {
    /// No references, with bins over the span's centres.
    fn empty(span: &Span) -> Self {
        let mut scale = [0.0; 4];
        for (axis, scale) in scale.iter_mut().enumerate().take(3) {
            let length = span.centers.high[axis] - span.centers.low[axis];
            // A little less than N bins' worth, so that the last centre falls into the last bin.
            *scale = if length > 1e-30 { N as f32 * 0.999_99 / length } else { 0.0 };
        }
        Self { low: span.centers.low, scale, extents: [[Extent::EMPTY; N]; 3], counts: [[0; N]; 3] }
    }

    /// All the members, counted by all threads where they are many.
    fn of(members: &[impl Member], span: &Span) -> Self {
        let mut bins = Self::empty(span);
        if members.len() <= PIECE {
            bins.add(members);
            return bins;
        }
        let pieces = members.par_chunks(PIECE).map(|piece| {
            let mut bins = Self::empty(span);
            bins.add(piece);
            bins
        });
        pieces.reduce(|| bins.clone(), Self::joined)
    }

    /// These as well.
    fn add(&mut self, members: &[impl Member]) {
        for member in members {
            let reference = member.reference();
            let center = reference.center();
            let place: [u32; 4] = std::array::from_fn(|i| bin(center[i], self.low[i], self.scale[i]));
            for axis in 0..3 {
                let bin = place[axis] as usize % N;
                self.extents[axis][bin].add(reference);
                self.counts[axis][bin] += member.weight() as u32;
            }
        }
    }

    /// Two sets of references together.
    fn joined(mut self, other: Self) -> Self {
        for axis in 0..3 {
            for bin in 0..N {
                self.extents[axis][bin].join(&other.extents[axis][bin]);
                self.counts[axis][bin] += other.counts[axis][bin];
            }
        }
        self
    }

    /// The split of least cost.
    fn best(&self) -> Option<Split> {
        let mut best = Split { axis: 0, bin: 0, low: 0.0, scale: 0.0, cost: f32::INFINITY };
        for axis in 0..3 {
            if self.scale[axis] == 0.0 {
                continue;
            }
            // What each way to split costs, all of them before any is compared: no branch to guess wrong.
            let costs = self.costs(axis);
            let least =
                costs[1..].iter().fold(f32::INFINITY, |least, &cost| if cost < least { cost } else { least });
            if least < best.cost {
                let bin = costs.iter().position(|&cost| cost == least).unwrap_or(0);
                best = Split { axis, bin, low: self.low[axis], scale: self.scale[axis], cost: least };
            }
        }
        (best.bin > 0).then_some(best)
    }

    /// What both sides cost where an axis is split below each bin; infinite where one side is empty.
    fn costs(&self, axis: usize) -> [f32; N] {
        let (extents, counts) = (&self.extents[axis], &self.counts[axis]);
        let mut costs = [f32::INFINITY; N];
        let (mut extent, mut count) = (Extent::EMPTY, 0);
        for bin in (1..N).rev() {
            extent.join(&extents[bin]);
            count += counts[bin];
            costs[bin] = side_cost(&extent, count);
        }
        let (mut extent, mut count) = (Extent::EMPTY, 0);
        for bin in 1..N {
            extent.join(&extents[bin - 1]);
            count += counts[bin - 1];
            costs[bin] += side_cost(&extent, count);
        }
        costs
    }
}

/// What one side of a split costs: infinite where it is empty.
#[inline(always)]
fn side_cost(extent: &Extent, count: u32) -> f32 {
    let cost = extent.half_area() * leaf_cost(count as usize);
    if count > 0 { cost } else { f32::INFINITY }
}

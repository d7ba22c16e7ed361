//! Where to part a range of references: the surface-area heuristic over bins of their centres.

use crate::bvh::partition::Extent;
use crate::bvh::partition::Member;
use crate::bvh::partition::PIECE;
use crate::bvh::partition::Reference;
use crate::bvh::partition::Span;
use crate::input::Quality;
use crate::simd::Level;
use crate::simd::Simd;
use crate::simd::dispatch;
use crate::simd::f32x4;
use crate::simd::f32x8;
use crate::simd::i32x4;
use crate::simd::prelude::*;
use crate::simd::u32x4;
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
        (bin(reference.center_on(self.axis), self.low, self.scale) as usize) < self.bin
    }
}

/// A number that, added to a smaller one, rounds that to the nearest whole number and leaves it in the lowest bits of
/// the mantissa, which is several instructions less than a conversion that saturates: 1.5 * 2^23.
const ROUNDING: f32 = 12_582_912.0;

/// The bits that may hold the number of a bin.
const BIN_BITS: u32 = 63;

/// The number of the bin into which a centre falls.
#[inline(always)]
fn bin(center: f32, low: f32, scale: f32) -> u32 {
    ((center - low) * scale - 0.5 + ROUNDING).to_bits() & BIN_BITS
}

/// What testing `count` items costs, where the test of a node costs 1: reaching the leaf, and each item.
#[inline(always)]
pub fn leaf_cost(count: u32) -> f32 {
    LEAF_COST + ITEM_COST * count as f32
}

/// The cost of reaching a leaf.
const LEAF_COST: f32 = 1.0;

/// The cost of one item.
const ITEM_COST: f32 = 0.3;

/// Ranges that are parted by half the bins.
const FEW: usize = 32;

/// The best of the splits tried, or none where all centres lie in one bin.
pub fn best_split(level: Level, members: &[impl Member], span: &Span, quality: Quality) -> Option<Split> {
    match quality {
        Quality::Fast => Bins::<8>::best_of(level, members, span),
        // Few members fall into few bins, and most splits are of few members. (Twice the bins for all of a small scene
        // were tried: lattice12 has 11 % fewer box tests of it, and takes as long.)
        Quality::Balanced if members.len() <= FEW => Bins::<8>::best_of(level, members, span),
        Quality::Balanced => Bins::<16>::best_of(level, members, span),
        Quality::Best => Bins::<32>::best_of(level, members, span),
    }
}

/// Members counted by where their centres lie, on each axis.
#[derive(Clone)]
struct Bins<const N: usize> {
    low: [f32; 4],
    scale: [f32; 4],
    extents: [[Extent; N]; 3],
    counts: [[i32; N]; 3],
}

impl<const N: usize> Bins<N> {
    /// No references, with bins over the span's centres.
    #[inline(always)]
    fn empty(span: &Span) -> Self {
        let (mut low, mut scale) = ([0.0; 4], [0.0; 4]);
        for axis in 0..3 {
            low[axis] = span.centers.low(axis);
            let length = span.centers.high(axis) - low[axis];
            // A little less than N bins' worth, so that the last centre falls into the last bin. Where all centres
            // coincide on an axis, all fall into the first.
            scale[axis] = if length > 1e-30 { N as f32 * 0.999_99 / length } else { 0.0 };
        }
        Self { low, scale, extents: [[Extent::EMPTY; N]; 3], counts: [[0; N]; 3] }
    }

    /// The best split of the members, who are counted by all threads where they are many.
    fn best_of(level: Level, members: &[impl Member], span: &Span) -> Option<Split> {
        if members.len() <= PIECE {
            return dispatch!(level, simd => {
                let mut bins = Self::empty(span);
                bins.add(simd, members);
                bins.best(simd)
            });
        }
        let pieces = members.par_chunks(PIECE).map(|piece| {
            let mut bins = Self::empty(span);
            dispatch!(level, simd => bins.add(simd, piece));
            bins
        });
        let bins = pieces.reduce(|| Self::empty(span), Self::joined);
        dispatch!(level, simd => bins.best(simd))
    }

    /// These as well.
    #[inline(always)]
    fn add<S: Simd>(&mut self, simd: S, members: &[impl Member]) {
        let low = f32x4::load_array(simd, self.low);
        let scale = f32x4::load_array(simd, self.scale);
        for member in members {
            let bounds = member.reference().vector(simd);
            let place = (Reference::center(bounds) - low) * scale - 0.5 + ROUNDING;
            let place = (place.bitcast::<u32x4<S>>() & BIN_BITS).to_array();
            for axis in 0..3 {
                let bin = place[axis] as usize % N;
                self.extents[axis][bin].add(simd, bounds);
                self.counts[axis][bin] += member.weight() as i32;
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

    /// The split of least cost; of several, the one on the first axis and below the first bin.
    #[inline(always)]
    fn best<S: Simd>(&self, simd: S) -> Option<Split> {
        // Four splits are compared at a time, each with the best in its lane: no branch to guess wrong.
        let mut least = f32x4::splat(simd, f32::INFINITY);
        let mut codes = i32x4::splat(simd, 0);
        let lanes = i32x4::load_array(simd, [0, 1, 2, 3]);
        for axis in 0..3 {
            let below = self.sides(simd, axis, 0..N - 1, 1);
            let above = self.sides(simd, axis, (1..N).rev(), 0);
            let (edges_below, edges_above) = (below.edges.as_flattened(), above.edges.as_flattened());
            let edges = edges_below.as_chunks().0.iter().zip(edges_above.as_chunks().0);
            let counts = below.counts.as_chunks().0.iter().zip(above.counts.as_chunks().0);
            for (block, (edges, counts)) in edges.zip(counts).enumerate() {
                let cost = side_costs(simd, edges.0, counts.0) + side_costs(simd, edges.1, counts.1);
                let better = cost.simd_lt(least);
                least = better.select(cost, least);
                codes = better.select(lanes + (axis * N + block * 4) as i32, codes);
            }
        }
        let (least, codes) = (least.to_array(), codes.to_array());
        let first = |a: usize, b: usize| {
            let ahead = least[a] < least[b] || (least[a] == least[b] && codes[a] < codes[b]);
            if ahead { a } else { b }
        };
        let lane = first(first(0, 1), first(2, 3));
        let (axis, bin) = (codes[lane] as usize / N, codes[lane] as usize % N);
        (least[lane] < f32::INFINITY).then(|| Split {
            axis,
            bin,
            low: self.low[axis],
            scale: self.scale[axis],
            cost: least[lane],
        })
    }

    /// One side of every split of an axis: what its bins, taken in this order, come to. The side with bin `i` as its
    /// last belongs to the split below bin `i + shift`.
    #[inline(always)]
    fn sides<S: Simd>(
        &self,
        simd: S,
        axis: usize,
        bins: impl Iterator<Item = usize>,
        shift: usize,
    ) -> Sides<N> {
        let mut sides = Sides { edges: [[f32::INFINITY; 4]; N], counts: [0; N] };
        let (mut extent, mut count) = (f32x8::splat(simd, f32::INFINITY), 0);
        for bin in bins {
            extent = extent.min(self.extents[axis][bin].vector(simd));
            count += self.counts[axis][bin];
            let (low, high) = extent.split();
            sides.edges[bin + shift] = (low + high).to_array();
            sides.counts[bin + shift] = count;
        }
        sides
    }
}

/// One side of every split of an axis.
struct Sides<const N: usize> {
    /// The edges of the boxes, negated: infinite where there is nothing.
    edges: [[f32; 4]; N],
    /// For how many references each stands.
    counts: [i32; N],
}

/// What four sides cost, by their negated edges and their counts: infinite where there is nothing.
#[inline(always)]
fn side_costs<S: Simd>(simd: S, edges: &[f32; 16], counts: &[i32; 4]) -> f32x4<S> {
    let [x, y, z, _] = simd.load_four_interleaved_f32x4(edges);
    let items = i32x4::load_array_ref(simd, counts).to_float::<f32x4<S>>() * ITEM_COST;
    (x * (y + z) + y * z) * (items + LEAF_COST)
}

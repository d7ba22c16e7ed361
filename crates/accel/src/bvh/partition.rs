//! What the builder moves: one reference an item, and how a range of them is parted in place.

use crate::narrow::NarrowBox;
use crate::simd::Level;
use crate::simd::Simd;
use crate::simd::dispatch;
use crate::simd::f32x4;
use crate::simd::f32x8;
use crate::simd::prelude::*;
use rayon::prelude::*;

/// Ranges with more references are parted by all threads, piece by piece; the pieces never depend on the threads.
pub const PIECE: usize = 1 << 15;

/// An item while the tree grows: its box and its number, 32 bytes, one vector.
///
/// Lanes 0 to 2 hold the smallest coordinates, lanes 4 to 6 the largest ones negated, so that one `min` joins two
/// boxes. The number's bits stand in lane 3. They are only ever copied; bit 30 is flipped so that, whatever the number,
/// they are a normal float and slow no arithmetic on the whole vector down.
#[derive(Clone, Copy, Debug)]
#[repr(C, align(32))]
pub struct Reference([f32; 8]);

/// What ranges are parted into: references, or clusters of them.
pub trait Member: Copy + Send + Sync {
    /// Its box.
    fn reference(&self) -> &Reference;

    /// For how many references it stands.
    fn weight(&self) -> usize;
}

impl Member for Reference {
    #[inline(always)]
    fn reference(&self) -> &Reference {
        self
    }

    #[inline(always)]
    fn weight(&self) -> usize {
        1
    }
}

/// The bit that makes any number a normal float.
const FLIP: u32 = 1 << 30;

impl Reference {
    /// The reference of an item; `number` has 28 bits, and bit 31 for what it likes.
    pub fn new(bounds: NarrowBox, number: u32) -> Self {
        let ([a, b, c], [d, e, f]) = (bounds.low, bounds.high);
        Self([a, b, c, f32::from_bits(number ^ FLIP), -d, -e, -f, 0.0])
    }

    /// The item's number.
    pub fn number(&self) -> u32 {
        self.0[3].to_bits() ^ FLIP
    }

    /// What a builder knows of a range of this one alone.
    #[cfg(test)]
    pub fn span(&self) -> Span {
        Span::of(crate::simd::level(), &[*self])
    }

    /// Its box.
    #[inline(always)]
    pub fn vector<S: Simd>(&self, simd: S) -> f32x8<S> {
        f32x8::load_array_ref(simd, &self.0)
    }

    /// Twice the centre of a box.
    #[inline(always)]
    pub fn center<S: Simd>(bounds: f32x8<S>) -> f32x4<S> {
        let (low, high) = bounds.split();
        low - high
    }

    /// Twice the centre on one axis.
    #[inline(always)]
    pub fn center_on(&self, axis: usize) -> f32 {
        self.0[axis] - self.0[4 + axis]
    }
}

/// A box that grows, in the lanes of [`Reference`]; lanes 3 and 7 mean nothing.
#[derive(Clone, Copy, Debug)]
#[repr(C, align(32))]
pub struct Extent([f32; 8]);

impl Extent {
    /// The box that holds nothing.
    pub const EMPTY: Self = Self([f32::INFINITY; 8]);

    /// A reference's box.
    pub fn of(reference: &Reference) -> Self {
        Self(reference.0)
    }

    /// The smallest coordinate on an axis.
    #[inline(always)]
    pub fn low(&self, axis: usize) -> f32 {
        self.0[axis]
    }

    /// The largest.
    #[inline(always)]
    pub fn high(&self, axis: usize) -> f32 {
        -self.0[4 + axis]
    }

    /// As a vector.
    #[inline(always)]
    pub fn vector<S: Simd>(&self, simd: S) -> f32x8<S> {
        f32x8::load_array_ref(simd, &self.0)
    }

    /// Takes in a box.
    #[inline(always)]
    pub fn add<S: Simd>(&mut self, simd: S, bounds: f32x8<S>) {
        self.0 = self.vector(simd).min(bounds).to_array();
    }

    /// Takes in a box.
    #[inline(always)]
    pub fn join(&mut self, other: &Self) {
        for (own, &other) in self.0.iter_mut().zip(&other.0) {
            *own = if other < *own { other } else { *own };
        }
    }

    /// Half the surface; 0 where it is empty.
    #[inline(always)]
    pub fn half_area(&self) -> f32 {
        let [x, y, z] = [0, 1, 2].map(|axis| (self.high(axis) - self.low(axis)).max(0.0));
        x * (y + z) + y * z
    }

    /// The box as nodes hold it.
    pub fn narrow(&self) -> NarrowBox {
        NarrowBox { low: [0, 1, 2].map(|axis| self.low(axis)), high: [0, 1, 2].map(|axis| self.high(axis)) }
    }
}

/// What the builder knows of a range of references: the box around their boxes and the one around their centres.
#[derive(Clone, Copy, Debug)]
pub struct Span {
    /// Around the boxes.
    pub bounds: Extent,
    /// Around the centres, times two.
    pub centers: Extent,
}

impl Span {
    /// Of no references.
    pub const EMPTY: Self = Self { bounds: Extent::EMPTY, centers: Extent::EMPTY };

    /// Of these references, by all threads where they are many.
    pub fn of<T: Member>(level: Level, members: &[T]) -> Self {
        let one = |members: &[T]| dispatch!(level, simd => Self::of_few(simd, members));
        if members.len() <= PIECE {
            return one(members);
        }
        members.par_chunks(PIECE).map(one).reduce(|| Self::EMPTY, Self::joined)
    }

    /// Of these, by this thread.
    #[inline(always)]
    fn of_few<S: Simd, T: Member>(simd: S, members: &[T]) -> Self {
        let (mut bounds, mut centers) = (Extent::EMPTY.vector(simd), Extent::EMPTY.vector(simd));
        for member in members {
            let member = member.reference().vector(simd);
            let center = Reference::center(member);
            bounds = bounds.min(member);
            centers = centers.min(center.combine(-center));
        }
        Self { bounds: Extent(bounds.to_array()), centers: Extent(centers.to_array()) }
    }

    /// Of two ranges together.
    pub fn joined(mut self, other: Self) -> Self {
        self.bounds.join(&other.bounds);
        self.centers.join(&other.centers);
        self
    }
}

/// Parts the members in place, those that are `below` first; returns how many they are and both spans.
pub fn part<T: Member>(
    level: Level,
    members: &mut [T],
    below: impl Fn(&Reference) -> bool + Sync,
) -> (usize, Span, Span) {
    let one = |members: &mut [T]| dispatch!(level, simd => part_piece(simd, members, &below));
    if members.len() <= PIECE {
        return one(members);
    }
    let pieces: Vec<_> = members.par_chunks_mut(PIECE).map(one).collect();
    let middle = pieces.iter().map(|&(count, ..)| count).sum();
    let spans = pieces
        .iter()
        .fold((Span::EMPTY, Span::EMPTY), |(a, b), &(_, low, high)| (a.joined(low), b.joined(high)));
    exchange(members, middle, pieces.iter().map(|&(count, ..)| count));
    (middle, spans.0, spans.1)
}

/// Parts one piece.
#[inline(always)]
fn part_piece<S: Simd, T: Member>(
    simd: S,
    members: &mut [T],
    below: &impl Fn(&Reference) -> bool,
) -> (usize, Span, Span) {
    // Every member changes places with the first that is not below, itself included: no branch to guess wrong. The
    // spans follow in loops of their own, which keep them in registers: half the time of both at once.
    let mut middle = 0;
    for i in 0..members.len() {
        let is_below = below(members[i].reference());
        members.swap(i, middle);
        middle += usize::from(is_below);
    }
    let (low, high) = members.split_at(middle);
    (middle, Span::of_few(simd, low), Span::of_few(simd, high))
}

/// Brings the pieces' parts together: what lies on the wrong side of `middle` changes places, run by run.
fn exchange<T: Send>(members: &mut [T], middle: usize, counts: impl Iterator<Item = usize>) {
    let (front, back) = members.split_at_mut(middle);
    let length = front.len() + back.len();
    // The runs of `high` members before the middle and of `low` ones behind it, in order.
    let (mut strays_front, mut strays_back) = (Vec::new(), Vec::new());
    for (piece, count) in counts.enumerate() {
        let start = piece * PIECE;
        let end = (start + PIECE).min(length);
        let (low, high) = (start..start + count, start + count..end);
        strays_front.push(high.start.min(middle)..high.end.min(middle));
        strays_back.push(low.start.max(middle) - middle..low.end.max(middle) - middle);
    }
    let mut front = runs(front, &strays_front);
    let mut back = runs(back, &strays_back);
    let mut pairs = Vec::new();
    let (mut a, mut b): (&mut [T], &mut [T]) = (&mut [], &mut []);
    loop {
        if a.is_empty() {
            let Some(next) = front.next() else { break };
            a = next;
        } else if b.is_empty() {
            let Some(next) = back.next() else { break };
            b = next;
        } else {
            let count = a.len().min(b.len());
            let (a_now, a_rest) = a.split_at_mut(count);
            let (b_now, b_rest) = b.split_at_mut(count);
            pairs.push((a_now, b_now));
            (a, b) = (a_rest, b_rest);
        }
    }
    pairs.into_par_iter().for_each(|(a, b)| a.swap_with_slice(b));
}

/// The pieces of a slice that ascending ranges name; empty ranges have none.
pub fn runs<'a, T>(
    mut slice: &'a mut [T],
    ranges: &[std::ops::Range<usize>],
) -> std::vec::IntoIter<&'a mut [T]> {
    let mut taken = 0;
    let mut runs = Vec::new();
    for range in ranges.iter().filter(|range| !range.is_empty()) {
        let (_, rest) = slice.split_at_mut(range.start - taken);
        let (run, rest) = rest.split_at_mut(range.len());
        runs.push(run);
        (slice, taken) = (rest, range.end);
    }
    runs.into_iter()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::simd::level;

    #[test]
    fn many_references_are_parted_as_few_are() {
        let at = |i: u32| NarrowBox { low: [i as f32; 3], high: [i as f32 + 1.0; 3] };
        for count in [0, 1, 7, PIECE as u32, PIECE as u32 * 5 + 123] {
            let mut state = 1_u32;
            let mut references: Vec<_> = (0..count)
                .map(|number| {
                    state = state.wrapping_mul(1_664_525).wrapping_add(1_013_904_223);
                    Reference::new(at(state >> 16), number)
                })
                .collect();
            let below = |reference: &Reference| reference.0[0] < 20_000.0;
            let expected = references.iter().filter(|reference| below(reference)).count();
            let (middle, low, high) = part(level(), &mut references, below);
            assert_eq!(middle, expected);
            assert!(references[..middle].iter().all(below));
            assert!(!references[middle..].iter().any(below));
            let mut numbers: Vec<_> = references.iter().map(Reference::number).collect();
            numbers.sort_unstable();
            assert!(numbers.into_iter().eq(0..count));
            assert_eq!(low.bounds.low(0), Span::of(level(), &references[..middle]).bounds.low(0));
            assert_eq!(high.centers.high(0), Span::of(level(), &references[middle..]).centers.high(0));
        }
    }
}

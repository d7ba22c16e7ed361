//! What the builder moves: one reference an item, and how a range of them is parted in place.

use crate::narrow::NarrowBox;
use rayon::prelude::*;

/// Ranges with more references are parted by all threads, piece by piece; the pieces never depend on the threads.
pub const PIECE: usize = 1 << 15;

/// An item while the tree grows: its box and its number, 32 bytes.
///
/// The number's bits stand in a float lane so that the box is two vectors. They are only ever copied; bit 30 is
/// flipped so that, whatever the number, they are a normal float and slow no arithmetic on the whole vector down.
#[derive(Clone, Copy, Debug)]
#[repr(C, align(16))]
pub struct Reference {
    low: [f32; 4],
    high: [f32; 4],
}

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
        Self { low: [a, b, c, f32::from_bits(number ^ FLIP)], high: [d, e, f, 0.0] }
    }

    /// The item's number.
    pub fn number(&self) -> u32 {
        self.low[3].to_bits() ^ FLIP
    }

    /// What a builder knows of a range of this one alone.
    #[cfg(test)]
    pub fn span(&self) -> Span {
        Span::of(&[*self])
    }

    /// Twice the centre of the box.
    #[inline(always)]
    pub fn center(&self) -> [f32; 4] {
        std::array::from_fn(|i| self.low[i] + self.high[i])
    }
}

/// A box that grows, four lanes wide so that the compiler uses vectors; the fourth lane means nothing.
#[derive(Clone, Copy, Debug)]
#[repr(C, align(16))]
pub struct Extent {
    /// The smallest coordinates.
    pub low: [f32; 4],
    /// The largest.
    pub high: [f32; 4],
}

impl Extent {
    /// The box that holds nothing.
    pub const EMPTY: Self = Self { low: [f32::INFINITY; 4], high: [f32::NEG_INFINITY; 4] };

    /// Takes in a reference's box.
    #[inline(always)]
    pub fn add(&mut self, reference: &Reference) {
        self.low = min(self.low, reference.low);
        self.high = max(self.high, reference.high);
    }

    /// Takes in a point.
    #[inline(always)]
    pub fn add_point(&mut self, point: [f32; 4]) {
        self.low = min(self.low, point);
        self.high = max(self.high, point);
    }

    /// Takes in a box.
    #[inline(always)]
    pub fn join(&mut self, other: &Self) {
        self.low = min(self.low, other.low);
        self.high = max(self.high, other.high);
    }

    /// Half the surface; 0 where it is empty.
    #[inline(always)]
    pub fn half_area(&self) -> f32 {
        let edges: [f32; 4] = std::array::from_fn(|i| self.high[i] - self.low[i]);
        let [x, y, z, _] = max(edges, [0.0; 4]);
        x * (y + z) + y * z
    }

    /// The box as nodes hold it.
    pub fn narrow(&self) -> NarrowBox {
        let ([a, b, c, _], [d, e, f, _]) = (self.low, self.high);
        NarrowBox { low: [a, b, c], high: [d, e, f] }
    }
}

/// The lesser of each lane, in a form that is one instruction.
#[inline(always)]
fn min(a: [f32; 4], b: [f32; 4]) -> [f32; 4] {
    std::array::from_fn(|i| if b[i] < a[i] { b[i] } else { a[i] })
}

/// The greater of each lane.
#[inline(always)]
fn max(a: [f32; 4], b: [f32; 4]) -> [f32; 4] {
    std::array::from_fn(|i| if b[i] > a[i] { b[i] } else { a[i] })
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
    pub fn of<T: Member>(members: &[T]) -> Self {
        if members.len() <= PIECE {
            return Self::of_few(members);
        }
        members.par_chunks(PIECE).map(Self::of_few).reduce(|| Self::EMPTY, Self::joined)
    }

    /// Of these, by this thread.
    #[inline(always)]
    fn of_few<T: Member>(members: &[T]) -> Self {
        let mut span = Self::EMPTY;
        members.iter().for_each(|member| span.add(member.reference()));
        span
    }

    /// Takes in a reference.
    #[inline(always)]
    pub fn add(&mut self, reference: &Reference) {
        self.bounds.add(reference);
        self.centers.add_point(reference.center());
    }

    /// Of two ranges together.
    pub fn joined(mut self, other: Self) -> Self {
        self.bounds.join(&other.bounds);
        self.centers.join(&other.centers);
        self
    }
}

/// Parts the members in place, those that are `below` first; returns how many they are and both spans.
pub fn part<T: Member>(members: &mut [T], below: impl Fn(&Reference) -> bool + Sync) -> (usize, Span, Span) {
    if members.len() <= PIECE {
        return part_piece(members, &below);
    }
    let pieces: Vec<_> = members.par_chunks_mut(PIECE).map(|piece| part_piece(piece, &below)).collect();
    let middle = pieces.iter().map(|&(count, ..)| count).sum();
    let spans = pieces
        .iter()
        .fold((Span::EMPTY, Span::EMPTY), |(a, b), &(_, low, high)| (a.joined(low), b.joined(high)));
    exchange(members, middle, pieces.iter().map(|&(count, ..)| count));
    (middle, spans.0, spans.1)
}

/// Parts one piece.
fn part_piece<T: Member>(members: &mut [T], below: &impl Fn(&Reference) -> bool) -> (usize, Span, Span) {
    // Every member changes places with the first that is not below, itself included: no branch to guess wrong. The
    // spans follow in loops of their own, which keep them in registers: half the time of both at once.
    let mut middle = 0;
    for i in 0..members.len() {
        let member = members[i];
        members[i] = members[middle];
        members[middle] = member;
        middle += usize::from(below(member.reference()));
    }
    let (low, high) = members.split_at(middle);
    (middle, Span::of_few(low), Span::of_few(high))
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

/// The pieces of a slice that ascending ranges name.
fn runs<'a, T>(mut slice: &'a mut [T], ranges: &[std::ops::Range<usize>]) -> std::vec::IntoIter<&'a mut [T]> {
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
            let below = |reference: &Reference| reference.low[0] < 20_000.0;
            let expected = references.iter().filter(|reference| below(reference)).count();
            let (middle, low, high) = part(&mut references, below);
            assert_eq!(middle, expected);
            assert!(references[..middle].iter().all(below));
            assert!(!references[middle..].iter().any(below));
            let mut numbers: Vec<_> = references.iter().map(Reference::number).collect();
            numbers.sort_unstable();
            assert!(numbers.into_iter().eq(0..count));
            assert_eq!(low.bounds.low, Span::of(&references[..middle]).bounds.low);
            assert_eq!(high.centers.high[0], Span::of(&references[middle..]).centers.high[0]);
        }
    }
}

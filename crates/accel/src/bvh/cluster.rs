//! References sorted into the cells of a grid, so that the upper levels of a tree move clusters instead of references.
//!
//! Parting by the surface-area heuristic looks at every reference once a level, about 22 ns each, over some fourteen
//! levels from 2^16 references down to a leaf. Sorted into cells of about eight first, which costs less than one
//! level, the levels down to some hundred references part clusters: eight times fewer. Clusters are as large as the
//! references in them, not as the cells, and the levels below part references as before, so that the tree is nearly as
//! good.
//! (The idea is that of Garanzha, Pantaleoni and McAllister, "Simpler and faster HLBVH with work queues", 2011; they
//! sort along a Morton curve and we into a grid, since the clusters are ordered by the parting anyway.)

use crate::bvh::partition::Member;
use crate::bvh::partition::Reference;
use crate::bvh::partition::Span;
use crate::simd::Level;

/// References whose centres lie in one cell.
#[derive(Clone, Copy, Debug)]
pub struct Cluster {
    /// Their box.
    whole: Reference,
    start: u32,
    count: u32,
}

impl Member for Cluster {
    fn reference(&self) -> &Reference {
        &self.whole
    }

    fn weight(&self) -> usize {
        self.count as usize
    }
}

impl Cluster {
    /// The references of this cluster among the sorted ones.
    pub fn of<'a>(&self, sorted: &'a [Reference]) -> &'a [Reference] {
        &sorted[self.start as usize..(self.start + self.count) as usize]
    }
}

/// The grid over the centres: how many bits of a cell's number each axis has.
struct Grid {
    low: [f32; 3],
    scale: [f32; 3],
    bits: [u32; 3],
}

impl Grid {
    /// Some 2^`total` cells, nearly cubes.
    fn new(span: &Span, total: u32) -> Self {
        let length: [f32; 3] = std::array::from_fn(|axis| span.centers.high(axis) - span.centers.low(axis));
        let mut edge = length;
        let mut bits = [0; 3];
        for _ in 0..total {
            let longest = if edge[0] >= edge[1] && edge[0] >= edge[2] {
                0
            } else if edge[1] >= edge[2] {
                1
            } else {
                2
            };
            edge[longest] *= 0.5;
            bits[longest] += 1;
        }
        let scale = std::array::from_fn(|axis| {
            // A little less than all cells' worth, so that the last centre falls into the last cell.
            if length[axis] > 1e-30 { (1_u32 << bits[axis]) as f32 * 0.999_99 / length[axis] } else { 0.0 }
        });
        Self { low: [0, 1, 2].map(|axis| span.centers.low(axis)), scale, bits }
    }

    #[inline(always)]
    fn cell(&self, reference: &Reference) -> usize {
        let place =
            |axis: usize| ((reference.center_on(axis) - self.low[axis]) * self.scale[axis]) as u32 as usize;
        (place(2) << self.bits[1] | place(1)) << self.bits[0] | place(0)
    }
}

/// References in the order of their cells, and the clusters of all cells that hold any.
pub struct Clusters {
    /// The references, cell by cell.
    pub sorted: Vec<Reference>,
    /// The cells that hold any.
    pub clusters: Vec<Cluster>,
}

/// The binary logarithm of how many references a cell has, were they spread evenly.
const SPREAD: u32 = 3;

impl Clusters {
    /// Sorts the references into cells; `None` where more than a quarter would share one, whom clusters cannot help.
    pub fn of(level: Level, references: &[Reference], span: &Span) -> Option<Self> {
        let bits = references.len().ilog2().saturating_sub(SPREAD);
        let grid = Grid::new(span, bits);
        let cells: Vec<u32> = references.iter().map(|reference| grid.cell(reference) as u32).collect();
        let mut ends = vec![0_u32; 1 << bits];
        cells.iter().for_each(|&cell| ends[cell as usize] += 1);
        if ends.iter().any(|&count| count as usize > references.len() / 4) {
            return None;
        }
        let mut clusters = Vec::new();
        let mut start = 0;
        for end in &mut ends {
            let count = std::mem::replace(end, start);
            if count > 0 {
                clusters.push((start, count));
            }
            start += count;
        }
        let mut sorted = references.to_vec();
        for (reference, &cell) in references.iter().zip(&cells) {
            let place = &mut ends[cell as usize];
            sorted[*place as usize] = *reference;
            *place += 1;
        }
        let cluster = |(start, count)| {
            let members = &sorted[start as usize..(start + count) as usize];
            Cluster { whole: Reference::new(Span::of(level, members).bounds.narrow(), 0), start, count }
        };
        let clusters = clusters.into_iter().map(cluster).collect();
        Some(Self { sorted, clusters })
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::narrow::NarrowBox;
    use crate::simd::level;

    #[test]
    fn every_reference_is_in_one_cluster_that_holds_it() {
        let mut state = 1_u32;
        let mut random = || {
            state = state.wrapping_mul(1_664_525).wrapping_add(1_013_904_223);
            (state >> 8) as f32 / (1 << 24) as f32
        };
        let references: Vec<Reference> = (0..5000)
            .map(|number| {
                let low = [random(), random() * 0.1, random() * random()];
                Reference::new(NarrowBox { low, high: low.map(|x| x + 0.01) }, number)
            })
            .collect();
        let Clusters { sorted, clusters } =
            Clusters::of(level(), &references, &Span::of(level(), &references)).unwrap();
        let mut numbers: Vec<u32> = Vec::new();
        for cluster in &clusters {
            let bounds = cluster.reference().span().bounds;
            for member in cluster.of(&sorted) {
                numbers.push(member.number());
                let own = member.span().bounds;
                assert!((0..3).all(|i| bounds.low(i) <= own.low(i) && own.high(i) <= bounds.high(i)));
            }
        }
        numbers.sort_unstable();
        assert!(numbers.into_iter().eq(0..5000));
        assert!(clusters.len() > 100, "{}", clusters.len());
    }

    #[test]
    fn references_in_one_place_are_no_clusters() {
        let same = NarrowBox { low: [0.1, 0.2, 0.3], high: [0.2, 0.3, 0.4] };
        let references: Vec<Reference> = (0..5000).map(|number| Reference::new(same, number)).collect();
        assert!(Clusters::of(level(), &references, &Span::of(level(), &references)).is_none());
    }
}

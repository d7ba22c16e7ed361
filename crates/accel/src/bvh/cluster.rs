//! References counted into the cells of a grid, so that the upper levels of a tree move clusters instead of references.
//!
//! Parting by the surface-area heuristic looks at every reference once a level, about 20 ns each, over some twenty
//! levels from 2^23 references down to a leaf. Counted into cells first, which costs less than one level, the levels
//! above the cells part clusters, hundreds of times fewer; the references then move once, to the cluster that holds
//! them. Clusters are as large as the references in them, not as the cells, and the levels below part references as
//! before, so that the tree is nearly as good.
//! (The idea is that of Garanzha, Pantaleoni and McAllister, "Simpler and faster HLBVH with work queues", 2011; they
//! sort along a Morton curve and we into a grid, since the clusters are ordered by the parting anyway.)

use crate::bvh::partition::Extent;
use crate::bvh::partition::Member;
use crate::bvh::partition::PIECE;
use crate::bvh::partition::Reference;
use crate::bvh::partition::Span;
use crate::bvh::partition::runs;
use crate::simd::Level;
use crate::simd::Simd;
use crate::simd::dispatch;
use crate::simd::f32x4;
use crate::simd::i32x4;
use crate::simd::prelude::*;
use rayon::prelude::*;

/// References whose centres lie in one cell.
#[derive(Clone, Copy, Debug)]
pub struct Cluster {
    /// Their box.
    whole: Reference,
    cell: u32,
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

/// The grid over the centres: how many bits of a cell's number each axis has.
struct Grid {
    low: [f32; 4],
    scale: [f32; 4],
    bits: [u32; 3],
    /// A reference with a longer edge is a cluster of its own: a floor below a thousand things, counted into a cell,
    /// would make that cluster, and all nodes above it, as large as the scene.
    longest: [f32; 4],
}

/// So many cells long may a reference be.
const LONGEST: f32 = 4.0;

/// At most one in so many references may be a cluster of its own.
const FEW: usize = 64;

impl Grid {
    /// Some 2^`total` cells, nearly cubes.
    fn new(span: &Span, total: u32) -> Self {
        let length = [0, 1, 2].map(|axis| span.centers.high(axis) - span.centers.low(axis));
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
        let (mut low, mut scale, mut longest) = ([0.0; 4], [0.0; 4], [f32::INFINITY; 4]);
        for axis in 0..3 {
            low[axis] = span.centers.low(axis);
            // A little less than all cells' worth, so that the last centre falls into the last cell.
            if length[axis] > 1e-30 {
                scale[axis] = (1_u32 << bits[axis]) as f32 * 0.999_99 / length[axis];
                // Centres are twice what they are.
                longest[axis] = LONGEST * 0.5 / scale[axis];
            }
        }
        Self { low, scale, bits, longest }
    }

    /// Counts references into the cells of a table; returns each one's cell, [`ALONE`] for those that are too long.
    #[inline(always)]
    fn count<S: Simd>(&self, simd: S, references: &[Reference], table: &mut Table) -> Vec<u32> {
        let (low, scale) = (f32x4::load_array(simd, self.low), f32x4::load_array(simd, self.scale));
        let longest = f32x4::load_array(simd, self.longest);
        let cell_of = |reference: &Reference| {
            let bounds = reference.vector(simd);
            let (smallest, negated) = bounds.split();
            if (-(smallest + negated)).simd_gt(longest).to_bitmask() & 7 != 0 {
                return ALONE;
            }
            let place = ((smallest - negated - low) * scale).to_int::<i32x4<S>>().to_array();
            let cell =
                ((place[2] as u32) << self.bits[1] | place[1] as u32) << self.bits[0] | place[0] as u32;
            table.extents[cell as usize].add(simd, bounds);
            table.counts[cell as usize] += 1;
            cell
        };
        references.iter().map(cell_of).collect()
    }
}

/// The cell of a reference that is a cluster of its own, until it has one.
const ALONE: u32 = u32::MAX;

/// What lies in each cell.
struct Table {
    extents: Vec<Extent>,
    counts: Vec<u32>,
}

impl Table {
    fn new(cells: usize) -> Self {
        Self { extents: vec![Extent::EMPTY; cells], counts: vec![0; cells] }
    }

    /// A cell of its own for one reference.
    fn push(&mut self, reference: &Reference) -> u32 {
        self.extents.push(Extent::of(reference));
        self.counts.push(1);
        self.counts.len() as u32 - 1
    }

    fn joined(mut self, other: &Self) -> Self {
        self.extents.iter_mut().zip(&other.extents).for_each(|(own, other)| own.join(other));
        self.counts.iter_mut().zip(&other.counts).for_each(|(own, other)| *own += other);
        self
    }
}

/// The clusters of all cells that hold any reference, and which cell holds which.
pub struct Clusters {
    /// The clusters, to be put in order.
    pub clusters: Vec<Cluster>,
    /// The cell of each reference, in lists of one length, but for the last.
    cells: Vec<Vec<u32>>,
    /// So many cells there are.
    count: usize,
}

impl Clusters {
    /// Counts the references into some 2^`bits` cells, by all threads where they are many; `None` where more than a
    /// quarter would share one, or too many be too long for any: clusters cannot help those.
    pub fn of(level: Level, references: &[Reference], span: &Span, bits: u32) -> Option<Self> {
        let grid = Grid::new(span, bits);
        let piece = references.len().div_ceil(2 * rayon::current_num_threads()).max(PIECE);
        let counted: Vec<_> = references
            .par_chunks(piece)
            .map(|references| {
                let mut table = Table::new(1 << bits);
                let cells = dispatch!(level, simd => grid.count(simd, references, &mut table));
                (cells, table)
            })
            .collect();
        let (mut cells, tables): (Vec<_>, Vec<_>) = counted.into_iter().unzip();
        let mut tables = tables.into_iter();
        let table = tables.next()?;
        let mut table = tables.fold(table, |all, table| all.joined(&table));
        let counted: usize = table.counts.iter().map(|&count| count as usize).sum();
        if table.counts.iter().any(|&count| count as usize > references.len() / 4)
            || references.len() - counted > references.len() / FEW
        {
            return None;
        }
        for (reference, cell) in references.iter().zip(cells.iter_mut().flatten()) {
            if *cell == ALONE {
                *cell = table.push(reference);
            }
        }
        let cluster = |(cell, (extent, &count)): (usize, (&Extent, &u32))| Cluster {
            whole: Reference::new(extent.narrow(), 0),
            cell: cell as u32,
            count,
        };
        let held = table.extents.iter().zip(&table.counts).enumerate();
        let clusters = held.filter(|(_, (_, count))| **count > 0).map(cluster).collect();
        let count = table.counts.len();
        Some(Self { clusters, cells, count })
    }

    /// Puts the references in the order in which their clusters stand now.
    pub fn sort(&self, references: &mut [Reference]) {
        let mut starts = vec![0_u32; self.count];
        let mut end = 0;
        // Each thread fills one part of the whole, which ends with a cluster, and passes all others over.
        let share = references.len().div_ceil(rayon::current_num_threads()).max(PIECE);
        let (mut parts, mut first) = (Vec::new(), 0);
        for cluster in &self.clusters {
            starts[cluster.cell as usize] = end;
            end += cluster.count;
            if end as usize - first >= share {
                parts.push(first..end as usize);
                first = end as usize;
            }
        }
        parts.push(first..references.len());
        let mut sorted = references.to_vec();
        let piece = self.cells.first().map_or(1, Vec::len);
        // Only the last part may be empty, and such have no slice.
        let slices: Vec<_> = runs(&mut sorted, &parts).zip(&parts).collect();
        slices.into_par_iter().for_each(|(slice, part)| {
            let mut next = starts.clone();
            for (references, cells) in references.chunks(piece).zip(&self.cells) {
                for (reference, &cell) in references.iter().zip(cells) {
                    let place = (next[cell as usize] as usize).wrapping_sub(part.start);
                    if let Some(free) = slice.get_mut(place) {
                        *free = *reference;
                        next[cell as usize] += 1;
                    }
                }
            }
        });
        references
            .par_chunks_mut(PIECE)
            .zip(sorted.par_chunks(PIECE))
            .for_each(|(to, from)| to.copy_from_slice(from));
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::narrow::NarrowBox;
    use crate::simd::level;

    #[test]
    fn every_reference_comes_to_stand_in_the_cluster_that_holds_it() {
        let mut state = 1_u32;
        let mut random = || {
            state = state.wrapping_mul(1_664_525).wrapping_add(1_013_904_223);
            (state >> 8) as f32 / (1 << 24) as f32
        };
        // More than one piece, so that several threads count and sort.
        let many = PIECE as u32 * 2 + 77;
        let mut references: Vec<Reference> = (0..many)
            .map(|number| {
                let low = [random(), random() * 0.1, random() * random()];
                Reference::new(NarrowBox { low, high: low.map(|x| x + 0.01) }, number)
            })
            .collect();
        let mut clusters = Clusters::of(level(), &references, &Span::of(level(), &references), 9).unwrap();
        assert!(clusters.clusters.len() > 100, "{}", clusters.clusters.len());
        clusters.clusters.reverse();
        clusters.sort(&mut references);
        let mut numbers: Vec<u32> = Vec::new();
        let mut rest = &references[..];
        for cluster in &clusters.clusters {
            let bounds = cluster.reference().span().bounds;
            let (members, behind) = rest.split_at(cluster.weight());
            for member in members {
                numbers.push(member.number());
                let own = member.span().bounds;
                assert!((0..3).all(|i| bounds.low(i) <= own.low(i) && own.high(i) <= bounds.high(i)));
            }
            rest = behind;
        }
        assert!(rest.is_empty());
        numbers.sort_unstable();
        assert!(numbers.into_iter().eq(0..many));
    }

    #[test]
    fn references_in_one_place_are_no_clusters() {
        let same = NarrowBox { low: [0.1, 0.2, 0.3], high: [0.2, 0.3, 0.4] };
        let references: Vec<Reference> = (0..5000).map(|number| Reference::new(same, number)).collect();
        assert!(Clusters::of(level(), &references, &Span::of(level(), &references), 9).is_none());
    }
}

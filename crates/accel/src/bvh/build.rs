//! Builds a tree of eight-wide nodes from the top, by the binned surface-area heuristic.
//!
//! A node takes a range of references and parts the piece with the largest surface until it has eight; pieces that
//! no further parting would make cheaper, and that fit one, become leaves. (Wald, "On fast construction of SAH-based
//! bounding volume hierarchies", 2007; the greedy widening is Embree's. We make wide nodes at once instead of folding
//! a binary tree, which would take another 32 bytes an item.)
//!
//! **Memory.** 32 bytes an item for its reference while it grows, besides the order (4 bytes) and the tree itself;
//! 36 more for a moment, while clusters are sorted; nothing is allocated per item.
//! **Depth.** Below [`FREE_DEPTH`] levels pieces are halved by count, so the tree ends at most 10 levels further down,
//! whatever the items: [`MAX_STACK`] follows.
//! **Order.** Ranges are cut by their contents only,
//! and pieces that grow on several threads are put together in their order: threads leave no trace.

use crate::bvh::cluster::Cluster;
use crate::bvh::cluster::Clusters;
use crate::bvh::partition::Member;
use crate::bvh::partition::Reference;
use crate::bvh::partition::Span;
use crate::bvh::partition::part;
use crate::bvh::split::best_split;
use crate::bvh::split::leaf_cost;
use crate::bvh::wide::Child;
use crate::bvh::wide::MAX_LEAF;
use crate::bvh::wide::WIDTH;
use crate::bvh::wide::WideNode;
use crate::input::Quality;
use crate::simd::Level;
use rayon::prelude::*;
use std::ops::Range;

/// So many levels may be cut unevenly. Eight millions of items in even cuts need seven.
const FREE_DEPTH: u32 = 24;

/// The most children that can wait in a tree of one build: seven a level, on 24 levels and the ten below, which
/// suffice to halve 2^28 items down to eight, three times a level.
pub const MAX_STACK: usize = 7 * (FREE_DEPTH as usize + 10);

/// Ranges with at least so many references grow their pieces on several threads.
const PARALLEL: usize = 1 << 12;

/// Ranges of so many references are parted by way of clusters of [`SMALL_CELL`]: shorter ones gain nothing, and longer
/// ones would be sorted out of the cache.
const SMALL: Range<usize> = 1 << 15..1 << 18;

/// Ranges of at least so many references are parted by way of clusters of large cells.
const LARGE: usize = 1 << 20;

/// The binary logarithm of how many references a small cell has, were they spread evenly.
const SMALL_CELL: u32 = 3;

/// There are two to the power of so many large cells: their table stays in the cache.
const LARGE_CELL_BITS: u32 = 13;

/// How a range is counted into cells.
#[derive(Clone, Copy, Debug)]
struct Cells {
    /// There are two to the power of so many.
    bits: u32,
    /// So many clusters are parted no further, nor are clusters that hold so many references in all: few enough that
    /// the surface-area heuristic may look at each reference, or at smaller cells.
    together: (usize, usize),
}

impl Cells {
    /// For so many references, where clusters help.
    fn over(count: usize) -> Option<Self> {
        if SMALL.contains(&count) {
            Some(Self { bits: count.ilog2() - SMALL_CELL, together: (1, 128) })
        } else if count >= LARGE {
            Some(Self { bits: LARGE_CELL_BITS, together: (32, SMALL.end / 2) })
        } else {
            None
        }
    }
}

/// The bit of a reference's number that says that it is not an item but another tree, which becomes a link.
pub const LINK: u32 = 1 << 31;

/// How to build.
#[derive(Clone, Copy, Debug)]
pub struct Builder {
    /// Building time against tracing time.
    pub quality: Quality,
    /// The instructions to use: the tree is the same with all.
    pub level: Level,
}

/// A piece of a node's range.
#[derive(Clone, Copy, Debug)]
struct Piece {
    start: usize,
    end: usize,
    span: Span,
    /// Half the surface of its box.
    area: f32,
    /// How many references it holds: as many as members, unless those are clusters.
    weight: usize,
    /// Whether all of it may stand in one leaf (or is one link); of clusters, whether they are parted no further.
    fits: bool,
    /// Whether it should not be parted any further.
    closed: bool,
}

/// A range of references over which something is to grow.
#[derive(Clone, Copy, Debug)]
struct Bough {
    /// The position of the first of them in the end.
    first: u32,
    count: usize,
    /// What is known of them; `None` where that is to be found out.
    span: Option<Span>,
    depth: u32,
}

impl Piece {
    fn len(&self) -> usize {
        self.end - self.start
    }
}

impl Builder {
    /// Builds over the references, whose first stands at position `first` in the end, and appends nodes; returns what
    /// stands at the top. The references are left in the order of the leaves.
    pub fn build(&self, references: &mut [Reference], first: u32, nodes: &mut Vec<WideNode>) -> Child {
        if references.is_empty() {
            return Child::ABSENT;
        }
        if let Some(child) = self.leaf(references, first) {
            return child;
        }
        let span = Span::of(self.level, references);
        self.grow(references, first, span, 0, nodes)
    }

    /// A leaf or link of all the references, where they fit one.
    fn leaf(&self, references: &[Reference], first: u32) -> Option<Child> {
        if let [reference] = references
            && reference.number() & LINK != 0
        {
            return Some(Child::link(reference.number() & !LINK));
        }
        self.fits(references).then(|| Child::leaf(first, references.len() as u32))
    }

    /// Whether all the references fit one leaf, or are one link.
    fn fits(&self, references: &[Reference]) -> bool {
        references.len() == 1
            || (references.len() <= MAX_LEAF
                && references.iter().all(|reference| reference.number() & LINK == 0))
    }

    /// Makes a node of more references than fit a leaf, and all below it.
    fn grow(
        &self,
        references: &mut [Reference],
        first: u32,
        span: Span,
        depth: u32,
        nodes: &mut Vec<WideNode>,
    ) -> Child {
        if let Some(child) = self.grow_by_cells(references, first, &span, depth, nodes) {
            return child;
        }
        let number = nodes.len();
        nodes.push(WideNode::EMPTY);
        let (pieces, count) = self.pieces(references, span, depth, |part| self.fits(part));
        let pieces = &pieces[..count];
        let bough = |piece: &Piece| Bough {
            first: first + piece.start as u32,
            count: piece.len(),
            span: Some(piece.span),
            depth: depth + 1,
        };
        let mut children = [Child::ABSENT; WIDTH];
        if references.len() < PARALLEL {
            for (child, piece) in children.iter_mut().zip(pieces) {
                *child = self.bough(&mut references[piece.start..piece.end], &bough(piece), nodes);
            }
        } else {
            let boughs: Vec<Bough> = pieces.iter().map(bough).collect();
            let grown = self.boughs(references, &boughs, 1, nodes);
            children[..count].copy_from_slice(&grown);
        }
        for (lane, piece) in pieces.iter().enumerate() {
            nodes[number].set(lane, &piece.span.bounds.narrow(), children[lane]);
        }
        Child::node(number as u32)
    }

    /// The same by way of clusters, where there are enough references and clusters help.
    fn grow_by_cells(
        &self,
        references: &mut [Reference],
        first: u32,
        span: &Span,
        depth: u32,
        nodes: &mut Vec<WideNode>,
    ) -> Option<Child> {
        if depth > FREE_DEPTH / 2 || self.quality == Quality::Best {
            return None;
        }
        let cells = Cells::over(references.len())?;
        let mut clusters = Clusters::of(self.level, references, span, cells.bits)?;
        let span = Span::of(self.level, &clusters.clusters);
        let (start, mut boughs) = (nodes.len(), Vec::new());
        let top = self.grow_clusters(
            &mut clusters.clusters,
            cells.together,
            first,
            span,
            depth,
            nodes,
            &mut boughs,
        );
        clusters.sort(references);
        let end = nodes.len();
        let grown = self.boughs(references, &boughs, PARALLEL, nodes);
        for node in &mut nodes[start..end] {
            node.children = node.children.map(|child| child.resolved(&grown));
        }
        Some(top)
    }

    /// Makes a node of more clusters than stay together, and all above those; these become boughs, to which the nodes
    /// link by their number.
    #[expect(clippy::too_many_arguments, reason = "what is parted, what has been made, and where both stand")]
    fn grow_clusters(
        &self,
        clusters: &mut [Cluster],
        together: (usize, usize),
        first: u32,
        span: Span,
        depth: u32,
        nodes: &mut Vec<WideNode>,
        boughs: &mut Vec<Bough>,
    ) -> Child {
        let number = nodes.len();
        nodes.push(WideNode::EMPTY);
        let stay = |clusters: &[Cluster]| clusters.len() <= together.0 || weight(clusters) <= together.1;
        let (pieces, count) = self.pieces(clusters, span, depth, stay);
        let mut place = first;
        for (lane, piece) in pieces[..count].iter().enumerate() {
            let child = if piece.fits || depth + 1 >= FREE_DEPTH {
                boughs.push(Bough { first: place, count: piece.weight, span: None, depth: depth + 1 });
                Child::link(boughs.len() as u32 - 1)
            } else {
                let members = &mut clusters[piece.start..piece.end];
                self.grow_clusters(members, together, place, piece.span, depth + 1, nodes, boughs)
            };
            nodes[number].set(lane, &piece.span.bounds.narrow(), child);
            place += piece.weight as u32;
        }
        Child::node(number as u32)
    }

    /// What stands at the top of each bough, over successive ranges of the references. Threads take `least` references
    /// at a time or more; theirs are nodes of their own, numbered from 0, which then move behind the ones before.
    fn boughs(
        &self,
        references: &mut [Reference],
        boughs: &[Bough],
        least: usize,
        nodes: &mut Vec<WideNode>,
    ) -> Vec<Child> {
        if rayon::current_num_threads() == 1 {
            return self.bundle(references, boughs, nodes);
        }
        let grown: Vec<_> = bundles(references, boughs, least)
            .into_par_iter()
            .map(|(references, boughs)| {
                let mut nodes = Vec::new();
                (self.bundle(references, boughs, &mut nodes), nodes)
            })
            .collect();
        let mut tops = Vec::with_capacity(boughs.len());
        nodes.reserve(grown.iter().map(|(_, nodes)| nodes.len()).sum());
        for (top, below) in grown {
            let offset = nodes.len() as u32;
            tops.extend(top.into_iter().map(|top| top.moved(offset)));
            nodes.extend(below.into_iter().map(|mut node| {
                node.children = node.children.map(|child| child.moved(offset));
                node
            }));
        }
        tops
    }

    /// The same by one thread.
    fn bundle(
        &self,
        mut references: &mut [Reference],
        boughs: &[Bough],
        nodes: &mut Vec<WideNode>,
    ) -> Vec<Child> {
        let mut tops = Vec::with_capacity(boughs.len());
        for bough in boughs {
            let (own, behind) = references.split_at_mut(bough.count);
            tops.push(self.bough(own, bough, nodes));
            references = behind;
        }
        tops
    }

    /// What stands at the top of one bough.
    fn bough(&self, references: &mut [Reference], bough: &Bough, nodes: &mut Vec<WideNode>) -> Child {
        if let Some(child) = self.leaf(references, bough.first) {
            return child;
        }
        let span = bough.span.unwrap_or_else(|| Span::of(self.level, references));
        self.grow(references, bough.first, span, bough.depth, nodes)
    }

    /// Parts a range into up to eight pieces, in their order; `fits` says which need not be parted.
    fn pieces<T: Member>(
        &self,
        members: &mut [T],
        span: Span,
        depth: u32,
        fits: impl Fn(&[T]) -> bool,
    ) -> ([Piece; WIDTH], usize) {
        let weight = weight(members);
        let area = span.bounds.half_area();
        let whole = Piece { start: 0, end: members.len(), span, area, weight, fits: false, closed: false };
        let mut pieces = [whole; WIDTH];
        let mut count = 1;
        while count < WIDTH {
            let Some(chosen) = choose(&pieces[..count], depth) else { break };
            let piece = pieces[chosen];
            let Some((low, high)) = self.cut(members, &piece, depth, &fits) else {
                pieces[chosen].closed = true;
                continue;
            };
            // The upper part goes right behind the lower one, so that pieces stay in the order of positions.
            pieces[count] = high;
            pieces[chosen] = low;
            pieces[chosen + 1..=count].rotate_right(1);
            count += 1;
        }
        (pieces, count)
    }

    /// Cuts a piece in two, unless it is cheaper as the leaf that it fits.
    fn cut<T: Member>(
        &self,
        members: &mut [T],
        piece: &Piece,
        depth: u32,
        fits: impl Fn(&[T]) -> bool,
    ) -> Option<(Piece, Piece)> {
        let range = &mut members[piece.start..piece.end];
        let split =
            if depth < FREE_DEPTH { best_split(self.level, range, &piece.span, self.quality) } else { None };
        let (middle, low, high) = match split {
            Some(split) if piece.fits => {
                let whole = piece.area * leaf_cost(piece.weight as u32);
                if split.cost >= whole {
                    return None;
                }
                part(self.level, range, |reference| split.below(reference))
            }
            Some(split) => part(self.level, range, |reference| split.below(reference)),
            None if piece.fits => return None,
            // All centres coincide, or the tree is deep: the halves by count.
            None => {
                let middle = range.len() / 2;
                (middle, Span::of(self.level, &range[..middle]), Span::of(self.level, &range[middle..]))
            }
        };
        let made = |start, end, span: Span| {
            let range = &members[start..end];
            let (weight, fits, area) = (weight(range), fits(range), span.bounds.half_area());
            Piece { start, end, span, area, weight, fits, closed: end - start == 1 }
        };
        let middle = piece.start + middle;
        Some((made(piece.start, middle, low), made(middle, piece.end, high)))
    }
}

/// For how many references the members stand.
fn weight(members: &[impl Member]) -> usize {
    members.iter().map(Member::weight).sum()
}

/// The piece to part next: the one with the largest surface, or far down the longest.
fn choose(pieces: &[Piece], depth: u32) -> Option<usize> {
    let open = pieces.iter().enumerate().filter(|(_, piece)| !piece.closed);
    if depth < FREE_DEPTH {
        open.max_by(|(_, a), (_, b)| a.area.total_cmp(&b.area)).map(|(i, _)| i)
    } else {
        open.filter(|(_, piece)| !piece.fits).max_by_key(|(_, piece)| piece.len()).map(|(i, _)| i)
    }
}

/// Successive boughs with at least so many references together, and these.
fn bundles<'a, 'b>(
    mut references: &'a mut [Reference],
    boughs: &'b [Bough],
    least: usize,
) -> Vec<(&'a mut [Reference], &'b [Bough])> {
    let mut bundles = Vec::new();
    let (mut start, mut count) = (0, 0);
    for (i, bough) in boughs.iter().enumerate() {
        count += bough.count;
        if count >= least || i + 1 == boughs.len() {
            let (bundle, behind) = references.split_at_mut(count);
            bundles.push((bundle, &boughs[start..=i]));
            (references, start, count) = (behind, i + 1, 0);
        }
    }
    bundles
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::narrow::NarrowBox;
    use crate::simd::available_levels;
    use crate::simd::level;

    /// Small boxes with a floor below them, all over the unit cube.
    fn boxes(count: u32) -> Vec<Reference> {
        let mut state = 7_u32;
        let mut random = || {
            state = state.wrapping_mul(1_664_525).wrapping_add(1_013_904_223);
            (state >> 8) as f32 / (1 << 24) as f32
        };
        let mut references: Vec<_> = (1..count)
            .map(|number| {
                let low = [random(), random() * random(), random()];
                Reference::new(NarrowBox { low, high: low.map(|x| x + 0.003) }, number)
            })
            .collect();
        references.push(Reference::new(NarrowBox { low: [0.0; 3], high: [1.0, 0.0, 1.0] }, 0));
        references
    }

    /// Everything that a tree of these references is: planes and children, and the order of the leaves.
    fn tree(level: Level, threads: usize, references: &[Reference]) -> (Vec<u32>, Vec<u32>) {
        let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().unwrap();
        let mut references = references.to_vec();
        let mut nodes = Vec::new();
        let builder = Builder { quality: Quality::Balanced, level };
        let top = pool.install(|| builder.build(&mut references, 0, &mut nodes));
        let words = |node: &WideNode| {
            let planes = node.planes.as_flattened().as_flattened().iter().map(|plane| plane.to_bits());
            planes.chain(node.children.map(|child| child.0)).collect::<Vec<_>>()
        };
        let words = [top.0].into_iter().chain(nodes.iter().flat_map(words)).collect();
        (words, references.iter().map(Reference::number).collect())
    }

    #[test]
    fn every_level_and_any_number_of_threads_build_the_same_tree() {
        for count in [100, 5_000, SMALL.start as u32 + 77, LARGE as u32 + 77] {
            let references = boxes(count);
            let expected = tree(level(), 1, &references);
            for threads in [2, 3] {
                assert!(tree(level(), threads, &references) == expected, "{count} on {threads} threads");
            }
            for level in available_levels().into_iter().take(if count > 100_000 { 1 } else { usize::MAX }) {
                assert!(tree(level, 1, &references) == expected, "{count} with {level:?}");
            }
        }
    }

    #[test]
    fn what_is_as_long_as_the_scene_is_a_cluster_of_its_own() {
        // The floor stands in one node near the top, and nowhere below is a box as large as the floor.
        let mut references = boxes(SMALL.start as u32 + 77);
        let mut nodes = Vec::new();
        let builder = Builder { quality: Quality::Balanced, level: level() };
        builder.build(&mut references, 0, &mut nodes);
        let wide = |node: &WideNode, lane: usize| {
            let bounds = node.bounds(lane);
            bounds.high[0] - bounds.low[0] > 0.99 && bounds.high[2] - bounds.low[2] > 0.99
        };
        let count =
            nodes.iter().map(|node| node.present().filter(|&lane| wide(node, lane)).count()).sum::<usize>();
        assert!(count <= 2, "{count} boxes as wide as the floor");
    }
}

//! Builds a tree of eight-wide nodes from the top, by the binned surface-area heuristic.
//!
//! A node takes a range of references and parts the piece with the largest surface until it has eight; pieces that
//! no further parting would make cheaper, and that fit one, become leaves. (Wald, "On fast construction of SAH-based
//! bounding volume hierarchies", 2007; the greedy widening is Embree's. We make wide nodes at once instead of folding
//! a binary tree, which would take another 32 bytes an item.)
//!
//! **Memory.** 32 bytes an item for its reference while the tree grows, besides the order (4 bytes) and the
//! tree itself; nothing is
//! allocated per item. **Depth.** Below [`FREE_DEPTH`] levels pieces are halved by count, so the tree ends at most
//! 10 levels further down, whatever the items: [`MAX_STACK`] follows. **Order.** Ranges are cut by their contents only,
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

/// So many levels may be cut unevenly. Eight millions of items in even cuts need seven.
const FREE_DEPTH: u32 = 24;

/// The most children that can wait in a tree of one build: seven a level, on 24 levels and the ten below, which
/// suffice to halve 2^28 items down to eight, three times a level.
pub const MAX_STACK: usize = 7 * (FREE_DEPTH as usize + 10);

/// Ranges with at least so many references grow their pieces on several threads.
const PARALLEL: usize = 1 << 12;

/// Ranges of so many references are parted by way of clusters: shorter ones gain nothing, and longer ones are parted by
/// all threads and sorted out of the cache.
const CLUSTERED: std::ops::Range<usize> = 1 << 15..1 << 18;

/// Clusters of so many references in all are parted no further.
const TOGETHER: usize = 128;

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
        if let Some(child) = self.grow_sorted(references, first, span, depth, nodes) {
            return child;
        }
        let number = nodes.len();
        nodes.push(WideNode::EMPTY);
        let (pieces, count) = self.pieces(references, span, depth, |part| self.fits(part));
        let pieces = &pieces[..count];
        let place = |piece: &Piece| first + piece.start as u32;
        let mut children = [Child::ABSENT; WIDTH];
        if references.len() < PARALLEL {
            for (child, piece) in children.iter_mut().zip(pieces) {
                let part = &mut references[piece.start..piece.end];
                *child = self.child(part, place(piece), piece, depth, nodes);
            }
        } else {
            // Each piece grows nodes of its own, numbered from 0, which then move behind the ones before.
            let grown: Vec<_> = slices(references, pieces)
                .into_par_iter()
                .zip(pieces.par_iter())
                .map(|(part, piece)| {
                    let mut nodes = Vec::new();
                    let child = self.child(part, place(piece), piece, depth, &mut nodes);
                    (child, nodes)
                })
                .collect();
            for (child, (top, below)) in children.iter_mut().zip(grown) {
                let offset = nodes.len() as u32;
                *child = top.moved(offset);
                nodes.extend(below.into_iter().map(|mut node| {
                    node.children = node.children.map(|child| child.moved(offset));
                    node
                }));
            }
        }
        for (lane, piece) in pieces.iter().enumerate() {
            nodes[number].set(lane, &piece.span.bounds.narrow(), children[lane]);
        }
        Child::node(number as u32)
    }

    /// The same by way of clusters, where the range is of a length that they suit.
    fn grow_sorted(
        &self,
        references: &mut [Reference],
        first: u32,
        span: Span,
        depth: u32,
        nodes: &mut Vec<WideNode>,
    ) -> Option<Child> {
        if !CLUSTERED.contains(&references.len()) || depth > FREE_DEPTH / 2 || self.quality == Quality::Best {
            return None;
        }
        let Clusters { sorted, mut clusters } = Clusters::of(self.level, references, &span)?;
        let span = Span::of(self.level, &clusters);
        Some(self.grow_clusters(&mut clusters, &sorted, references, first, span, depth, nodes))
    }

    /// Makes a node of more clusters than stay together, and all below it. The references in `sorted` come to stand
    /// in `references` in the order of the leaves.
    #[expect(clippy::too_many_arguments, reason = "the range and what it is copied from are two things each")]
    fn grow_clusters(
        &self,
        clusters: &mut [Cluster],
        sorted: &[Reference],
        references: &mut [Reference],
        first: u32,
        span: Span,
        depth: u32,
        nodes: &mut Vec<WideNode>,
    ) -> Child {
        let number = nodes.len();
        nodes.push(WideNode::EMPTY);
        let (pieces, count) = self.pieces(clusters, span, depth, stay_together);
        let (mut rest, mut place) = (references, first);
        for (lane, piece) in pieces[..count].iter().enumerate() {
            let members = &mut clusters[piece.start..piece.end];
            let (here, behind) = rest.split_at_mut(piece.weight);
            let child = if piece.fits || depth + 1 >= FREE_DEPTH {
                let mut end = 0;
                for part in members.iter().map(|cluster| cluster.of(sorted)) {
                    here[end..end + part.len()].copy_from_slice(part);
                    end += part.len();
                }
                let piece = Piece { span: Span::of(self.level, here), ..*piece };
                self.child(here, place, &piece, depth, nodes)
            } else {
                self.grow_clusters(members, sorted, here, place, piece.span, depth + 1, nodes)
            };
            nodes[number].set(lane, &piece.span.bounds.narrow(), child);
            place += piece.weight as u32;
            rest = behind;
        }
        Child::node(number as u32)
    }

    /// What stands below one piece.
    fn child(
        &self,
        references: &mut [Reference],
        first: u32,
        piece: &Piece,
        depth: u32,
        nodes: &mut Vec<WideNode>,
    ) -> Child {
        match self.leaf(references, first) {
            Some(child) => child,
            None => self.grow(references, first, piece.span, depth + 1, nodes),
        }
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

/// Whether clusters are parted no further: few enough that the surface-area heuristic may look at each reference.
fn stay_together(clusters: &[Cluster]) -> bool {
    clusters.len() == 1 || weight(clusters) <= TOGETHER
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

/// The pieces as slices of their own.
fn slices<'a>(mut references: &'a mut [Reference], pieces: &[Piece]) -> Vec<&'a mut [Reference]> {
    let mut slices = Vec::with_capacity(pieces.len());
    for piece in pieces {
        let (slice, rest) = references.split_at_mut(piece.len());
        slices.push(slice);
        references = rest;
    }
    slices
}

//! What an accelerator looks like inside, as data for dumps and tests.

use crate::input::Kind;
use dotray_geometry::Aabb;
use std::collections::VecDeque;
use std::fmt;

/// The figures of a built accelerator.
#[derive(Clone, Debug, PartialEq)]
pub struct Stats {
    /// Which of the five it is.
    pub kind: Kind,
    /// The items it was built over.
    pub items: u32,
    /// The longest way from the root to a leaf, in nodes.
    pub depth: u32,
    /// The inner nodes.
    pub nodes: usize,
    /// The leaves that hold items.
    pub leaves: usize,
    /// The mentions of items in leaves: as many as items, or more where items stand in several leaves.
    pub references: usize,
    /// `leaf_sizes[n]` leaves hold `n` items; the last entry also counts all larger ones.
    pub leaf_sizes: [usize; 17],
    /// The cost that the surface-area heuristic expects of a ray that meets the scene's box: a node counts 1, an item
    /// of a leaf 1.
    pub sah_cost: f64,
    /// The memory held, in bytes.
    pub bytes: usize,
}

impl Stats {
    /// The figures of a structure without nodes.
    pub(crate) fn empty(kind: Kind) -> Self {
        Self {
            kind,
            items: 0,
            depth: 0,
            nodes: 0,
            leaves: 0,
            references: 0,
            leaf_sizes: [0; 17],
            sah_cost: 0.0,
            bytes: 0,
        }
    }

    /// Counts a leaf of `count` items whose box has the share `area` of the scene's surface, `depth` nodes down.
    pub(crate) fn leaf(&mut self, count: usize, area: f64, depth: u32) {
        self.leaves += 1;
        self.references += count;
        self.leaf_sizes[count.min(16)] += 1;
        self.sah_cost += area * count as f64;
        self.depth = self.depth.max(depth);
    }

    /// Counts a node whose box has the share `area` of the scene's surface.
    pub(crate) fn node(&mut self, area: f64) {
        self.nodes += 1;
        self.sah_cost += area;
    }
}

impl fmt::Display for Stats {
    fn fmt(&self, out: &mut fmt::Formatter<'_>) -> fmt::Result {
        let per_leaf = self.references as f64 / self.leaves.max(1) as f64;
        write!(
            out,
            "{}: {} items, {} nodes, {} leaves of {per_leaf:.1} items, depth {}, cost {:.1}, {} bytes",
            self.kind.name(),
            self.items,
            self.nodes,
            self.leaves,
            self.depth,
            self.sah_cost,
            self.bytes
        )
    }
}

/// A box (or cell) of a structure.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Cell {
    /// Where it is.
    pub bounds: Aabb,
    /// How many nodes stand above it.
    pub depth: u32,
    /// Whether it holds items itself.
    pub is_leaf: bool,
}

/// What may stand below a box: a node `N` of the structure and its box.
pub(crate) type Below<N> = Vec<(N, Aabb)>;

/// The first `most` boxes of a structure, level by level from its top, so that what is left out are the smallest.
/// `below` answers with what stands below a node, or `None` for a leaf.
pub(crate) fn level_by_level<N>(
    top: (N, Aabb),
    most: usize,
    mut below: impl FnMut(&N, &Aabb) -> Option<Below<N>>,
) -> Vec<Cell> {
    let mut cells = Vec::new();
    let mut waiting = VecDeque::from([(top, 0)]);
    while let Some(((node, bounds), depth)) = waiting.pop_front().filter(|_| cells.len() < most) {
        let children = below(&node, &bounds);
        cells.push(Cell { bounds, depth, is_leaf: children.is_none() });
        // What does not fit any more need not wait.
        let room = most - cells.len();
        let children = children.into_iter().flatten().take(room.saturating_sub(waiting.len()));
        waiting.extend(children.map(|child| (child, depth + 1)));
    }
    cells
}

/// Why a structure is not well formed; only a fault of the builder can make one.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Defect(pub String);

impl fmt::Display for Defect {
    fn fmt(&self, out: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(out, "the accelerator is not well formed: {}", self.0)
    }
}

impl std::error::Error for Defect {}

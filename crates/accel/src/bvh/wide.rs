//! The layout of a tree of eight-wide nodes.

use crate::ahead;
use crate::narrow::Frame;
use crate::narrow::NarrowBox;

/// How many boxes a node holds.
pub const WIDTH: usize = 8;

/// The most items of a leaf.
pub const MAX_LEAF: usize = 8;

/// What stands below one box of a node: a node, or up to eight items at neighbouring positions.
///
/// One word holds it, so that with a distance in front it can be sorted and stacked as one number: bit 31 tells a
/// leaf, whose count less one has three bits and whose first position has 28; a node has its number.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Child(pub u32);

impl Child {
    /// Nothing: its box is the absent one, which no ray meets.
    pub const ABSENT: Self = Self(u32::MAX);

    /// The bit that tells a leaf.
    const LEAF: u32 = 1 << 31;

    /// The node of this number.
    pub const fn node(number: u32) -> Self {
        Self(number)
    }

    /// The items at `first .. first + count`; `count` is 1 to 8.
    pub const fn leaf(first: u32, count: u32) -> Self {
        Self(Self::LEAF | (count - 1) << 28 | first)
    }

    /// Whether it is a leaf (or absent).
    #[inline(always)]
    pub const fn is_leaf(self) -> bool {
        self.0 & Self::LEAF != 0
    }

    /// A leaf's first position and count.
    #[inline(always)]
    pub const fn items(self) -> (u32, u32) {
        (self.0 & ((1 << 28) - 1), (self.0 >> 28 & 7) + 1)
    }

    /// The same child where as many nodes stand in front.
    pub fn moved(self, nodes: u32) -> Self {
        if self.0 & (Self::LEAF | Self::LINK) != 0 { self } else { Self(self.0 + nodes) }
    }

    /// The bit that tells a link, where it is no leaf. Nodes never need this many bits: each has items of its own.
    const LINK: u32 = 1 << 30;

    /// Another tree, by its number, while a forest is built: [`Child::resolved`] puts its top in the place.
    pub const fn link(tree: u32) -> Self {
        Self(Self::LINK | tree)
    }

    /// The child itself, or the top of the tree to which it links.
    pub fn resolved(self, tops: &[Self]) -> Self {
        if self.0 & Self::LEAF == 0 && self.0 & Self::LINK != 0 {
            tops[(self.0 & !Self::LINK) as usize]
        } else {
            self
        }
    }
}

/// Eight boxes, side by side, and what stands below them: 224 bytes, which never touch more than four cache lines.
#[derive(Clone, Debug)]
#[repr(C, align(32))]
pub struct WideNode {
    /// `planes[axis][side][lane]`: side 0 holds the low planes, 1 the high ones.
    pub planes: [[[f32; WIDTH]; 2]; 3],
    /// What stands below each box; absent ones come last.
    pub children: [Child; WIDTH],
}

impl WideNode {
    /// A node without children: the low planes lie at +inf, the high ones at -inf.
    pub const EMPTY: Self = Self {
        planes: [[[f32::INFINITY; WIDTH], [f32::NEG_INFINITY; WIDTH]]; 3],
        children: [Child::ABSENT; WIDTH],
    };

    /// Asks for all of it.
    #[inline(always)]
    pub fn expect(&self) {
        ahead::fetch(&self.planes, 0, self.planes.len());
    }

    /// Puts a child into a lane.
    pub fn set(&mut self, lane: usize, bounds: &NarrowBox, child: Child) {
        for axis in 0..3 {
            self.planes[axis][0][lane] = bounds.low[axis];
            self.planes[axis][1][lane] = bounds.high[axis];
        }
        self.children[lane] = child;
    }

    /// A lane's box.
    pub fn bounds(&self, lane: usize) -> NarrowBox {
        NarrowBox {
            low: self.planes.map(|[low, _]| low[lane]),
            high: self.planes.map(|[_, high]| high[lane]),
        }
    }

    /// The lanes that hold a child.
    pub fn present(&self) -> impl Iterator<Item = usize> + '_ {
        (0..WIDTH).filter(|&lane| self.children[lane] != Child::ABSENT)
    }
}

/// A whole tree.
#[derive(Debug)]
pub struct Tree {
    /// Where its single-precision boxes are.
    pub frame: Frame,
    /// The nodes; a parent stands before its children within one build.
    pub nodes: Vec<WideNode>,
    /// The top: a node, a leaf, or absent.
    pub root: Child,
    /// As many children may wait at once while a ray walks.
    pub stack: usize,
}

impl Tree {
    /// A tree of these nodes; finds out how deep its walk's stack must be.
    pub fn new(frame: Frame, mut nodes: Vec<WideNode>, root: Child) -> Self {
        nodes.shrink_to_fit();
        let mut tree = Self { frame, nodes, root, stack: 0 };
        tree.stack = tree.deepest_stack();
        tree
    }

    /// The most children that wait: on every node of the way to a leaf, all but the one that is walked.
    fn deepest_stack(&self) -> usize {
        let mut deepest = 0;
        let mut open = vec![(self.root, 0)];
        while let Some((child, waiting)) = open.pop() {
            deepest = deepest.max(waiting);
            if !child.is_leaf() {
                let node = &self.nodes[child.0 as usize];
                let present = node.present().count();
                let waiting = waiting + present.saturating_sub(1);
                open.extend(node.present().map(|lane| (node.children[lane], waiting)));
            }
        }
        deepest
    }

    /// Every leaf's first position and count.
    pub fn each_leaf(&self, leaf: &mut dyn FnMut(u32, u32)) {
        for child in [self.root].into_iter().chain(self.nodes.iter().flat_map(|node| node.children)) {
            if child.is_leaf() && child != Child::ABSENT {
                let (first, count) = child.items();
                leaf(first, count);
            }
        }
    }

    /// The bytes it holds.
    pub fn memory(&self) -> usize {
        self.nodes.capacity() * size_of::<WideNode>()
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::input::MAX_ITEMS;

    #[test]
    fn a_child_tells_what_it_was_made_of() {
        for (first, count) in [(0, 1), (5, 8), (MAX_ITEMS - 1, 1), (MAX_ITEMS - 8, 8)] {
            let leaf = Child::leaf(first, count);
            assert!(leaf.is_leaf() && leaf != Child::ABSENT);
            assert_eq!(leaf.items(), (first, count));
        }
        assert!(!Child::node(77).is_leaf());
        assert_eq!(size_of::<WideNode>(), 224);
    }
}

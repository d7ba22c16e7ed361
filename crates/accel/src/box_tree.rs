//! Bounding boxes along the scene's own groups: whoever misses a group's box misses all in it.
//!
//! **Departure from the slides.** There a group's children are tested one after the other, which is no gain
//! where a scene is one
//! flat group. Here the children of a group (its items and the groups in it) are clustered into a small tree of
//! their own, with the same eight-wide nodes as the BVH's; boxes never mix children of two groups. So the structure
//! is the scene's, and the walk is the BVH's, near children first.
//!
//! A group without children has no box; a group of one child is that child. Groups may be nested as deep
//! as memory allows:
//! nothing here recurses on them, and the walk's stack is as deep as the tree asks for.

use crate::bvh::Builder;
use crate::bvh::Child;
use crate::bvh::Tree;
use crate::bvh::build::LINK;
use crate::bvh::partition::Extent;
use crate::bvh::partition::Reference;
use crate::bvh::partition::Span;
use crate::bvh::wide::WideNode;
use crate::input::Boxes;
use crate::input::GroupEvent;
use crate::input::MAX_ITEMS;
use crate::input::Quality;
use crate::narrow::Frame;
use crate::simd::level;

/// The forest while it grows: one small tree a group.
struct Forest<'a, B> {
    boxes: &'a B,
    frame: Frame,
    nodes: Vec<WideNode>,
    order: Vec<u32>,
    /// The children of the open groups, one after the other.
    references: Vec<Reference>,
    /// The finished groups' tops.
    tops: Vec<Child>,
    seen: Vec<bool>,
}

/// Builds along the groups and gives the order of the leaves.
///
/// Any list of events will do: what is left open ends with the list, what is closed without having been opened is
/// passed over, and items that no event names, or that stand twice, stand once, in the root if nowhere else.
pub fn build(boxes: &impl Boxes, groups: &[GroupEvent], frame: Frame) -> (Tree, Vec<u32>) {
    let count = boxes.len() as usize;
    let mut forest = Forest {
        boxes,
        frame,
        nodes: Vec::new(),
        order: Vec::with_capacity(count),
        references: Vec::new(),
        tops: Vec::new(),
        seen: vec![false; count],
    };
    let mut open = Vec::new();
    for event in groups {
        match *event {
            GroupEvent::Open => open.push(forest.references.len()),
            GroupEvent::Close => {
                if let Some(start) = open.pop() {
                    forest.close(start);
                }
            }
            GroupEvent::Items { first, count } => forest.add(first, count),
        }
    }
    forest.add(0, boxes.len());
    while let Some(start) = open.pop() {
        forest.close(start);
    }
    let root = forest.top(0).map_or(Child::ABSENT, |(child, _)| child);
    let Forest { mut nodes, order, tops, .. } = forest;
    for node in &mut nodes {
        node.children = node.children.map(|child| child.resolved(&tops));
    }
    (Tree::new(frame, nodes, root.resolved(&tops)), order)
}

impl<B: Boxes> Forest<'_, B> {
    /// Adds those of the items to the innermost open group that stand nowhere yet.
    fn add(&mut self, first: u32, count: u32) {
        let end = first.saturating_add(count).min(self.boxes.len());
        for item in first..end {
            if !std::mem::replace(&mut self.seen[item as usize], true) {
                let bounds = self.frame.narrow(&self.boxes.bounds(item));
                self.references.push(Reference::new(bounds, item));
            }
        }
    }

    /// Ends the group whose children begin at `start`: in the group around it, one reference stands for all of them.
    fn close(&mut self, start: usize) {
        // One child, or none, needs no group; nor can there be more groups and items than a leaf can count.
        if self.references.len() - start < 2 || self.tops.len() + self.seen.len() >= MAX_ITEMS as usize {
            return;
        }
        if let Some((child, bounds)) = self.top(start) {
            let link = self.tops.len() as u32 | LINK;
            self.tops.push(child);
            self.references.push(Reference::new(bounds.narrow(), link));
        }
    }

    /// Builds the tree of the children from `start` on and takes them off the list.
    fn top(&mut self, start: usize) -> Option<(Child, Extent)> {
        let children = self.references.get_mut(start..).filter(|children| !children.is_empty())?;
        let bounds = Span::of(level(), children).bounds;
        let (first, old_nodes) = (self.order.len() as u32, self.nodes.len());
        let child =
            Builder { quality: Quality::Fast, level: level() }.build(children, first, &mut self.nodes);
        // The builder has counted links as it counts items, but only items take positions.
        let mut places = Vec::with_capacity(children.len());
        for number in children.iter().map(Reference::number) {
            places.push(self.order.len() as u32);
            if number & LINK == 0 {
                self.order.push(number);
            }
        }
        for child in self.nodes[old_nodes..].iter_mut().flat_map(|node| &mut node.children) {
            if child.is_leaf() && *child != Child::ABSENT {
                let (position, count) = child.items();
                *child = Child::leaf(places[(position - first) as usize], count);
            }
        }
        self.references.truncate(start);
        Some((child, bounds))
    }
}

//! Whether a tree is well formed, and its figures.

use crate::bvh::wide::Child;
use crate::bvh::wide::Tree;
use crate::input::Boxes;
use crate::input::Kind;
use crate::narrow::NarrowBox;
use crate::stats::Below;
use crate::stats::Cell;
use crate::stats::Defect;
use crate::stats::Stats;
use crate::stats::level_by_level;

/// Whether one box holds another.
fn holds(outer: &NarrowBox, inner: &NarrowBox) -> bool {
    (0..3).all(|axis| outer.low[axis] <= inner.low[axis] && inner.high[axis] <= outer.high[axis])
}

/// Half the surface of a box.
fn half_area(bounds: &NarrowBox) -> f64 {
    let [x, y, z] = [0, 1, 2].map(|axis| f64::from(bounds.high[axis]) - f64::from(bounds.low[axis]));
    x * y + y * z + z * x
}

impl Tree {
    /// Calls for every child (but the root) with its box, and how many nodes stand above it.
    fn visit(
        &self,
        mut each: impl FnMut(&NarrowBox, Child, u32) -> Result<(), Defect>,
    ) -> Result<(), Defect> {
        let mut open = vec![(self.root, 1)];
        let mut visited = 0;
        while let Some((child, depth)) = open.pop() {
            if child.is_leaf() {
                continue;
            }
            visited += 1;
            let node = self
                .nodes
                .get(child.0 as usize)
                .filter(|_| visited <= self.nodes.len())
                .ok_or_else(|| Defect(format!("{child:?} names no node, or there is a circle")))?;
            for lane in node.present() {
                each(&node.bounds(lane), node.children[lane], depth)?;
                open.push((node.children[lane], depth + 1));
            }
        }
        Ok(())
    }

    /// The first boxes, level by level.
    pub fn cells(&self, most: usize) -> Vec<Cell> {
        level_by_level((self.root, *self.frame.scene()), most, |child, _| {
            let node = self.nodes.get(child.0 as usize).filter(|_| !child.is_leaf())?;
            let below = |lane: usize| (node.children[lane], self.frame.widen(&node.bounds(lane)));
            Some(node.present().map(below).collect::<Below<Child>>())
        })
    }

    /// Its figures.
    pub fn stats(&self, kind: Kind, items: u32) -> Stats {
        let mut stats = Stats::empty(kind);
        let scene = half_area(&self.frame.narrow(self.frame.scene())).max(f64::MIN_POSITIVE);
        if self.root.is_leaf() {
            if items > 0 {
                stats.leaf(items as usize, 1.0, 0);
            }
        } else {
            stats.node(1.0);
        }
        let visited = self.visit(|bounds, child, depth| {
            let share = half_area(bounds) / scene;
            if child.is_leaf() {
                stats.leaf(child.items().1 as usize, share, depth);
            } else {
                stats.node(share);
            }
            Ok(())
        });
        debug_assert!(visited.is_ok());
        Stats { items, bytes: self.memory(), ..stats }
    }

    /// Checks that each item stands in exactly one leaf, inside all boxes above it.
    pub fn validate(&self, boxes: &impl Boxes, order: &[u32]) -> Result<(), Defect> {
        let mut seen = vec![false; boxes.len() as usize];
        if order.len() != seen.len() {
            return Err(Defect(format!("{} positions for {} items", order.len(), seen.len())));
        }
        let mut check_leaf = |child: Child, bounds: Option<&NarrowBox>| {
            let (first, count) = child.items();
            for position in first..first + count {
                let item = order.get(position as usize).copied();
                let unseen = item.and_then(|item| seen.get_mut(item as usize)).filter(|seen| !**seen);
                let (Some(item), Some(unseen)) = (item, unseen) else {
                    return Err(Defect(format!(
                        "position {position} is none, or holds an item for the second time"
                    )));
                };
                *unseen = true;
                if bounds.is_some_and(|bounds| !holds(bounds, &self.frame.narrow(&boxes.bounds(item)))) {
                    return Err(Defect(format!("item {item} sticks out of its leaf's box")));
                }
            }
            Ok(())
        };
        if self.root.is_leaf() && self.root != Child::ABSENT {
            check_leaf(self.root, None)?;
        }
        self.visit(|bounds, child, _| {
            if child.is_leaf() {
                return check_leaf(child, Some(bounds));
            }
            let node = self.nodes.get(child.0 as usize);
            let inside =
                node.is_some_and(|node| node.present().all(|lane| holds(bounds, &node.bounds(lane))));
            if inside { Ok(()) } else { Err(Defect(format!("a box sticks out of the one above {child:?}"))) }
        })?;
        match seen.iter().position(|&seen| !seen) {
            Some(item) => Err(Defect(format!("item {item} is in no leaf"))),
            None => Ok(()),
        }
    }
}

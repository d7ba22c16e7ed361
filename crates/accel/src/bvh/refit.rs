//! Boxes made to fit items that have moved, the tree's shape kept: for animation, where building costs more than a
//! tree that is a little worse.

use crate::bvh::wide::Tree;
use crate::input::Boxes;
use crate::narrow::Frame;
use crate::narrow::NarrowBox;
use dotray_geometry::Aabb;

impl Tree {
    /// Fits every box to the items as they are now; `order` is the order that the build gave, `scene` the box around
    /// all items.
    pub fn refit(&mut self, boxes: &impl Boxes, order: &[u32], scene: Aabb) {
        self.frame = Frame::around(scene);
        // Parents first; gone through backwards, children are fitted before their parents. No recursion: trees along
        // a scene's groups may be as deep as those.
        let mut parents_first = Vec::with_capacity(self.nodes.len());
        let mut open = vec![self.root];
        while let Some(child) = open.pop() {
            if !child.is_leaf() {
                parents_first.push(child.0 as usize);
                let node = &self.nodes[child.0 as usize];
                open.extend(node.present().map(|lane| node.children[lane]));
            }
        }
        for &number in parents_first.iter().rev() {
            for lane in 0..self.nodes[number].children.len() {
                let child = self.nodes[number].children[lane];
                let bounds = if child.is_leaf() {
                    if !self.nodes[number].present().any(|present| present == lane) {
                        continue;
                    }
                    let (first, count) = child.items();
                    let items = &order[first as usize..][..count as usize];
                    let all = items.iter().fold(Aabb::EMPTY, |all, &item| all.union(boxes.bounds(item)));
                    self.frame.narrow(&all)
                } else {
                    let below = &self.nodes[child.0 as usize];
                    below.present().map(|lane| below.bounds(lane)).fold(NOTHING, around)
                };
                self.nodes[number].set(lane, &bounds, child);
            }
        }
    }
}

/// The box of no item.
const NOTHING: NarrowBox = NarrowBox { low: [f32::INFINITY; 3], high: [f32::NEG_INFINITY; 3] };

fn around(a: NarrowBox, b: NarrowBox) -> NarrowBox {
    let mut all = a;
    for axis in 0..3 {
        all.low[axis] = a.low[axis].min(b.low[axis]);
        all.high[axis] = a.high[axis].max(b.high[axis]);
    }
    all
}

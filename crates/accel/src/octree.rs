//! An octree: a cube cut into eight equal cubes, these again, until few items touch a cell.
//!
//! The walk visits the cells front to back by the order of Revelles, Ureña and Lastra, "An efficient parametric
//! algorithm for octree traversal" (2000): octants numbered by the side of the three middle planes on which they lie,
//! counted from the side where the ray comes from. We depart from it in testing each octant's padded slab instead of
//! finding the next one from the last exit: so rays that run exactly in a middle plane, and rounding, lose no cell.

use crate::batch::Batch;
use crate::cells::Cut;
use crate::cells::Leaf;
use crate::cells::MAX_DEPTH;
use crate::cells::MAX_GROWTH;
use crate::cells::Mailbox;
use crate::cells::Pending;
use crate::cells::SMALL_LEAF;
use crate::cells::check_leaves;
use crate::cells::grow;
use crate::cells::touches;
use crate::clip::ClippedRay;
use crate::input::Boxes;
use crate::input::Kind;
use crate::query::Queries;
use crate::query::Query;
use crate::stats::Below;
use crate::stats::Cell;
use crate::stats::Defect;
use crate::stats::Stats;
use crate::stats::level_by_level;
use dotray_geometry::Aabb;
use dotray_geometry::Vec3;

/// An octree over items.
#[derive(Debug)]
pub struct Octree {
    scene: Aabb,
    cube: Aabb,
    nodes: Vec<Node>,
    references: Vec<u32>,
    items: u32,
}

/// A cell: cut into eight, or a leaf.
#[derive(Clone, Copy, Debug)]
enum Node {
    /// Its parts are the nodes `first .. first + 8`; bit 1 of an octant's number is the upper half of x, 2 of
    /// y, 4 of z.
    Cut { first: u32 },
    /// It lists items.
    Leaf(Leaf),
}

/// A cell that the ray has yet to enter.
#[derive(Clone, Copy)]
struct Entry {
    cell: [[f64; 2]; 3],
    enter: f64,
    node: u32,
}

impl Octree {
    /// Builds over `boxes`, whose union is `scene`.
    pub fn build(boxes: &impl Boxes, scene: Aabb) -> Self {
        // The cube is a quarter larger than the scene and off its centre: scenes are often symmetric, and what stands
        // across a middle plane stands in several cells from the first cut on.
        let size = scene.size().max_element();
        let center = scene.center() + Vec3::splat(0.075 * size);
        let half = Vec3::splat(0.625 * size);
        // The union keeps what rounding might take from the cube.
        let cube = Aabb::new(center - half, center + half).union(scene);
        let cut = |pending: &Pending| cut(boxes, pending);
        let (nodes, references) = grow(boxes.len(), cube, cut, |(), first| Node::Cut { first }, Node::Leaf);
        Self { scene, cube, nodes, references, items: boxes.len() }
    }

    /// The bytes it holds.
    pub fn memory(&self) -> usize {
        self.nodes.capacity() * size_of::<Node>() + self.references.capacity() * 4
    }

    /// Walks every ray of the batch.
    pub fn walk(&self, queries: &Queries<'_>, batch: &mut dyn Batch) {
        let mut mailbox = Mailbox::new();
        let mut stack = [Entry { cell: [[0.0; 2]; 3], enter: 0.0, node: 0 }; 7 * MAX_DEPTH as usize + 8];
        for i in 0..queries.len() {
            mailbox.next_ray();
            let tests = self.walk_ray(&queries.query(i), batch, i, &mut mailbox, &mut stack);
            batch.finished(i, tests);
        }
    }

    /// Walks one ray and returns how many cells it tested.
    #[inline(always)]
    fn walk_ray(
        &self,
        query: &Query,
        batch: &mut dyn Batch,
        i: usize,
        mailbox: &mut Mailbox,
        stack: &mut [Entry],
    ) -> u64 {
        let Some(ray) = ClippedRay::new(query, &self.scene) else { return 1 };
        let mut bound = query.t_max;
        let mut tests = 1;
        let mut top = 1;
        stack[0] = Entry { cell: sides(&self.cube), enter: ray.start, node: 0 };
        while top > 0 {
            top -= 1;
            let Entry { cell, enter, node } = stack[top];
            if enter > ray.limit(bound) {
                continue;
            }
            match self.nodes[node as usize] {
                Node::Cut { first } => {
                    top = enter_octants(&ray, &cell, first, stack, top);
                    tests += 8;
                }
                Node::Leaf(leaf) => {
                    let items = &self.references[leaf.first as usize..][..leaf.count as usize];
                    bound = mailbox.show(batch, i, items, bound);
                    if bound == f64::NEG_INFINITY {
                        break;
                    }
                }
            }
        }
        tests
    }

    /// Every leaf with its cell, depth and the surface share of the cell; `visit_node` sees the inner nodes' shares.
    fn leaves(&self, mut visit_node: impl FnMut(f64)) -> Vec<(Aabb, Leaf, u32)> {
        let mut leaves = Vec::new();
        let mut open = vec![(0_u32, self.cube, 0_u32)];
        while let Some((node, cell, depth)) = open.pop() {
            match self.nodes[node as usize] {
                Node::Cut { first } => {
                    visit_node(self.share(&cell));
                    open.extend((0..8).map(|octant| (first + octant, part(&cell, octant), depth + 1)));
                }
                Node::Leaf(leaf) => leaves.push((cell, leaf, depth)),
            }
        }
        leaves
    }

    /// The first cells, level by level; empty leaves are left out.
    pub fn cells(&self, most: usize) -> Vec<Cell> {
        let is_empty = |node: &u32| matches!(self.nodes[*node as usize], Node::Leaf(leaf) if leaf.count == 0);
        level_by_level((0, self.cube), most, |&node, cell| match self.nodes[node as usize] {
            Node::Cut { first } => {
                let parts = (0..8).map(|octant| (first + octant, part(cell, octant)));
                Some(parts.filter(|(node, _)| !is_empty(node)).collect::<Below<u32>>())
            }
            Node::Leaf(_) => None,
        })
    }

    /// The share of the cube's surface.
    fn share(&self, cell: &Aabb) -> f64 {
        cell.half_area() / self.cube.half_area().max(f64::MIN_POSITIVE)
    }

    /// Its figures.
    pub fn stats(&self) -> Stats {
        let mut stats = Stats::empty(Kind::Octree);
        for (cell, leaf, depth) in self.leaves(|area| stats.node(area)) {
            if leaf.count > 0 {
                stats.leaf(leaf.count as usize, self.share(&cell), depth);
            }
        }
        Stats { items: self.items, bytes: self.memory(), ..stats }
    }

    /// Checks the structure against what it was built over.
    pub fn validate(&self, boxes: &impl Boxes) -> Result<(), Defect> {
        let leaves = self.leaves(|_| ()).into_iter().map(|(cell, leaf, _)| (cell, leaf));
        check_leaves(boxes, leaves, &self.references)
    }
}

/// Cuts a cell, unless that would not part its items.
fn cut(boxes: &impl Boxes, pending: &Pending) -> Option<Cut<(), 8>> {
    if pending.items.len() <= SMALL_LEAF {
        return None;
    }
    let mut parts: [_; 8] = std::array::from_fn(|octant| (part(&pending.cell, octant as u32), Vec::new()));
    for &item in &pending.items {
        let bounds = boxes.bounds(item);
        for (cell, items) in &mut parts {
            if touches(&bounds, cell) {
                items.push(item);
            }
        }
    }
    let mentions = parts.iter().map(|(_, items)| items.len()).sum::<usize>();
    (mentions as f64 <= MAX_GROWTH * pending.items.len() as f64).then_some(Cut { how: (), parts })
}

/// One of the eight parts of a cell.
fn part(cell: &Aabb, octant: u32) -> Aabb {
    let (low, high) = (cell.min.to_array(), cell.max.to_array());
    let mut part = *cell;
    for axis in 0..3 {
        let middle = middle(low[axis], high[axis]);
        if octant >> axis & 1 == 0 {
            part.max[axis] = middle;
        } else {
            part.min[axis] = middle;
        }
    }
    part
}

/// Where a cell is cut across one axis; builder and walk must agree to the bit.
#[inline(always)]
fn middle(low: f64, high: f64) -> f64 {
    0.5 * low + 0.5 * high
}

/// The planes of a box, per axis.
fn sides(bounds: &Aabb) -> [[f64; 2]; 3] {
    let (low, high) = (bounds.min.to_array(), bounds.max.to_array());
    std::array::from_fn(|axis| [low[axis], high[axis]])
}

/// Pushes the octants that the ray meets, the nearest on top, and returns the new top.
#[inline(always)]
fn enter_octants(
    ray: &ClippedRay,
    cell: &[[f64; 2]; 3],
    first: u32,
    stack: &mut [Entry],
    mut top: usize,
) -> usize {
    // The halves of each axis, and where the ray enters and leaves them.
    let mut halves = [[[0.0; 2]; 2]; 3];
    let mut times = [[(0.0, 0.0); 2]; 3];
    for axis in 0..3 {
        let [low, high] = cell[axis];
        let middle = middle(low, high);
        halves[axis] = [[low, middle], [middle, high]];
        times[axis] = [ray.slab(axis, low, middle), ray.slab(axis, middle, high)];
    }
    // Counted from where the ray comes from, an octant's number is above those of all that can hide it; the last
    // is pushed first.
    let negative = ray.negative();
    for counted in (0..8).rev() {
        let octant = counted ^ negative;
        let half = [octant & 1, octant >> 1 & 1, octant >> 2];
        let enter = (0..3).fold(ray.start, |enter, axis| enter.max(times[axis][half[axis]].0));
        let leave = (0..3).fold(ray.end, |leave, axis| leave.min(times[axis][half[axis]].1));
        if enter <= leave {
            let cell = std::array::from_fn(|axis| halves[axis][half[axis]]);
            stack[top] = Entry { cell, enter, node: first + octant as u32 };
            top += 1;
        }
    }
    top
}

//! A binary space partition whose planes stand across the axes (a kd-tree), placed by the surface-area heuristic.
//!
//! The planes are chosen among evenly spaced ones, with a bonus for cutting off empty space, after Wald and Havran,
//! "On building fast kd-trees for ray tracing" (2006); we depart from it in counting items in bins instead of
//! sweeping over
//! sorted events, and in not clipping items to cells: boxes are all this crate knows.

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

/// A cell's planes are chosen among this many less one an axis.
const BINS: usize = 32;

/// What testing an item costs, where passing a plane costs 1.
const ITEM_COST: f64 = 2.0;

/// What a cut costs that leaves one side empty, as a share.
const EMPTY_BONUS: f64 = 0.8;

/// A binary space partition over items.
#[derive(Debug)]
pub struct Bsp {
    scene: Aabb,
    nodes: Vec<Node>,
    references: Vec<u32>,
    items: u32,
}

/// A cell: cut in two, or a leaf.
#[derive(Clone, Copy, Debug)]
enum Node {
    /// The part below the plane is the node `first`, the part above it the next.
    Cut { plane: Plane, first: u32 },
    /// It lists items.
    Leaf(Leaf),
}

/// A plane across an axis.
#[derive(Clone, Copy, Debug)]
struct Plane {
    axis: u8,
    at: f64,
}

/// A cell that the ray has yet to enter.
#[derive(Clone, Copy)]
struct Entry {
    enter: f64,
    leave: f64,
    node: u32,
}

impl Bsp {
    /// Builds over `boxes`, whose union is `scene`.
    pub fn build(boxes: &impl Boxes, scene: Aabb) -> Self {
        let cut = |pending: &Pending| cut(boxes, pending);
        let inner = |plane, first| Node::Cut { plane, first };
        let (nodes, references) = grow(boxes.len(), scene, cut, inner, Node::Leaf);
        Self { scene, nodes, references, items: boxes.len() }
    }

    /// The bytes it holds.
    pub fn memory(&self) -> usize {
        self.nodes.capacity() * size_of::<Node>() + self.references.capacity() * 4
    }

    /// Walks every ray of the batch.
    pub fn walk(&self, queries: &Queries<'_>, batch: &mut dyn Batch) {
        let mut mailbox = Mailbox::new();
        let mut stack = [Entry { enter: 0.0, leave: 0.0, node: 0 }; MAX_DEPTH as usize + 2];
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
        stack[0] = Entry { enter: ray.start, leave: ray.end, node: 0 };
        while top > 0 {
            top -= 1;
            let Entry { enter, mut leave, mut node } = stack[top];
            if enter > ray.limit(bound) {
                continue;
            }
            loop {
                match self.nodes[node as usize] {
                    Node::Cut { plane, first } => {
                        tests += 2;
                        // The padded plane is a slab: the near part ends behind it, the far one begins before it.
                        let axis = usize::from(plane.axis);
                        let (before, behind) = ray.slab(axis, plane.at, plane.at);
                        let near = u32::from(ray.inverse[axis] < 0.0);
                        if before > leave {
                            node = first + near;
                        } else if behind < enter {
                            node = first + 1 - near;
                        } else {
                            let far = Entry { enter: enter.max(before), leave, node: first + 1 - near };
                            stack[top] = far;
                            top += 1;
                            node = first + near;
                            leave = leave.min(behind);
                        }
                    }
                    Node::Leaf(leaf) => {
                        let items = &self.references[leaf.first as usize..][..leaf.count as usize];
                        bound = mailbox.show(batch, i, items, bound);
                        break;
                    }
                }
            }
            if bound == f64::NEG_INFINITY {
                break;
            }
        }
        tests
    }

    /// Every leaf with its cell and depth; `visit_node` sees the inner nodes' surface shares.
    fn leaves(&self, mut visit_node: impl FnMut(f64)) -> Vec<(Aabb, Leaf, u32)> {
        let mut leaves = Vec::new();
        let mut open = vec![(0_u32, self.scene, 0_u32)];
        while let Some((node, cell, depth)) = open.pop() {
            match self.nodes[node as usize] {
                Node::Cut { plane, first } => {
                    visit_node(self.share(&cell));
                    let [below, above] = parts(&cell, plane);
                    open.extend([(first, below, depth + 1), (first + 1, above, depth + 1)]);
                }
                Node::Leaf(leaf) => leaves.push((cell, leaf, depth)),
            }
        }
        leaves
    }

    /// The first cells, level by level; empty leaves are left out.
    pub fn cells(&self, most: usize) -> Vec<Cell> {
        let is_empty = |node: &u32| matches!(self.nodes[*node as usize], Node::Leaf(leaf) if leaf.count == 0);
        level_by_level((0, self.scene), most, |&node, cell| match self.nodes[node as usize] {
            Node::Cut { plane, first } => {
                let parts = (first..).zip(parts(cell, plane));
                Some(parts.filter(|(node, _)| !is_empty(node)).collect::<Below<u32>>())
            }
            Node::Leaf(_) => None,
        })
    }

    /// The share of the scene's surface.
    fn share(&self, cell: &Aabb) -> f64 {
        cell.half_area() / self.scene.half_area().max(f64::MIN_POSITIVE)
    }

    /// Its figures.
    pub fn stats(&self) -> Stats {
        let mut stats = Stats::empty(Kind::Bsp);
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

/// The two parts of a cell.
fn parts(cell: &Aabb, plane: Plane) -> [Aabb; 2] {
    let axis = usize::from(plane.axis);
    let (mut below, mut above) = (*cell, *cell);
    below.max[axis] = plane.at;
    above.min[axis] = plane.at;
    [below, above]
}

/// Cuts a cell where the surface-area heuristic finds it worth the while.
fn cut(boxes: &impl Boxes, pending: &Pending) -> Option<Cut<Plane, 2>> {
    if pending.items.len() <= SMALL_LEAF {
        return None;
    }
    let plane = best_plane(boxes, pending)?;
    let mut parts = parts(&pending.cell, plane).map(|cell| (cell, Vec::new()));
    for &item in &pending.items {
        let bounds = boxes.bounds(item);
        for (cell, items) in &mut parts {
            if touches(&bounds, cell) {
                items.push(item);
            }
        }
    }
    let mentions = parts.iter().map(|(_, items)| items.len()).sum::<usize>();
    (mentions as f64 <= MAX_GROWTH * pending.items.len() as f64).then_some(Cut { how: plane, parts })
}

/// The plane of least expected cost, or none where a leaf costs no more.
fn best_plane(boxes: &impl Boxes, pending: &Pending) -> Option<Plane> {
    let cell = &pending.cell;
    let size = cell.size().to_array();
    let low = cell.min.to_array();
    // Where items begin and where they end, counted in the bins of each axis.
    let mut begins = [[0_u32; BINS]; 3];
    let mut ends = [[0_u32; BINS]; 3];
    let scale = size.map(|size| if size > 0.0 { BINS as f64 / size } else { 0.0 });
    for &item in &pending.items {
        let bounds = boxes.bounds(item);
        for axis in 0..3 {
            let bin = |x: f64| (((x - low[axis]) * scale[axis]) as usize).min(BINS - 1);
            begins[axis][bin(bounds.min[axis])] += 1;
            ends[axis][bin(bounds.max[axis])] += 1;
        }
    }
    let count = pending.items.len() as f64;
    // A cell without thickness still has a surface to compare, so that rows of points are cut as well.
    let thickness = 1e-6 * size[0].max(size[1]).max(size[2]);
    let edge = size.map(|size| size + thickness);
    let area = edge[0] * edge[1] + edge[1] * edge[2] + edge[2] * edge[0];
    let mut best = (count * ITEM_COST * area, None);
    for axis in 0..3 {
        let across = edge[(axis + 1) % 3] * edge[(axis + 2) % 3];
        let around = edge[(axis + 1) % 3] + edge[(axis + 2) % 3];
        let (mut below, mut above) = (0.0, count);
        for bin in 1..BINS {
            below += f64::from(begins[axis][bin - 1]);
            above -= f64::from(ends[axis][bin - 1]);
            let share = bin as f64 / BINS as f64;
            let at = low[axis] + size[axis] * share;
            let area_below = across + around * edge[axis] * share;
            let area_above = across + around * edge[axis] * (1.0 - share);
            let bonus = if below == 0.0 || above == 0.0 { EMPTY_BONUS } else { 1.0 };
            let cost = area + ITEM_COST * bonus * (below * area_below + above * area_above);
            if cost < best.0 && at > low[axis] && at < cell.max[axis] {
                best = (cost, Some(Plane { axis: axis as u8, at }));
            }
        }
    }
    best.1
}

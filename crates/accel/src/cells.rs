//! What octree and BSP tree share: a world cut into cells, refined level by level, and leaves that list items.
//!
//! An item stands in every cell that its box touches, so it may be shown more than once; a small memory of the items
//! that a ray has met leaves most repetitions out.

use crate::batch::Batch;
use crate::input::Boxes;
use crate::stats::Defect;
use dotray_geometry::Aabb;
use rayon::prelude::*;

/// No tree has more levels, so that a walk's stack has a fixed size.
pub const MAX_DEPTH: u32 = 40;

/// A tree stops growing when its leaves mention this many times as many items as there are.
const MAX_REFERENCES: usize = 4;

/// A cut may make at most this many mentions of one, so that a tree never holds more than ten an item.
pub const MAX_GROWTH: f64 = 2.5;

/// Cells with no more items are not cut.
pub const SMALL_LEAF: usize = 4;

/// How deep a tree over so many items may grow: with the logarithm, so that clumps that no cut can part do not make
/// long chains of nodes.
pub fn depth_limit(items: u32) -> u32 {
    (10 + items.max(1).ilog2()).min(MAX_DEPTH)
}

/// A leaf's items: `references[first .. first + count]`.
#[derive(Clone, Copy, Debug, Default)]
pub struct Leaf {
    /// The first mention.
    pub first: u32,
    /// How many.
    pub count: u32,
}

/// A cell that may yet be cut, and the items that touch it.
#[derive(Debug)]
pub struct Pending {
    /// The node that stands for it.
    pub node: u32,
    /// Where it is.
    pub cell: Aabb,
    /// What touches it.
    pub items: Vec<u32>,
}

/// A cell cut into `N`: how, and the parts.
pub struct Cut<C, const N: usize> {
    /// How it was cut.
    pub how: C,
    /// The parts in their order, and what touches them.
    pub parts: [(Aabb, Vec<u32>); N],
}

/// Grows a tree level by level, so that where the bound on memory ends the growth, it ends everywhere alike.
///
/// `cut` decides whether and how to cut a cell; `inner` makes a node of a cut and the number of its first
/// child, `leaf` makes one of a leaf. Both may run on many threads; the result does not depend on them.
pub fn grow<N, C, const WAYS: usize>(
    items: u32,
    cell: Aabb,
    cut: impl Fn(&Pending) -> Option<Cut<C, WAYS>> + Sync,
    inner: impl Fn(C, u32) -> N,
    leaf: impl Fn(Leaf) -> N,
) -> (Vec<N>, Vec<u32>)
where
    C: Send,
{
    let mut nodes = vec![leaf(Leaf::default())];
    let mut references = Vec::new();
    let mut pending = vec![Pending { node: 0, cell, items: (0..items).collect() }];
    let most = MAX_REFERENCES * items as usize;
    let deepest = depth_limit(items);
    let mut depth = 0;
    while !pending.is_empty() {
        let mentioned = references.len() + pending.iter().map(|pending| pending.items.len()).sum::<usize>();
        let may_cut = depth < deepest && mentioned < most;
        let cuts: Vec<_> =
            pending.par_iter().map(|pending| if may_cut { cut(pending) } else { None }).collect();
        let mut next = Vec::new();
        for (done, cut) in pending.into_iter().zip(cuts) {
            match cut {
                None => {
                    let first = references.len() as u32;
                    references.extend_from_slice(&done.items);
                    nodes[done.node as usize] = leaf(Leaf { first, count: done.items.len() as u32 });
                }
                Some(Cut { how, parts }) => {
                    let first = nodes.len() as u32;
                    nodes[done.node as usize] = inner(how, first);
                    for (node, (cell, items)) in (first..).zip(parts) {
                        nodes.push(leaf(Leaf::default()));
                        if !items.is_empty() {
                            next.push(Pending { node, cell, items });
                        }
                    }
                }
            }
        }
        pending = next;
        depth += 1;
    }
    (nodes, references)
}

/// Whether a box touches a closed cell.
pub fn touches(bounds: &Aabb, cell: &Aabb) -> bool {
    bounds.min.cmple(cell.max).all() && cell.min.cmple(bounds.max).all()
}

/// The items one ray met of late, so that they need not be tested again.
#[derive(Debug)]
pub struct Mailbox {
    ray: u64,
    met: [u64; Self::SLOTS],
}

impl Mailbox {
    const SLOTS: usize = 64;

    /// An empty one.
    pub fn new() -> Self {
        Self { ray: 0, met: [0; Self::SLOTS] }
    }

    /// Begins another ray.
    #[inline(always)]
    pub fn next_ray(&mut self) {
        self.ray += 1;
    }

    /// Shows the items of a leaf to ray `i`, without those it is known to have met, and returns the new bound.
    #[inline(always)]
    pub fn show(&mut self, batch: &mut dyn Batch, i: usize, items: &[u32], mut bound: f64) -> f64 {
        for block in items.chunks(Self::SLOTS) {
            let mut unmet = [0; Self::SLOTS];
            let mut count = 0;
            for &item in block {
                // The number of the ray makes older entries worthless without clearing them.
                let letter = (self.ray << 32) | u64::from(item);
                let slot = &mut self.met[item as usize % Self::SLOTS];
                unmet[count % Self::SLOTS] = item;
                count += usize::from(*slot != letter);
                *slot = letter;
            }
            if count > 0 {
                bound = batch.leaf_list(i, &unmet[..count], bound);
                if bound == f64::NEG_INFINITY {
                    break;
                }
            }
        }
        bound
    }
}

/// Checks that each item stands in a leaf, and (in small scenes) in every leaf whose cell it touches.
///
/// # Errors
/// Names the first item of which this does not hold.
pub fn check_leaves(
    boxes: &impl Boxes,
    leaves: impl Iterator<Item = (Aabb, Leaf)>,
    references: &[u32],
) -> Result<(), Defect> {
    let mut seen = vec![false; boxes.len() as usize];
    for (cell, leaf) in leaves {
        let items = references
            .get(leaf.first as usize..)
            .and_then(|rest| rest.get(..leaf.count as usize))
            .ok_or_else(|| Defect(format!("a leaf mentions {leaf:?} of {} references", references.len())))?;
        for &item in items {
            let known =
                seen.get_mut(item as usize).ok_or_else(|| Defect(format!("there is no item {item}")))?;
            *known = true;
            if !touches(&boxes.bounds(item), &cell) {
                return Err(Defect(format!("item {item} stands in a cell that it does not touch")));
            }
        }
        // Few leaves are asked about all items, so that the check stays affordable.
        if boxes.len() <= 2000 {
            let missing = |&item: &u32| touches(&boxes.bounds(item), &cell) && !items.contains(&item);
            if let Some(item) = (0..boxes.len()).find(missing) {
                return Err(Defect(format!("item {item} is missing in a leaf")));
            }
        }
    }
    match seen.iter().position(|&known| !known) {
        Some(item) => Err(Defect(format!("item {item} is in no leaf"))),
        None => Ok(()),
    }
}

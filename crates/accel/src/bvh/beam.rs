//! The walk of rays that travel together: a node is read once for a whole packet.
//!
//! A node's eight boxes are first tested against the packet's beam, then the boxes that the beam meets against each
//! group of eight rays that is still active (after Wald, Benthin, Boulos, "Getting rid of packets", 2008, and
//! Overbeck et al., "Large ray packets for real-time Whitted ray tracing", 2008; we keep a mask of groups where they
//! keep ranges, and eight-wide nodes).

use crate::batch::Batch;
use crate::bvh::wide::Child;
use crate::bvh::wide::Tree;
use crate::bvh::wide::WIDTH;
use crate::packet::Beam;
use crate::packet::GROUPS;
use crate::packet::LANES;
use crate::packet::Packet;
use crate::query::Queries;
use crate::simd::Simd;
use dotray_geometry::Ray;

/// A child that waits for some groups.
#[derive(Clone, Copy, Debug)]
struct Waiting {
    enter: f32,
    child: Child,
    active: u32,
}

impl Waiting {
    /// What fills the stack above its top.
    const NOBODY: Self = Self { enter: 0.0, child: Child::ABSENT, active: 0 };
}

/// Walks every ray of the batch through the tree, in packets of rays with equal signs.
#[inline(always)]
pub fn walk<S: Simd, B: Batch>(simd: S, tree: &Tree, queries: &Queries<'_>, batch: &mut B) {
    let mut stack = vec![Waiting::NOBODY; tree.stack + WIDTH + 1];
    let mut packet = Packet::new(&tree.frame);
    let (order, ends) = by_octant(queries);
    let mut start = 0;
    for end in ends {
        for rays in order[start..end].chunks(GROUPS * LANES) {
            for group in rays.chunks(LANES) {
                packet.push(simd, queries, group);
            }
            walk_packet(simd, tree, &mut stack, &mut packet, batch);
        }
        start = end;
    }
}

/// The rays' numbers by the signs of their directions, in ascending order for each, and where each octant ends.
fn by_octant(queries: &Queries<'_>) -> (Vec<u32>, [usize; 8]) {
    let octant = |ray: &Ray| {
        let negative = |axis: usize| usize::from(ray.direction[axis].is_sign_negative());
        (negative(0) | negative(1) << 1 | negative(2) << 2) & 7
    };
    let mut next = [0; 8];
    for ray in queries.rays {
        next[octant(ray)] += 1;
    }
    let mut start = 0;
    for count in &mut next {
        (*count, start) = (start, start + *count);
    }
    let mut order = vec![0; queries.len()];
    for (i, ray) in queries.rays.iter().enumerate() {
        let place = &mut next[octant(ray)];
        order[*place] = i as u32;
        *place += 1;
    }
    (order, next)
}

/// Walks one packet, tells the batch what it cost, and empties it.
#[inline(always)]
fn walk_packet<S: Simd, B: Batch>(
    simd: S,
    tree: &Tree,
    stack: &mut [Waiting],
    packet: &mut Packet,
    batch: &mut B,
) {
    let tests = descend(simd, tree, stack, packet, batch);
    let count = packet.count();
    for (index, ray) in packet.groups().iter().flat_map(|group| group.rays).take(count).enumerate() {
        // The tests are shared out evenly, so that they sum up to what was done.
        let share = tests / count as u64 + u64::from((index as u64) < tests % count as u64);
        batch.finished(ray as usize, share);
    }
    packet.clear();
}

/// The walk proper; returns the number of box tests.
#[inline(always)]
fn descend<S: Simd, B: Batch>(
    simd: S,
    tree: &Tree,
    stack: &mut [Waiting],
    packet: &mut Packet,
    batch: &mut B,
) -> u64 {
    let beam = Beam::around(packet);
    let (mut alive, mut bound) = packet.alive(simd);
    let mut tests = packet.count() as u64;
    stack[0] = Waiting { enter: 0.0, child: tree.root, active: alive };
    let mut top = 1;
    while top > 0 {
        top -= 1;
        let Waiting { enter, child, active } = stack[top];
        let active = active & alive;
        if active == 0 || enter > bound {
            continue;
        }
        if child.is_leaf() {
            let (first, count) = child.items();
            if batch.leaf_packet(simd, packet, active, [first, count]) {
                (alive, bound) = packet.alive(simd);
            }
            continue;
        }
        // The boxes that any group meets go onto the stack, the nearest on top.
        let node = &tree.nodes[child.0 as usize];
        let (mut mask, enter) = beam.meets(simd, &node.planes, bound);
        tests += 8;
        let bottom = top;
        while mask != 0 {
            let lane = mask.trailing_zeros() as usize & 7;
            mask &= mask - 1;
            let (mut near, mut far) = ([0.0; 3], [0.0; 3]);
            for axis in 0..3 {
                near[axis] = node.planes[axis][(beam.far_side[axis] ^ 1) & 1][lane];
                far[axis] = node.planes[axis][beam.far_side[axis] & 1][lane];
            }
            tests += 8 * u64::from(active.count_ones());
            let active = packet.meets(simd, active, near, far);
            if active != 0 {
                let waiting = Waiting { enter: enter[lane], child: node.children[lane], active };
                insert(stack, bottom, top, waiting);
                top += 1;
            }
        }
    }
    tests
}

/// Inserts into `stack[bottom..top]`, which descends.
#[inline(always)]
fn insert(stack: &mut [Waiting], bottom: usize, top: usize, new: Waiting) {
    let mut place = top;
    while place > bottom && stack[place - 1].enter < new.enter {
        stack[place] = stack[place - 1];
        place -= 1;
    }
    stack[place] = new;
}

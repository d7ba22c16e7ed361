//! The walk of rays that travel together: a node is read once for a whole packet.
//!
//! A node's eight boxes are first tested against the packet's beam, then the boxes that the beam meets against each
//! group of sixteen rays that is still active (after Wald, Benthin, Boulos, "Getting rid of packets", 2008, and
//! Overbeck et al., "Large ray packets for real-time Whitted ray tracing", 2008; we keep a mask of groups where they
//! keep ranges, and eight-wide nodes).

use crate::batch::Batch;
use crate::bvh::walk::Start;
use crate::bvh::walk::walk_ray;
use crate::bvh::wide::Child;
use crate::bvh::wide::Tree;
use crate::bvh::wide::WIDTH;
use crate::packet::Beam;
use crate::packet::GROUPS;
use crate::packet::LANES;
use crate::packet::Members;
use crate::packet::Packet;
use crate::query::Queries;
use crate::simd::Simd;
use dotray_geometry::Ray;

/// A child that waits for some rays.
#[derive(Clone, Copy, Debug)]
struct Waiting {
    enter: f32,
    child: Child,
    rays: Members,
}

impl Waiting {
    /// What fills the stack above its top.
    const NOBODY: Self = Self { enter: 0.0, child: Child::ABSENT, rays: Members::NONE };
}

/// As many rays a group, on the average, walk on alone: they meet eight boxes at once, while a group meets one.
const FEW: u32 = 3;

/// What the walks of packets, and of the rays that leave them, need besides the tree.
struct Stacks {
    together: Vec<Waiting>,
    alone: Vec<u64>,
}

/// Walks every ray of the batch through the tree, in packets of rays with equal signs.
#[inline(always)]
pub fn walk<S: Simd, B: Batch>(simd: S, tree: &Tree, queries: &Queries<'_>, batch: &mut B) {
    let mut stacks = Stacks {
        together: vec![Waiting::NOBODY; tree.stack + WIDTH + 1],
        alone: vec![0; tree.stack + WIDTH],
    };
    let mut packet = Packet::new(&tree.frame);
    let (order, ends) = by_octant(queries);
    let mut start = 0;
    for end in ends {
        for rays in order[start..end].chunks(GROUPS * LANES) {
            for group in rays.chunks(LANES) {
                packet.push(simd, queries, group);
            }
            walk_packet(simd, tree, &mut stacks, &mut packet, batch);
        }
        start = end;
    }
}

/// The rays' numbers by the signs of their directions, in ascending order for each, and where each octant ends.
fn by_octant(queries: &Queries<'_>) -> (Vec<u32>, [usize; 8]) {
    let octant = |ray: &Ray| {
        let negative = |axis: usize| u8::from(ray.direction[axis].is_sign_negative());
        (negative(0) | negative(1) << 1 | negative(2) << 2) & 7
    };
    let octants: Vec<u8> = queries.rays.iter().map(octant).collect();
    let mut next = [0; 8];
    for octant in &octants {
        next[usize::from(*octant)] += 1;
    }
    let mut start = 0;
    for count in &mut next {
        (*count, start) = (start, start + *count);
    }
    let mut order = vec![0; queries.len()];
    for (i, octant) in octants.iter().enumerate() {
        let place = &mut next[usize::from(*octant)];
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
    stacks: &mut Stacks,
    packet: &mut Packet,
    batch: &mut B,
) {
    let tests = descend(simd, tree, stacks, packet, batch);
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
    stacks: &mut Stacks,
    packet: &mut Packet,
    batch: &mut B,
) -> u64 {
    let beam = Beam::around(simd, packet);
    let (rays, mut bound) = packet.alive(simd);
    let mut tests = packet.count() as u64;
    let stack = &mut stacks.together[..];
    stack[0] = Waiting { enter: 0.0, child: tree.root, rays };
    let mut top = 1;
    while top > 0 {
        top -= 1;
        let Waiting { enter, child, rays } = stack[top];
        if enter > bound {
            continue;
        }
        let active = rays.groups;
        if rays.count <= FEW * active.count_ones() {
            let (changed, made) = alone(simd, tree, &mut stacks.alone, packet, (child, rays.lanes), batch);
            tests += made;
            if changed {
                bound = packet.alive(simd).1;
            }
            continue;
        }
        if child.is_leaf() {
            let (first, count) = child.items();
            if batch.leaf_packet(simd, packet, active, [first, count]) {
                bound = packet.alive(simd).1;
            }
            continue;
        }
        // The boxes that any group meets go onto the stack, the nearest on top.
        let node = &tree.nodes[child.0 as usize];
        let (mut mask, enter) = beam.meets(simd, &node.planes, bound);
        tests += WIDTH as u64;
        let bottom = top;
        while mask != 0 {
            let lane = mask.trailing_zeros() as usize & 7;
            mask &= mask - 1;
            let (mut near, mut far) = ([0.0; 3], [0.0; 3]);
            for axis in 0..3 {
                near[axis] = node.planes[axis][(beam.far_side[axis] ^ 1) & 1][lane];
                far[axis] = node.planes[axis][beam.far_side[axis] & 1][lane];
            }
            tests += LANES as u64 * u64::from(active.count_ones());
            let rays = packet.meets(simd, active, near, far);
            if rays.count > 0 {
                let waiting = Waiting { enter: enter[lane], child: node.children[lane], rays };
                insert(stack, bottom, top, waiting);
                top += 1;
            }
        }
    }
    tests
}

/// Walks the rays of a packet that few others go along with, one by one from a child down. Returns whether any bound
/// has changed, and the number of box tests.
#[inline(always)]
fn alone<S: Simd, B: Batch>(
    simd: S,
    tree: &Tree,
    stack: &mut [u64],
    packet: &mut Packet,
    (child, rays): (Child, [u16; GROUPS]),
    batch: &mut B,
) -> (bool, u64) {
    let (mut changed, mut tests) = (false, 0);
    for (number, mut lanes) in rays.into_iter().enumerate() {
        while lanes != 0 {
            let lane = lanes.trailing_zeros() as usize % LANES;
            lanes &= lanes - 1;
            let group = packet.group(number);
            let ray = group.ray(packet.frame(), lane);
            // It may have ended since.
            if ray.bound >= 0.0 {
                let t_max = group.t_max[lane];
                let start = Start { child, t_max, ray: group.rays[lane] as usize };
                let (answer, made) = walk_ray(simd, tree, stack, ray, start, batch);
                tests += made;
                if answer < t_max {
                    packet.set_t_max(number, lane, answer);
                    changed = true;
                }
            }
        }
    }
    (changed, tests)
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

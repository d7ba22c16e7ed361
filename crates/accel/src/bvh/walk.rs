//! The walk: one for nearest and for any hit, front to back, eight boxes at a time.

use crate::batch::Batch;
use crate::bvh::wide::Child;
use crate::bvh::wide::Tree;
use crate::bvh::wide::WIDTH;
use crate::bvh::wide::WideNode;
use crate::narrow::NarrowRay;
use crate::packet::Group;
use crate::packet::LANES;
use crate::query::Queries;
use crate::simd::Simd;
use crate::simd::f32x8;
use crate::simd::prelude::*;

/// A narrowed ray with its numbers spread over the lanes.
#[derive(Clone, Copy)]
pub struct SpreadRay<S: Simd> {
    inverse: [f32x8<S>; 3],
    inverse_far: [f32x8<S>; 3],
    near_offset: [f32x8<S>; 3],
    far_offset: [f32x8<S>; 3],
    far_side: [usize; 3],
}

impl<S: Simd> SpreadRay<S> {
    #[inline(always)]
    pub fn new(simd: S, ray: &NarrowRay) -> Self {
        let spread =
            |[x, y, z]: [f32; 3]| [f32x8::splat(simd, x), f32x8::splat(simd, y), f32x8::splat(simd, z)];
        Self {
            inverse: spread(ray.inverse),
            inverse_far: spread(ray.inverse_far),
            near_offset: spread(ray.near_offset),
            far_offset: spread(ray.far_offset),
            far_side: ray.far_side,
        }
    }

    /// Where the ray enters the slabs of eight boxes across an axis.
    #[inline(always)]
    fn near(&self, simd: S, node: &WideNode, axis: usize) -> f32x8<S> {
        let planes = &node.planes[axis][(self.far_side[axis] ^ 1) & 1];
        f32x8::load_array_ref(simd, planes).mul_sub(self.inverse[axis], self.near_offset[axis])
    }

    /// Where it leaves them.
    #[inline(always)]
    fn far(&self, simd: S, node: &WideNode, axis: usize) -> f32x8<S> {
        let planes = &node.planes[axis][self.far_side[axis] & 1];
        f32x8::load_array_ref(simd, planes).mul_sub(self.inverse_far[axis], self.far_offset[axis])
    }

    /// Which of a node's boxes the ray meets at some t' in [0, bound] (bit by bit), and where it enters each.
    #[inline(always)]
    pub fn meets(&self, simd: S, node: &WideNode, bound: f32) -> (u32, [f32; WIDTH]) {
        let near = [self.near(simd, node, 0), self.near(simd, node, 1), self.near(simd, node, 2)];
        let far = [self.far(simd, node, 0), self.far(simd, node, 1), self.far(simd, node, 2)];
        let enter = near[0].max(near[1]).max(near[2].max(f32x8::splat(simd, 0.0)));
        let leave = far[0].min(far[1]).min(far[2].min(f32x8::splat(simd, bound)));
        let mask = enter.simd_le(leave).to_bitmask();
        (mask as u32, enter.to_array())
    }
}

/// A child that waits, in one word that sorts by distance: where the ray enters its box (never below 0, so that its
/// bits ascend with it), then the child.
#[inline(always)]
fn waiting(enter: f32, child: Child) -> u64 {
    (u64::from(enter.to_bits()) << 32) | u64::from(child.0)
}

/// Walks every ray of the batch through the tree; `stack` has room for `tree.stack` children and eight more.
///
/// Four rays in turn, a step each, so that one computes while another waits for memory, would cost near rays and small
/// trees 10 to 20 %: only rays that start far apart in a large tree walk so (`turns.rs`).
#[inline(always)]
pub fn walk<S: Simd, B: Batch>(
    simd: S,
    tree: &Tree,
    stack: &mut [u64],
    queries: &Queries<'_>,
    batch: &mut B,
) {
    for first in (0..queries.len()).step_by(LANES) {
        // Sixteen rays are made ready at once.
        let count = LANES.min(queries.len() - first);
        let group = Group::of(simd, &tree.frame, queries, &numbers(first)[..count]);
        for lane in 0..count {
            let ray = group.ray(&tree.frame, lane);
            let mut tests = 1;
            if ray.bound >= 0.0 {
                let start = Start { child: tree.root, t_max: group.t_max[lane], ray: first + lane };
                tests += walk_ray(simd, tree, stack, ray, start, batch).1;
            }
            batch.finished(first + lane, tests);
        }
    }
}

/// The numbers of sixteen rays.
#[inline(always)]
pub fn numbers(first: usize) -> [u32; LANES] {
    let mut numbers = [first as u32; LANES];
    for (lane, number) in numbers.iter_mut().enumerate() {
        *number += lane as u32;
    }
    numbers
}

/// Where a single ray's walk begins.
pub struct Start {
    /// All that stands below is walked.
    pub child: Child,
    /// The upper bound of t so far.
    pub t_max: f64,
    /// The ray's number in the batch.
    pub ray: usize,
}

/// Walks one ray from a child down; returns the new upper bound of t, and how many boxes it was tested against.
#[inline(always)]
pub fn walk_ray<S: Simd, B: Batch>(
    simd: S,
    tree: &Tree,
    stack: &mut [u64],
    mut narrow: NarrowRay,
    Start { mut child, mut t_max, ray: i }: Start,
    batch: &mut B,
) -> (f64, u64) {
    let ray = SpreadRay::new(simd, &narrow);
    let mut nodes = 0;
    let mut top = 0;
    loop {
        if child.is_leaf() {
            // A leaf: the caller tests the items, and may bring the bound nearer.
            let (first, count) = child.items();
            let answer = batch.leaf_block(simd, &narrow, i, [first, count], t_max);
            if answer < t_max {
                t_max = answer;
                if t_max == f64::NEG_INFINITY {
                    break;
                }
                narrow.set_bound(t_max);
            }
        } else {
            // A node: the boxes that the ray meets go onto the stack, the nearest on top.
            let node = &tree.nodes[child.0 as usize];
            nodes += 1;
            let (mask, enter) = ray.meets(simd, node, narrow.bound);
            if mask != 0 {
                (child, top) = stack_children(stack, top, node, mask, &enter);
                continue;
            }
        }
        match next_waiting(stack, &mut top, 0, narrow.bound) {
            Some(next) => child = next,
            None => break,
        }
    }
    (t_max, WIDTH as u64 * nodes)
}

/// Takes the next child that waits off the stack, unless a hit has been found in front of it: then the next but one,
/// and so on.
#[inline(always)]
pub fn next_waiting(stack: &[u64], top: &mut usize, bottom: usize, bound: f32) -> Option<Child> {
    while *top > bottom {
        *top -= 1;
        let next = stack[*top];
        if f32::from_bits((next >> 32) as u32) <= bound {
            return Some(Child(next as u32));
        }
    }
    None
}

/// Puts a node's children that the ray meets (one at least) on the stack, the nearest on top; takes that one off
/// again and returns it with the new top.
#[inline(always)]
pub fn stack_children(
    stack: &mut [u64],
    mut top: usize,
    node: &WideNode,
    mut mask: u32,
    enter: &[f32; WIDTH],
) -> (Child, usize) {
    let lane = mask.trailing_zeros() as usize % WIDTH;
    if mask & (mask - 1) == 0 {
        return (node.children[lane], top);
    }
    // Two and three are put in order without a branch, which would be guessed wrong every other time.
    let (a, b) = (take_lowest(&mut mask, node, enter), take_lowest(&mut mask, node, enter));
    let (a, b) = ordered(a, b);
    if mask == 0 {
        stack[top] = b;
        return (Child(a as u32), top + 1);
    }
    let c = take_lowest(&mut mask, node, enter);
    let (b, c) = ordered(b, c);
    let (a, b) = ordered(a, b);
    let bottom = top;
    let room = &mut stack[top..top + 3];
    (room[0], room[1], room[2]) = (c, b, a);
    top += 3;
    while mask != 0 {
        insert(stack, bottom, top, take_lowest(&mut mask, node, enter));
        top += 1;
    }
    (Child(stack[top - 1] as u32), top - 1)
}

/// The child of the lowest lane of the mask, which is taken out of it.
#[inline(always)]
fn take_lowest(mask: &mut u32, node: &WideNode, enter: &[f32; WIDTH]) -> u64 {
    let lane = mask.trailing_zeros() as usize % WIDTH;
    *mask &= *mask - 1;
    waiting(enter[lane], node.children[lane])
}

/// The lesser and the greater, without a branch to guess wrong.
#[inline(always)]
fn ordered(a: u64, b: u64) -> (u64, u64) {
    (a.min(b), a.max(b))
}

/// Inserts into `stack[bottom..top]`, which descends.
#[inline(always)]
fn insert(stack: &mut [u64], bottom: usize, top: usize, new: u64) {
    let mut place = top;
    while place > bottom && stack[place - 1] < new {
        stack[place] = stack[place - 1];
        place -= 1;
    }
    stack[place] = new;
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::narrow::Frame;
    use crate::narrow::Slack;
    use crate::simd::available_levels;
    use crate::simd::dispatch;
    use dotray_geometry::Aabb;
    use dotray_geometry::Ray;
    use dotray_geometry::Vec3;

    /// From -1 to below 1, the same on every machine.
    fn number(state: &mut u64) -> f64 {
        *state = state.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
        (*state >> 11) as f64 / (1_u64 << 52) as f64 - 1.0
    }

    /// Where a ray meets a sphere, as a caller would find it.
    fn sphere_hit(ray: &Ray, center: Vec3, radius: f64) -> Option<f64> {
        let to_center = center - ray.origin;
        let middle = to_center.dot(ray.direction);
        let square = radius * radius - (to_center - ray.direction * middle).length_squared();
        (square >= 0.0).then(|| middle - square.sqrt())
    }

    /// How many of the hits on single spheres the test of their boxes hides, at the end of a ray that ends right there;
    /// the rays touch the spheres next to the planes of their boxes, from near, far and very far.
    fn hidden_hits(frame: &Frame, level: crate::simd::Level) -> (u32, u32) {
        let (mut hits, mut hidden) = (0, 0);
        let mut state = 1;
        for i in 0..60_000 {
            let center = Vec3::new(number(&mut state), number(&mut state), number(&mut state));
            let radius = 0.001 + 0.01 * number(&mut state).abs();
            let axis = i % 3;
            let mut pole = center;
            pole[axis] += radius.copysign(number(&mut state));
            let mut direction = Vec3::new(number(&mut state), number(&mut state), number(&mut state));
            direction[axis] *= [0.0, 1e-13, 1e-8, 1e-5][i / 3 % 4];
            let direction = direction.normalize();
            let distance = [0.1, 3.0, 1e4, 1e8][i / 12 % 4] * (1.1 + number(&mut state));
            let ray = Ray::new(pole - direction * distance, direction);
            let Some(t) = sphere_hit(&ray, center, radius).filter(|&t| t > 0.0) else { continue };
            hits += 1;
            let queries = Queries { rays: &[ray], t_min: &[0.0], t_max: &[t] };
            let mut node = WideNode::EMPTY;
            node.set(0, &frame.narrow(&Aabb::new(center - radius, center + radius)), Child::leaf(0, 1));
            let met = dispatch!(level, simd => {
                let ray = Group::of(simd, frame, &queries, &[0]).ray(frame, 0);
                SpreadRay::new(simd, &ray).meets(simd, &node, ray.bound).0 == 1
            });
            hidden += u32::from(!met);
        }
        (hits, hidden)
    }

    #[test]
    fn no_hit_is_hidden_and_without_slack_some_are() {
        let frame = Frame::around(Aabb::new(Vec3::splat(-1.1), Vec3::splat(1.1)));
        let careless = frame.with_slack(Slack::NONE);
        for level in available_levels() {
            let (hits, hidden) = hidden_hits(&frame, level);
            assert!(hits > 20_000);
            assert_eq!(hidden, 0, "{level:?}");
            let (_, hidden) = hidden_hits(&careless, level);
            assert!(hidden > 50, "the control hides only {hidden} of {hits} at {level:?}");
        }
    }
}

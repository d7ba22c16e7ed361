//! Which rays may hit which shapes: in single precision, eight at a time, never wrongly no.
//!
//! All numbers are in the accelerator's frame ([`dotray_accel::narrow`]): points of the scene have coordinates of
//! magnitude 1 at most, and rays start in the scene, so that |c - o| < 3.5 for a point c and a start o. With
//! u = 2^-24, rounding c and o and subtracting displaces c - o by at most 3 u an axis, rounding the unit direction
//! and multiplying by it adds less than 30 u, so that
//!
//! - a distance between a ray and a point or an axis is off by less than 60 u: [`MARGIN`] is 128 u;
//! - the products of the triangle's test are off by less than 60 u times the edges' lengths, and [`MARGIN`] times the
//!   sum of both is allowed; the plane's normal is computed from the rounded edges, so that what depends on it is off
//!   by less than 60 u times the product of their lengths.
//!
//! The numbers stand side by side, a list a coordinate and a place a position, so that the same arithmetic serves
//! eight shapes of a leaf against one ray (lanes are shapes) and one shape against eight rays (lanes are rays).

use dotray_accel::narrow::Frame;
use dotray_accel::narrow::NarrowRay;
use dotray_accel::packet::GROUPS;
use dotray_accel::packet::Group;
use dotray_accel::packet::LANES;
use dotray_accel::packet::Packet;
use dotray_accel::simd::Simd;
use dotray_accel::simd::f32x8;
use dotray_accel::simd::mask32x8;
use dotray_accel::simd::prelude::*;
use dotray_geometry::Aabb;
use dotray_geometry::Affine;
use dotray_geometry::Vec3;

/// See above: 128 u.
const MARGIN: f32 = 1.0 / (1 << 17) as f32;

// No `array::map` over vectors here: the library's loop is not inlined into the function that has the SIMD
// instructions, and each operation then becomes a call.

type Lanes<S> = [f32x8<S>; 3];

#[inline(always)]
fn load<S: Simd>(simd: S, lanes: &[[f32; LANES]; 3]) -> Lanes<S> {
    [
        f32x8::load_array_ref(simd, &lanes[0]),
        f32x8::load_array_ref(simd, &lanes[1]),
        f32x8::load_array_ref(simd, &lanes[2]),
    ]
}

#[inline(always)]
fn splat<S: Simd>(simd: S, point: [f32; 3]) -> Lanes<S> {
    [f32x8::splat(simd, point[0]), f32x8::splat(simd, point[1]), f32x8::splat(simd, point[2])]
}

#[inline(always)]
fn dot<S: Simd>(a: Lanes<S>, b: Lanes<S>) -> f32x8<S> {
    a[0].mul_add(b[0], a[1].mul_add(b[1], a[2] * b[2]))
}

#[inline(always)]
fn cross<S: Simd>(a: Lanes<S>, b: Lanes<S>) -> Lanes<S> {
    [a[1].mul_sub(b[2], a[2] * b[1]), a[2].mul_sub(b[0], a[0] * b[2]), a[0].mul_sub(b[1], a[1] * b[0])]
}

#[inline(always)]
fn sub<S: Simd>(a: Lanes<S>, b: Lanes<S>) -> Lanes<S> {
    [a[0] - b[0], a[1] - b[1], a[2] - b[2]]
}

/// Eight rays, or one ray eight times.
struct Rays<S: Simd> {
    origin: Lanes<S>,
    direction: Lanes<S>,
    bound: f32x8<S>,
    inverse: Lanes<S>,
    inverse_far: Lanes<S>,
    near_offset: Lanes<S>,
    far_offset: Lanes<S>,
    /// Which side of a box each ray leaves through: 0 the low one, 1 the high one.
    far_side: [usize; 3],
}

impl<S: Simd> Rays<S> {
    #[inline(always)]
    fn of_group(simd: S, group: &Group) -> Self {
        Self {
            origin: load(simd, &group.origin),
            direction: load(simd, &group.direction),
            bound: f32x8::load_array_ref(simd, &group.bound),
            inverse: load(simd, &group.inverse),
            inverse_far: load(simd, &group.inverse_far),
            near_offset: load(simd, &group.near_offset),
            far_offset: load(simd, &group.far_offset),
            // All lanes of a packet have directions of the same signs.
            far_side: [side(&group.direction[0]), side(&group.direction[1]), side(&group.direction[2])],
        }
    }

    #[inline(always)]
    fn of_ray(simd: S, ray: &NarrowRay) -> Self {
        Self {
            origin: splat(simd, ray.origin),
            direction: splat(simd, ray.direction),
            bound: f32x8::splat(simd, ray.bound),
            inverse: splat(simd, ray.inverse),
            inverse_far: splat(simd, ray.inverse_far),
            near_offset: splat(simd, ray.near_offset),
            far_offset: splat(simd, ray.far_offset),
            far_side: ray.far_side,
        }
    }
}

#[inline(always)]
fn side(direction: &[f32; LANES]) -> usize {
    usize::from(!direction[0].is_sign_negative())
}

/// What rules shapes out, by position. A list stays empty while no shape needs it, and holds what rules nothing out
/// at the positions of shapes that do not.
#[derive(Debug, Default)]
pub struct Culls {
    /// Balls: the centre and the reach.
    balls: [Vec<f32>; 4],
    /// Round bars in their balls: the axis and the reach.
    bars: [Vec<f32>; 4],
    /// Axis-aligned boxes: the low and the high planes.
    boxes: [Vec<f32>; 6],
    /// Triangles: a corner and the two edges that leave it.
    corners: [Vec<f32>; 9],
}

const ANY_BALL: [f32; 4] = [0.0, 0.0, 0.0, f32::INFINITY];

/// Across an axis of no length every distance is 0.
const ANY_BAR: [f32; 4] = [0.0; 4];

const ANY_BOX: [f32; 6] = [f32::MIN, f32::MIN, f32::MIN, f32::MAX, f32::MAX, f32::MAX];

/// A triangle without an area lies along every ray.
const ANY_CORNER: [f32; 9] = [0.0; 9];

/// Puts numbers at a position, behind places that rule nothing out.
fn put<const N: usize>(lists: &mut [Vec<f32>; N], position: usize, any: [f32; N], numbers: [f32; N]) {
    fill(lists, position, any);
    for (list, number) in lists.iter_mut().zip(numbers) {
        list.push(number);
    }
}

fn fill<const N: usize>(lists: &mut [Vec<f32>; N], len: usize, any: [f32; N]) {
    for (list, number) in lists.iter_mut().zip(any) {
        list.resize(len, number);
    }
}

fn joined<const A: usize, const B: usize, const N: usize>(a: [f32; A], b: [f32; B]) -> [f32; N] {
    let mut all = [0.0; N];
    all[..A].copy_from_slice(&a);
    all[A..].copy_from_slice(&b);
    all
}

impl Culls {
    /// A ball of the world.
    pub fn put_ball(&mut self, frame: &Frame, position: usize, center: Vec3, radius: f64) {
        let reach = (radius * frame.scale()) as f32 * (1.0 + MARGIN) + MARGIN;
        put(&mut self.balls, position, ANY_BALL, joined(frame.point(center), [reach]));
    }

    /// What lies around a line of the world.
    pub fn put_bar(&mut self, frame: &Frame, position: usize, spine: &Spine) {
        self.put_ball(frame, position, spine.point, spine.reach);
        let axis = spine.axis.to_array().map(|x| x as f32);
        let reach = (spine.radius * frame.scale()) as f32 * (1.0 + MARGIN);
        put(&mut self.bars, position, ANY_BAR, joined(axis, [reach]));
    }

    /// What lies in a box of the world.
    pub fn put_box(&mut self, frame: &Frame, position: usize, bounds: &Aabb) {
        let narrow = frame.narrow(bounds);
        put(&mut self.boxes, position, ANY_BOX, joined(narrow.low, narrow.high));
    }

    /// A triangle of the world.
    pub fn put_triangle(&mut self, frame: &Frame, position: usize, corners: &[Vec3; 3]) {
        let edge = |i: usize| ((corners[i] - corners[0]) * frame.scale()).to_array().map(|x| x as f32);
        let edges: [f32; 6] = joined(edge(1), edge(2));
        put(&mut self.corners, position, ANY_CORNER, joined(frame.point(corners[0]), edges));
    }

    /// Makes room for as many balls and triangles, or for none of them.
    pub fn reserve(&mut self, balls: usize, triangles: usize) {
        let with_end = |count: usize| if count > 0 { count + LANES } else { 0 };
        self.balls.iter_mut().for_each(|list| list.reserve_exact(with_end(balls)));
        self.corners.iter_mut().for_each(|list| list.reserve_exact(with_end(triangles)));
    }

    /// Appends what was put down from position 0 on elsewhere, from `position` on.
    pub fn append(&mut self, position: usize, other: Self) {
        fn join<const N: usize>(
            lists: &mut [Vec<f32>; N],
            first: usize,
            other: [Vec<f32>; N],
            any: [f32; N],
        ) {
            if !other[0].is_empty() {
                fill(lists, first, any);
                lists.iter_mut().zip(other).for_each(|(list, mut other)| list.append(&mut other));
            }
        }
        join(&mut self.balls, position, other.balls, ANY_BALL);
        join(&mut self.bars, position, other.bars, ANY_BAR);
        join(&mut self.boxes, position, other.boxes, ANY_BOX);
        join(&mut self.corners, position, other.corners, ANY_CORNER);
    }

    /// Ends the lists so that eight places may be read from every one of `count` positions.
    pub fn finish(&mut self, count: usize) {
        fn end<const N: usize>(lists: &mut [Vec<f32>; N], len: usize, any: [f32; N]) {
            if !lists[0].is_empty() {
                lists.iter_mut().for_each(|list| list.reserve_exact(len - list.len()));
                fill(lists, len, any);
            }
        }
        end(&mut self.balls, count + LANES, ANY_BALL);
        end(&mut self.bars, count + LANES, ANY_BAR);
        end(&mut self.boxes, count + LANES, ANY_BOX);
        end(&mut self.corners, count + LANES, ANY_CORNER);
    }

    /// The bytes of the lists.
    pub fn memory(&self) -> u64 {
        let lists = self.balls.iter().chain(&self.bars).chain(&self.boxes).chain(&self.corners);
        lists.map(|list| size_of_val(list.as_slice()) as u64).sum()
    }

    /// Which of the `count` shapes from position `first` on (eight at most) the ray may hit, bit by bit.
    #[inline(always)]
    pub fn block<S: Simd>(&self, simd: S, ray: &NarrowRay, first: u32, count: u32) -> u32 {
        let first = first as usize;
        let rays = Rays::of_ray(simd, ray);
        let get = |list: &Vec<f32>| f32x8::from_slice(simd, &list[first..first + LANES]);
        let present = (1_u32 << count) - 1;
        present & self.may_hit(simd, &rays, get)
    }

    /// Which lanes of the groups `active` of a packet may hit the shape at `position`, bit by bit.
    #[inline(always)]
    pub fn sweep<S: Simd>(&self, simd: S, position: u32, packet: &Packet, active: u32) -> [u8; GROUPS] {
        let get = |list: &Vec<f32>| f32x8::splat(simd, list[position as usize]);
        let mut lanes = [0; GROUPS];
        let mut left = active;
        while left != 0 {
            let group = left.trailing_zeros() as usize % GROUPS;
            left &= left - 1;
            let rays = Rays::of_group(simd, packet.group(group));
            lanes[group] = self.may_hit(simd, &rays, get) as u8;
        }
        lanes
    }

    /// Which lanes may hit; `get` takes the lanes' shapes out of a list. Rays that have ended never do.
    #[inline(always)]
    fn may_hit<S: Simd>(&self, simd: S, rays: &Rays<S>, get: impl Fn(&Vec<f32>) -> f32x8<S>) -> u32 {
        let mut may = rays.bound.simd_ge(f32x8::splat(simd, 0.0));
        if let [x, y, z, reach] = &self.balls
            && !x.is_empty()
        {
            let center = [get(x), get(y), get(z)];
            may &= meets_ball(simd, rays, center, get(reach));
            if let [x, y, z, reach] = &self.bars
                && !x.is_empty()
                && may.any_true()
            {
                may &= meets_bar(simd, rays, center, [get(x), get(y), get(z)], get(reach));
            }
        }
        if !self.boxes[0].is_empty() && may.any_true() {
            let low = [get(&self.boxes[0]), get(&self.boxes[1]), get(&self.boxes[2])];
            let high = [get(&self.boxes[3]), get(&self.boxes[4]), get(&self.boxes[5])];
            may &= meets_box(simd, rays, low, high);
        }
        if let [x, y, z, ux, uy, uz, vx, vy, vz] = &self.corners
            && !x.is_empty()
            && may.any_true()
        {
            let point = [get(x), get(y), get(z)];
            let edges = [[get(ux), get(uy), get(uz)], [get(vx), get(vy), get(vz)]];
            may &= meets_triangle(simd, rays, point, edges);
        }
        may.to_bitmask() as u32
    }
}

#[inline(always)]
fn meets_ball<S: Simd>(simd: S, rays: &Rays<S>, center: Lanes<S>, reach: f32x8<S>) -> mask32x8<S> {
    let to_center = sub(center, rays.origin);
    let along = dot(to_center, rays.direction);
    let d = &rays.direction;
    let aside = sub(to_center, [d[0] * along, d[1] * along, d[2] * along]);
    let margin = f32x8::splat(simd, MARGIN);
    let near = dot(aside, aside).simd_le(reach * reach);
    let ahead = (along + reach).simd_ge(-margin);
    let in_time = (along - reach - margin).simd_le(rays.bound);
    near & ahead & in_time
}

/// A round bar: what has a distance of at most `reach` from an axis through the ball's centre.
#[inline(always)]
fn meets_bar<S: Simd>(
    simd: S,
    rays: &Rays<S>,
    center: Lanes<S>,
    axis: Lanes<S>,
    reach: f32x8<S>,
) -> mask32x8<S> {
    let to_center = sub(center, rays.origin);
    let across = cross(rays.direction, axis);
    let distance = dot(to_center, across).abs();
    let length = dot(across, across).sqrt();
    distance.simd_le(length * reach + f32x8::splat(simd, MARGIN))
}

#[inline(always)]
fn meets_box<S: Simd>(simd: S, rays: &Rays<S>, low: Lanes<S>, high: Lanes<S>) -> mask32x8<S> {
    let mut enter = f32x8::splat(simd, 0.0);
    let mut leave = rays.bound;
    for axis in 0..3 {
        let (near, far) =
            if rays.far_side[axis] == 1 { (low[axis], high[axis]) } else { (high[axis], low[axis]) };
        enter = enter.max(near.mul_sub(rays.inverse[axis], rays.near_offset[axis]));
        leave = leave.min(far.mul_sub(rays.inverse_far[axis], rays.far_offset[axis]));
    }
    enter.simd_le(leave)
}

/// After Möller and Trumbore, 'Fast, minimum storage ray/triangle intersection', 1997, without the division and with
/// margins.
#[inline(always)]
fn meets_triangle<S: Simd>(simd: S, rays: &Rays<S>, point: Lanes<S>, edges: [Lanes<S>; 2]) -> mask32x8<S> {
    let number = |x: f32| f32x8::splat(simd, x);
    let to_point = sub(point, rays.origin);
    let normal = cross(edges[0], edges[1]);
    let turned = cross(to_point, rays.direction);
    let volume = dot(normal, rays.direction);
    let size = volume.abs();
    // The sign of the volume, brought to the others.
    let sign = number(1.0).copysign(volume);
    let u = sign * dot(turned, edges[1]);
    let v = -sign * dot(turned, edges[0]);
    let t = sign * dot(normal, to_point);
    // The sum of the coordinates' magnitudes is never less than the length.
    let length = |e: &Lanes<S>| e[0].abs() + e[1].abs() + e[2].abs();
    let (first, second) = (length(&edges[0]), length(&edges[1]));
    let margin = number(MARGIN) * (first + second);
    let plane_margin = number(MARGIN) * first * second;
    let inside = u.simd_ge(-margin) & v.simd_ge(-margin) & (u + v).simd_le(size + margin);
    let in_time = t.simd_ge(-plane_margin) & t.simd_le(rays.bound * size + plane_margin);
    // Where the ray runs along the plane, the sign of the volume may be wrong.
    let grazing = size.simd_le(plane_margin);
    (inside & in_time) | grazing
}

/// A line of the world that a shape lies around.
#[derive(Clone, Copy, Debug)]
pub struct Spine {
    /// A point of the line: the middle of the shape's world box.
    point: Vec3,
    /// The line's direction, of length 1.
    axis: Vec3,
    /// How far the shape's points may be from the line.
    radius: f64,
    /// How far they may be from the point.
    reach: f64,
}

impl Spine {
    /// Around a cylinder or cone of the world from `base` along the unit vector `axis`.
    pub fn along(base: Vec3, axis: Vec3, radius: f64, height: f64) -> Self {
        let half = 0.5 * height;
        Self { point: base + axis * half, axis, radius, reach: (radius * radius + half * half).sqrt() }
    }

    /// Around a cylinder or cone along the object's y axis whose world box is `bounds`: its discs become ellipses,
    /// whose longer half axis is the radius times the larger singular value of the two other columns.
    pub fn new(world_from_object: &Affine, bounds: &Aabb, center: Vec3, radius: f64) -> Option<Self> {
        let m = &world_from_object.matrix3;
        let (xx, zz, xz) = (m.x_axis.length_squared(), m.z_axis.length_squared(), m.x_axis.dot(m.z_axis));
        let half_difference = 0.5 * (xx - zz);
        let largest = 0.5 * (xx + zz) + (half_difference * half_difference + xz * xz).sqrt();
        let axis = m.y_axis.try_normalize()?;
        // The line goes through the shape's centre, which is not quite the middle of a cone's box.
        let point = world_from_object.transform_point3(center);
        let reach = (bounds.max - point).max(point - bounds.min).length();
        let spine = Self { point, axis, radius: radius * largest.sqrt() * (1.0 + 1e-12), reach };
        (spine.radius.is_finite() && reach.is_finite()).then_some(spine)
    }
}

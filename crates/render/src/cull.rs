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
//! The numbers of a leaf's shapes stand together and, within the leaf, coordinate by coordinate, so that the same
//! arithmetic serves eight shapes of a leaf against one ray (lanes are shapes) and one shape against eight rays (lanes
//! are rays), and a leaf touches few cache lines.

use crate::spine::Spine;
use dotray_accel::Accelerator;
use dotray_accel::ahead;
use dotray_accel::narrow::Frame;
use dotray_accel::narrow::NarrowRay;
use dotray_accel::packet::GROUPS;
use dotray_accel::packet::Group;
use dotray_accel::packet::LANES;
use dotray_accel::packet::Packet;
use dotray_accel::simd::Simd;
use dotray_accel::simd::f32x8;
use dotray_accel::simd::f32x16;
use dotray_accel::simd::prelude::*;
use dotray_geometry::Aabb;
use dotray_geometry::Vec3;

/// See above: 128 u.
const MARGIN: f32 = 1.0 / (1 << 17) as f32;

// No `array::map` over vectors here: the library's loop is not inlined into the function that has the SIMD
// instructions, and each operation then becomes a call.

/// A vector of singles: eight wide where lanes are shapes, as wide as a packet's groups where they are rays.
trait Singles<S: Simd>: SimdFloat<S, Element = f32> {}

impl<S: Simd, V: SimdFloat<S, Element = f32>> Singles<S> for V {}

/// The most shapes of a leaf.
const SHAPES: usize = 8;

#[inline(always)]
fn splat<S: Simd, V: Singles<S>>(simd: S, point: [f32; 3]) -> [V; 3] {
    [V::splat(simd, point[0]), V::splat(simd, point[1]), V::splat(simd, point[2])]
}

#[inline(always)]
fn load<S: Simd, V: Singles<S>>(simd: S, lanes: &[[f32; LANES]; 3]) -> [V; 3] {
    [V::from_slice(simd, &lanes[0]), V::from_slice(simd, &lanes[1]), V::from_slice(simd, &lanes[2])]
}

#[inline(always)]
fn dot<S: Simd, V: Singles<S>>(a: [V; 3], b: [V; 3]) -> V {
    a[0].mul_add(b[0], a[1].mul_add(b[1], a[2] * b[2]))
}

#[inline(always)]
fn cross<S: Simd, V: Singles<S>>(a: [V; 3], b: [V; 3]) -> [V; 3] {
    [a[1].mul_sub(b[2], a[2] * b[1]), a[2].mul_sub(b[0], a[0] * b[2]), a[0].mul_sub(b[1], a[1] * b[0])]
}

#[inline(always)]
fn sub<S: Simd, V: Singles<S>>(a: [V; 3], b: [V; 3]) -> [V; 3] {
    [a[0] - b[0], a[1] - b[1], a[2] - b[2]]
}

/// Many rays, or one ray many times.
struct Rays<V> {
    origin: [V; 3],
    direction: [V; 3],
    bound: V,
    inverse: [V; 3],
    inverse_far: [V; 3],
    near_offset: [V; 3],
    far_offset: [V; 3],
    /// Which side of a box each ray leaves through: 0 the low one, 1 the high one.
    far_side: [usize; 3],
}

impl<S: Simd> Rays<f32x16<S>> {
    #[inline(always)]
    fn of_group(simd: S, group: &Group) -> Self {
        Self {
            origin: load(simd, &group.origin),
            direction: load(simd, &group.direction),
            bound: f32x16::load_array_ref(simd, &group.bound),
            inverse: load(simd, &group.inverse),
            inverse_far: load(simd, &group.inverse_far),
            near_offset: load(simd, &group.near_offset),
            far_offset: load(simd, &group.far_offset),
            // All lanes of a packet have directions of the same signs.
            far_side: [side(&group.direction[0]), side(&group.direction[1]), side(&group.direction[2])],
        }
    }
}

impl<S: Simd> Rays<f32x8<S>> {
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

/// Numbers of shapes, `N` a position; empty while no shape needs them.
///
/// They are put down shape by shape. [`Table::finish`] then turns each leaf's round in its place: all first numbers of
/// the leaf's shapes, then all second ones, and so on.
#[derive(Debug)]
struct Table<const N: usize> {
    numbers: Vec<f32>,
    /// What rules nothing out: for positions of shapes that do not need the table.
    any: [f32; N],
}

impl<const N: usize> Table<N> {
    const fn new(any: [f32; N]) -> Self {
        Self { numbers: Vec::new(), any }
    }

    /// Fills up to `position`.
    fn fill(&mut self, position: usize) {
        while self.numbers.len() < N * position {
            self.numbers.extend_from_slice(&self.any);
        }
    }

    fn put(&mut self, position: usize, numbers: [f32; N]) {
        self.fill(position);
        self.numbers.extend_from_slice(&numbers);
    }

    /// Makes room for so many shapes, if any.
    fn reserve(&mut self, count: usize) {
        if count > 0 {
            self.numbers.reserve_exact(N * count + SHAPES);
        }
    }

    /// Moves what was put down from position 0 on elsewhere here, from `first` on.
    fn append(&mut self, first: usize, other: &mut Self) {
        if !other.numbers.is_empty() {
            self.fill(first);
            self.numbers.append(&mut other.numbers);
        }
    }

    /// Ends the table at `count` positions, and turns its leaves round. Lanes behind a leaf's last shape read numbers
    /// of the next leaf, or of the few that are put behind the last one.
    fn finish(&mut self, count: usize, accelerator: &Accelerator) {
        if self.numbers.is_empty() {
            return;
        }
        self.numbers.reserve_exact(N * count + SHAPES - self.numbers.len());
        self.fill(count);
        accelerator.each_leaf(&mut |first, count| {
            let (first, count) = (first as usize, count as usize);
            let mut turned = [[0.0; SHAPES]; N];
            let leaf = &mut self.numbers[N * first..N * (first + count)];
            for (lane, shape) in leaf.chunks_exact(N).enumerate() {
                (0..N).for_each(|number| turned[number][lane % SHAPES] = shape[number]);
            }
            for (row, numbers) in leaf.chunks_exact_mut(count).zip(&turned) {
                row.copy_from_slice(&numbers[..count]);
            }
        });
        self.numbers.extend([0.0; SHAPES]);
    }

    /// Asks for the numbers of a leaf's shapes.
    #[inline(always)]
    fn expect(&self, first: usize, count: usize) {
        if !self.numbers.is_empty() {
            ahead::fetch(&self.numbers, N * first, N * count);
        }
    }

    /// One number of every shape of a leaf, a lane each.
    #[inline(always)]
    fn of_all<S: Simd, V: Singles<S>>(&self, simd: S, leaf: Leaf, number: usize) -> V {
        let start = N * leaf.first + number * leaf.count;
        V::from_slice(simd, &self.numbers[start..start + SHAPES])
    }

    /// One number of one shape of a leaf, in all lanes.
    #[inline(always)]
    fn of_one<S: Simd, V: Singles<S>>(&self, simd: S, leaf: Leaf, number: usize) -> V {
        V::splat(simd, self.numbers[N * leaf.first + number * leaf.count + leaf.shape])
    }
}

/// A leaf, and one of its shapes where one is asked about.
#[derive(Clone, Copy, Debug)]
struct Leaf {
    first: usize,
    count: usize,
    shape: usize,
}

/// What rules shapes out, by position.
#[derive(Debug)]
pub struct Culls {
    /// Balls: the centre and the reach.
    balls: Table<4>,
    /// Round bars in their balls: the axis and the reach.
    bars: Table<4>,
    /// Axis-aligned boxes: the low and the high planes.
    boxes: Table<6>,
    /// Triangles: a corner and the two edges that leave it.
    corners: Table<9>,
}

impl Default for Culls {
    fn default() -> Self {
        Self {
            balls: Table::new([0.0, 0.0, 0.0, f32::INFINITY]),
            // Across an axis of no length every distance is 0.
            bars: Table::new([0.0; 4]),
            boxes: Table::new([f32::MIN, f32::MIN, f32::MIN, f32::MAX, f32::MAX, f32::MAX]),
            // A triangle without an area lies along every ray.
            corners: Table::new([0.0; 9]),
        }
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
        self.balls.put(position, joined(frame.point(center), [reach]));
    }

    /// What lies around a line of the world.
    pub fn put_bar(&mut self, frame: &Frame, position: usize, spine: &Spine) {
        self.put_ball(frame, position, spine.point, spine.reach);
        let axis = spine.axis.to_array().map(|x| x as f32);
        let reach = (spine.radius * frame.scale()) as f32 * (1.0 + MARGIN);
        self.bars.put(position, joined(axis, [reach]));
    }

    /// What lies in a box of the world.
    pub fn put_box(&mut self, frame: &Frame, position: usize, bounds: &Aabb) {
        let narrow = frame.narrow(bounds);
        self.boxes.put(position, joined(narrow.low, narrow.high));
    }

    /// A triangle of the world.
    pub fn put_triangle(&mut self, frame: &Frame, position: usize, corners: &[Vec3; 3]) {
        let edge = |i: usize| ((corners[i] - corners[0]) * frame.scale()).to_array().map(|x| x as f32);
        let edges: [f32; 6] = joined(edge(1), edge(2));
        self.corners.put(position, joined(frame.point(corners[0]), edges));
    }

    /// Makes room for as many balls, bars, boxes and triangles, or for none of them.
    pub fn reserve(&mut self, [balls, bars, boxes, triangles]: [usize; 4]) {
        self.balls.reserve(balls);
        self.bars.reserve(bars);
        self.boxes.reserve(boxes);
        self.corners.reserve(triangles);
    }

    /// Moves what was put down from position 0 on elsewhere here, from `position` on.
    pub fn append(&mut self, position: usize, other: &mut Self) {
        self.balls.append(position, &mut other.balls);
        self.bars.append(position, &mut other.bars);
        self.boxes.append(position, &mut other.boxes);
        self.corners.append(position, &mut other.corners);
    }

    /// Ends the lists at `count` positions, and lays them out leaf by leaf.
    pub fn finish(&mut self, count: usize, accelerator: &Accelerator) {
        self.balls.finish(count, accelerator);
        self.bars.finish(count, accelerator);
        self.boxes.finish(count, accelerator);
        self.corners.finish(count, accelerator);
    }

    /// The bytes of the lists.
    pub fn memory(&self) -> u64 {
        let lists = [&self.balls.numbers, &self.bars.numbers, &self.boxes.numbers, &self.corners.numbers];
        lists.iter().map(|list| size_of_val(list.as_slice()) as u64).sum()
    }

    /// Asks for what [`Culls::block`] reads of a leaf.
    #[inline(always)]
    pub fn expect(&self, first: usize, count: usize) {
        self.balls.expect(first, count);
        self.bars.expect(first, count);
        self.boxes.expect(first, count);
        self.corners.expect(first, count);
    }

    /// Which of the shapes of the leaf of `count` positions from `first` on the ray may hit, bit by bit.
    #[inline(always)]
    pub fn block<S: Simd>(&self, simd: S, ray: &NarrowRay, first: u32, count: u32) -> u32 {
        let rays = Rays::of_ray(simd, ray);
        let present = (1_u32 << count) - 1;
        present
            & self.may_hit(
                simd,
                &rays,
                Shown::<true>(Leaf { first: first as usize, count: count as usize, shape: 0 }),
            )
    }

    /// Which lanes of the groups `active` of a packet may hit shape number `shape` of a leaf, bit by bit.
    #[inline(always)]
    pub fn sweep<S: Simd>(
        &self,
        simd: S,
        [first, count, shape]: [u32; 3],
        packet: &Packet,
        active: u32,
    ) -> [u16; GROUPS] {
        let leaf = Leaf { first: first as usize, count: count as usize, shape: shape as usize };
        let mut lanes = [0; GROUPS];
        let mut left = active;
        while left != 0 {
            let group = left.trailing_zeros() as usize % GROUPS;
            left &= left - 1;
            let rays = Rays::of_group(simd, packet.group(group));
            lanes[group] = self.may_hit(simd, &rays, Shown::<false>(leaf)) as u16;
        }
        lanes
    }

    /// Which lanes may hit. Rays that have ended never do.
    #[inline(always)]
    fn may_hit<S: Simd, V: Singles<S>, const ALL: bool>(
        &self,
        simd: S,
        rays: &Rays<V>,
        shown: Shown<ALL>,
    ) -> u32 {
        let mut may = rays.bound.simd_ge(V::splat(simd, 0.0));
        let (balls, bars, boxes, corners) = (&self.balls, &self.bars, &self.boxes, &self.corners);
        if !balls.numbers.is_empty() {
            let center = shown.point(simd, balls, 0);
            may &= meets_ball(simd, rays, center, shown.number(simd, balls, 3));
            if !bars.numbers.is_empty() && may.any_true() {
                may &= meets_bar(simd, rays, center, shown.point(simd, bars, 0), shown.number(simd, bars, 3));
            }
        }
        if !boxes.numbers.is_empty() && may.any_true() {
            may &= meets_box(simd, rays, shown.point(simd, boxes, 0), shown.point(simd, boxes, 3));
        }
        if !corners.numbers.is_empty() && may.any_true() {
            let edges = [shown.point(simd, corners, 3), shown.point(simd, corners, 6)];
            may &= meets_triangle(simd, rays, shown.point(simd, corners, 0), edges);
        }
        may.to_bitmask() as u32
    }
}

/// What the lanes hold: all shapes of a leaf, or the same one again and again.
#[derive(Clone, Copy)]
struct Shown<const ALL: bool>(Leaf);

impl<const ALL: bool> Shown<ALL> {
    #[inline(always)]
    fn number<S: Simd, V: Singles<S>, const N: usize>(self, simd: S, table: &Table<N>, number: usize) -> V {
        if ALL { table.of_all(simd, self.0, number) } else { table.of_one(simd, self.0, number) }
    }

    /// Three numbers that follow each other.
    #[inline(always)]
    fn point<S: Simd, V: Singles<S>, const N: usize>(
        self,
        simd: S,
        table: &Table<N>,
        number: usize,
    ) -> [V; 3] {
        [
            self.number(simd, table, number),
            self.number(simd, table, number + 1),
            self.number(simd, table, number + 2),
        ]
    }
}

#[inline(always)]
fn meets_ball<S: Simd, V: Singles<S>>(simd: S, rays: &Rays<V>, center: [V; 3], reach: V) -> V::Mask {
    let to_center = sub(center, rays.origin);
    let along = dot(to_center, rays.direction);
    let d = &rays.direction;
    let aside = sub(to_center, [d[0] * along, d[1] * along, d[2] * along]);
    let margin = V::splat(simd, MARGIN);
    let near = dot(aside, aside).simd_le(reach * reach);
    let ahead = (along + reach).simd_ge(-margin);
    let in_time = (along - reach - margin).simd_le(rays.bound);
    near & ahead & in_time
}

/// A round bar: what has a distance of at most `reach` from an axis through the ball's centre.
#[inline(always)]
fn meets_bar<S: Simd, V: Singles<S>>(
    simd: S,
    rays: &Rays<V>,
    center: [V; 3],
    axis: [V; 3],
    reach: V,
) -> V::Mask {
    let to_center = sub(center, rays.origin);
    let across = cross(rays.direction, axis);
    let distance = dot(to_center, across).abs();
    let length = dot(across, across).sqrt();
    distance.simd_le(length * reach + V::splat(simd, MARGIN))
}

#[inline(always)]
fn meets_box<S: Simd, V: Singles<S>>(simd: S, rays: &Rays<V>, low: [V; 3], high: [V; 3]) -> V::Mask {
    let mut enter = V::splat(simd, 0.0);
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
fn meets_triangle<S: Simd, V: Singles<S>>(
    simd: S,
    rays: &Rays<V>,
    point: [V; 3],
    edges: [[V; 3]; 2],
) -> V::Mask {
    let number = |x: f32| V::splat(simd, x);
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
    let length = |e: &[V; 3]| e[0].abs() + e[1].abs() + e[2].abs();
    let (first, second) = (length(&edges[0]), length(&edges[1]));
    let margin = number(MARGIN) * (first + second);
    let plane_margin = number(MARGIN) * first * second;
    let inside = u.simd_ge(-margin) & v.simd_ge(-margin) & (u + v).simd_le(size + margin);
    let in_time = t.simd_ge(-plane_margin) & t.simd_le(rays.bound * size + plane_margin);
    // Where the ray runs along the plane, the sign of the volume may be wrong.
    let grazing = size.simd_le(plane_margin);
    (inside & in_time) | grazing
}

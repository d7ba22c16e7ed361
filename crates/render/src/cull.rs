//! Which of eight rays may hit a shape: in single precision, never wrongly no.
//!
//! All numbers are in the accelerator's frame ([`dotray_accel::narrow`]): points of the scene have coordinates of
//! magnitude 1 at most, and rays start in the scene, so that |c - o| < 3.5 for a point c and a start o. With
//! u = 2^-24, rounding c and o and subtracting displaces c - o by at most 3 u an axis, rounding the unit direction
//! and multiplying by it adds less than 30 u, so that
//!
//! - a distance between a ray and a point or an axis is off by less than 60 u: [`MARGIN`] is 128 u;
//! - the products of the triangle's test are off by less than 60 u times the edges' lengths, and [`MARGIN`] times the
//!   sum of both is allowed.

use dotray_accel::narrow::Frame;
use dotray_accel::packet::Group;
use dotray_accel::packet::LANES;
use dotray_accel::simd::Simd;
use dotray_accel::simd::f32x8;
use dotray_accel::simd::prelude::*;
use dotray_geometry::Aabb;
use dotray_geometry::Affine;
use dotray_geometry::Sphere;
use dotray_geometry::Vec3;

/// See above: 128 u.
const MARGIN: f32 = 1.0 / (1 << 17) as f32;

// No `array::map` over vectors here: the library's loop is not inlined into the function that has the SIMD
// instructions, and each operation then becomes a call.

/// A shape made ready to be ruled out for many groups of rays.
pub trait Cull {
    /// Which lanes may hit it between their starts and their bounds, bit by bit; ended lanes never do.
    fn may_hit<S: Simd>(&self, simd: S, group: &Group) -> u32;
}

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

/// A ball.
pub struct Ball {
    center: [f32; 3],
    reach: f32,
}

impl Ball {
    /// Around a sphere of the world.
    #[inline(always)]
    pub fn new(frame: &Frame, center: Vec3, radius: f64) -> Self {
        let radius = (radius * frame.scale()) as f32;
        Self { center: frame.point(center), reach: radius * (1.0 + MARGIN) + MARGIN }
    }

    /// Around a sphere of the world.
    #[inline(always)]
    pub fn around(frame: &Frame, sphere: &Sphere) -> Self {
        Self::new(frame, sphere.center(), sphere.radius())
    }
}

impl Cull for Ball {
    #[inline(always)]
    fn may_hit<S: Simd>(&self, simd: S, group: &Group) -> u32 {
        let direction = load(simd, &group.direction);
        let to_center = sub(splat(simd, self.center), load(simd, &group.origin));
        let along = dot(to_center, direction);
        let aside = sub(to_center, [direction[0] * along, direction[1] * along, direction[2] * along]);
        let bound = f32x8::load_array_ref(simd, &group.bound);
        let reach = f32x8::splat(simd, self.reach);
        let near = dot(aside, aside).simd_le(reach * reach);
        let ahead = (along + reach).simd_ge(f32x8::splat(simd, -MARGIN));
        let in_time = (along - reach - f32x8::splat(simd, MARGIN)).simd_le(bound);
        let alive = bound.simd_ge(f32x8::splat(simd, 0.0));
        (near & ahead & in_time & alive).to_bitmask() as u32
    }
}

/// A round bar: what has a distance of at most a radius from an axis, inside a ball around its middle.
pub struct Bar {
    ball: Ball,
    axis: [f32; 3],
    reach: f32,
}

impl Bar {
    /// Around a cylinder or cone of the world from `base` along the unit vector `axis`.
    #[inline(always)]
    pub fn new(frame: &Frame, base: Vec3, axis: Vec3, radius: f64, height: f64) -> Self {
        let half = 0.5 * height;
        let ball = Ball::new(frame, base + axis * half, (radius * radius + half * half).sqrt());
        let reach = (radius * frame.scale()) as f32 * (1.0 + MARGIN);
        Self { ball, axis: axis.to_array().map(|x| x as f32), reach }
    }
}

impl Cull for Bar {
    #[inline(always)]
    fn may_hit<S: Simd>(&self, simd: S, group: &Group) -> u32 {
        let in_ball = self.ball.may_hit(simd, group);
        if in_ball == 0 {
            return 0;
        }
        let to_center = sub(splat(simd, self.ball.center), load(simd, &group.origin));
        let across = cross(load(simd, &group.direction), splat(simd, self.axis));
        let distance = dot(to_center, across).abs();
        let length = dot(across, across).sqrt();
        let reach = length * f32x8::splat(simd, self.reach) + f32x8::splat(simd, MARGIN);
        in_ball & distance.simd_le(reach).to_bitmask() as u32
    }
}

/// An axis-aligned box.
pub struct Block {
    low: [f32; 3],
    high: [f32; 3],
}

impl Block {
    /// Around a box of the world.
    #[inline(always)]
    pub fn new(frame: &Frame, bounds: &Aabb) -> Self {
        let narrow = frame.narrow(bounds);
        Self { low: narrow.low, high: narrow.high }
    }
}

impl Cull for Block {
    #[inline(always)]
    fn may_hit<S: Simd>(&self, simd: S, group: &Group) -> u32 {
        // All lanes of a packet have directions of the same signs.
        let (mut near, mut far) = (self.low, self.high);
        for axis in 0..3 {
            if group.direction[axis][0].is_sign_negative() {
                (near[axis], far[axis]) = (far[axis], near[axis]);
            }
        }
        group.meets(simd, near, far).to_bitmask() as u32
    }
}

/// A shape of which only its world box is known, and that it is a bar: around an axis, within a radius of it.
pub struct Boxed {
    block: Block,
    bar: Option<Bar>,
}

impl Boxed {
    /// A shape in a box.
    #[inline(always)]
    pub fn new(frame: &Frame, bounds: &Aabb, spine: Option<&Spine>) -> Self {
        let bar = spine.map(|spine| Bar {
            ball: Ball::new(frame, spine.point, spine.reach),
            axis: spine.axis.to_array().map(|x| x as f32),
            reach: (spine.radius * frame.scale()) as f32 * (1.0 + MARGIN),
        });
        Self { block: Block::new(frame, bounds), bar }
    }
}

impl Cull for Boxed {
    #[inline(always)]
    fn may_hit<S: Simd>(&self, simd: S, group: &Group) -> u32 {
        let in_block = self.block.may_hit(simd, group);
        match &self.bar {
            Some(bar) if in_block != 0 => in_block & bar.may_hit(simd, group),
            Some(_) | None => in_block,
        }
    }
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

/// A triangle, after Möller and Trumbore, 'Fast, minimum storage ray/triangle intersection', 1997, without the
/// division and with margins.
pub struct Corner {
    point: [f32; 3],
    edges: [[f32; 3]; 2],
    normal: [f32; 3],
    margin: f32,
    margin_of_t: f32,
    grazing: f32,
}

impl Corner {
    /// The triangle with these corners in the world.
    #[inline(always)]
    pub fn new(frame: &Frame, corners: &[Vec3; 3]) -> Self {
        let edge = |i: usize| (corners[i] - corners[0]) * frame.scale();
        let (first, second) = (edge(1), edge(2));
        let normal = first.cross(second);
        let narrow = |v: Vec3| v.to_array().map(|x| x as f32);
        let length = normal.length() as f32;
        Self {
            point: frame.point(corners[0]),
            edges: [narrow(first), narrow(second)],
            normal: narrow(normal),
            margin: MARGIN * (first.length() + second.length()) as f32,
            margin_of_t: MARGIN * length,
            grazing: MARGIN * length,
        }
    }
}

impl Cull for Corner {
    #[inline(always)]
    fn may_hit<S: Simd>(&self, simd: S, group: &Group) -> u32 {
        let number = |x: f32| f32x8::splat(simd, x);
        let direction = load(simd, &group.direction);
        let to_point = sub(splat(simd, self.point), load(simd, &group.origin));
        let normal = splat(simd, self.normal);
        let turned = cross(to_point, direction);
        let volume = dot(normal, direction);
        let size = volume.abs();
        // The sign of the volume, brought to the others.
        let signed = |x: f32x8<S>| x * number(1.0).copysign(volume);
        let u = signed(dot(turned, splat(simd, self.edges[1])));
        let v = signed(-dot(turned, splat(simd, self.edges[0])));
        let t = signed(dot(normal, to_point));
        let margin = number(self.margin);
        let inside = u.simd_ge(-margin) & v.simd_ge(-margin) & (u + v).simd_le(size + margin);
        let bound = f32x8::load_array_ref(simd, &group.bound);
        let margin_of_t = number(self.margin_of_t);
        let in_time = t.simd_ge(-margin_of_t) & t.simd_le(bound * size + margin_of_t);
        // Where the ray runs along the plane, the sign of the volume may be wrong.
        let grazing = size.simd_le(number(self.grazing));
        let alive = bound.simd_ge(number(0.0));
        (((inside & in_time) | grazing) & alive).to_bitmask() as u32
    }
}

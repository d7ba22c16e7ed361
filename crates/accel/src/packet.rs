//! Rays that travel together: groups of sixteen, one ray a lane, up to eight groups a packet.
//!
//! All rays of a packet have directions of the same signs, so that they meet the planes of any box in one order.
//! A lane without a ray, or whose ray has ended, has a bound below 0, which no box test passes.

use crate::clip::SLACK;
use crate::clip::TINY;
use crate::clip::largest;
use crate::narrow::Frame;
use crate::narrow::NarrowRay;
use crate::narrow::bound_in_frame;
use crate::query::Queries;
use crate::simd::Simd;
use crate::simd::f32x8;
use crate::simd::f32x16;
use crate::simd::f64x8;
use crate::simd::mask32x16;
use crate::simd::prelude::*;

/// Rays in a group.
pub const LANES: usize = 16;

/// Groups in a packet.
pub const GROUPS: usize = 8;

/// Some rays of a packet.
#[derive(Clone, Copy, Debug)]
pub struct Members {
    /// The lanes of each group, bit by bit.
    pub lanes: [u16; GROUPS],
    /// The groups that have any, bit by bit.
    pub groups: u32,
    /// How many rays there are.
    pub count: u32,
}

impl Members {
    /// No ray.
    pub const NONE: Self = Self { lanes: [0; GROUPS], groups: 0, count: 0 };

    #[inline(always)]
    fn add(&mut self, group: usize, lanes: u64) {
        self.lanes[group] = lanes as u16;
        self.groups |= u32::from(lanes != 0) << group;
        self.count += lanes.count_ones();
    }
}

/// The bound of a lane that looks for nothing.
const ENDED: f32 = -1.0;

/// Sixteen rays, a lane each; single precision is in the frame of [`Frame`], t' counts from where each ray enters the
/// scene.
#[derive(Clone, Copy, Debug)]
#[repr(C, align(64))]
pub struct Group {
    /// The reciprocals of the directions.
    pub inverse: [[f32; LANES]; 3],
    /// The same, larger by the relative slack: for exits.
    pub inverse_far: [[f32; LANES]; 3],
    /// The padded origins times the reciprocals, for entries.
    pub near_offset: [[f32; LANES]; 3],
    /// The same for exits.
    pub far_offset: [[f32; LANES]; 3],
    /// Where the rays enter the scene, rounded to nearest.
    pub origin: [[f32; LANES]; 3],
    /// Their directions, rounded to nearest.
    pub direction: [[f32; LANES]; 3],
    /// The t' up to which boxes count; below 0 where the lane has ended.
    pub bound: [f32; LANES],
    /// The t up to which hits count, in double precision.
    pub t_max: [f64; LANES],
    start: [f64; LANES],
    slack: [f64; LANES],
    /// The rays' numbers in the batch.
    pub rays: [u32; LANES],
}

impl Group {
    /// No ray in any lane.
    pub const EMPTY: Self = Self {
        inverse: [[1.0; LANES]; 3],
        inverse_far: [[1.0; LANES]; 3],
        near_offset: [[0.0; LANES]; 3],
        far_offset: [[0.0; LANES]; 3],
        origin: [[0.0; LANES]; 3],
        direction: [[1.0; LANES]; 3],
        bound: [ENDED; LANES],
        t_max: [f64::NEG_INFINITY; LANES],
        start: [0.0; LANES],
        slack: [0.0; LANES],
        rays: [0; LANES],
    };

    /// One to sixteen rays of the batch, by their numbers; those that miss the scene have ended from the start.
    #[inline(always)]
    pub(crate) fn of<S: Simd>(simd: S, frame: &Frame, queries: &Queries<'_>, rays: &[u32]) -> Self {
        WideRays::gather(queries, rays).narrow(simd, frame)
    }

    /// The ray of a lane, by itself.
    #[inline(always)]
    pub(crate) fn ray(&self, frame: &Frame, lane: usize) -> NarrowRay {
        let lane = lane % LANES;
        let of = |lanes: &[[f32; LANES]; 3]| [lanes[0][lane], lanes[1][lane], lanes[2][lane]];
        let inverse = of(&self.inverse);
        NarrowRay {
            origin: of(&self.origin),
            direction: of(&self.direction),
            bound: self.bound[lane],
            inverse,
            inverse_far: of(&self.inverse_far),
            near_offset: of(&self.near_offset),
            far_offset: of(&self.far_offset),
            far_side: [
                usize::from(inverse[0] > 0.0),
                usize::from(inverse[1] > 0.0),
                usize::from(inverse[2] > 0.0),
            ],
            start: self.start[lane],
            scale: frame.scale(),
            slack: self.slack[lane],
            widening: frame.widening(),
        }
    }

    /// The largest absolute error of any ray.
    #[inline(always)]
    fn most_slack(&self) -> f64 {
        let mut most = [0.0; 4];
        for slack in self.slack.chunks_exact(most.len()) {
            (0..most.len()).for_each(|lane| most[lane] = f64::max(most[lane], slack[lane]));
        }
        most.into_iter().fold(0.0, f64::max)
    }

    /// Which lanes still look for something, bit by bit.
    #[inline(always)]
    pub fn alive(&self) -> u32 {
        (0..LANES).map(|lane| u32::from(self.bound[lane] >= 0.0) << lane).sum()
    }

    /// Which lanes meet the box with these near and far planes.
    #[inline(always)]
    pub fn meets<S: Simd>(&self, simd: S, near: [f32; 3], far: [f32; 3]) -> mask32x16<S> {
        let load = |lanes: &[f32; LANES]| f32x16::load_array_ref(simd, lanes);
        let enter = |axis: usize| {
            f32x16::splat(simd, near[axis]).mul_sub(load(&self.inverse[axis]), load(&self.near_offset[axis]))
        };
        let leave = |axis: usize| {
            f32x16::splat(simd, far[axis])
                .mul_sub(load(&self.inverse_far[axis]), load(&self.far_offset[axis]))
        };
        let enter = enter(0).max(enter(1)).max(enter(2).max(f32x16::splat(simd, 0.0)));
        let leave = leave(0).min(leave(1)).min(leave(2).min(load(&self.bound)));
        enter.simd_le(leave)
    }
}

/// As many lanes are computed at once in double precision.
const HALF: usize = 8;

/// Sixteen rays in double precision, a lane each.
#[repr(C, align(64))]
struct WideRays {
    origin: [[f64; LANES]; 3],
    direction: [[f64; LANES]; 3],
    t_min: [f64; LANES],
    t_max: [f64; LANES],
    rays: [u32; LANES],
}

impl WideRays {
    /// The rays of these numbers, one to sixteen; lanes without a ray hold the first one, which has ended.
    #[inline(always)]
    fn gather(queries: &Queries<'_>, rays: &[u32]) -> Self {
        let mut wide = Self {
            origin: [[0.0; LANES]; 3],
            direction: [[0.0; LANES]; 3],
            t_min: [0.0; LANES],
            t_max: [f64::NEG_INFINITY; LANES],
            rays: [0; LANES],
        };
        for lane in 0..LANES {
            let number = *rays.get(lane).unwrap_or(&rays[0]);
            let query = queries.query(number as usize);
            for axis in 0..3 {
                wide.origin[axis][lane] = query.ray.origin[axis];
                wide.direction[axis][lane] = query.ray.direction[axis];
            }
            wide.rays[lane] = number;
            if lane < rays.len() {
                (wide.t_min[lane], wide.t_max[lane]) = (query.t_min, query.t_max);
            }
        }
        wide
    }

    /// The rays cut to the scene and in single precision: [`crate::clip`] and [`crate::narrow`] give the reasons.
    #[inline(always)]
    fn narrow<S: Simd>(&self, simd: S, frame: &Frame) -> Group {
        let mut group = Group { rays: self.rays, ..Group::EMPTY };
        for first in (0..LANES).step_by(HALF) {
            self.narrow_half(simd, frame, first, &mut group);
        }
        group
    }

    /// The lanes from `first` on.
    #[inline(always)]
    fn narrow_half<S: Simd>(&self, simd: S, frame: &Frame, first: usize, group: &mut Group) {
        let number = |x: f64| f64x8::splat(simd, x);
        let lanes = first..first + HALF;
        let load = |all: &[f64; LANES]| f64x8::from_slice(simd, &all[first..first + HALF]);
        let scene = frame.scene();
        let (low, high, center) = (scene.min.to_array(), scene.max.to_array(), frame.center());
        let (relative, absolute) = frame.slack_shares();
        let origin = [load(&self.origin[0]), load(&self.origin[1]), load(&self.origin[2])];
        let reach = origin[0].abs().max(origin[1].abs()).max(origin[2].abs());
        let slack = (reach + number(largest(scene.min).max(largest(scene.max)))) * number(SLACK);
        let t_max = load(&self.t_max);
        let (mut start, mut end) = (load(&self.t_min), t_max);
        let mut inverse = [number(1.0); 3];
        let mut direction = inverse;
        for axis in 0..3 {
            let d = load(&self.direction[axis]);
            let tiny = number(TINY);
            let d = d.abs().simd_lt(tiny).select(tiny.copysign(d), d);
            let v = number(1.0) / d;
            let a = (number(low[axis]) - slack - origin[axis]) * v;
            let b = (number(high[axis]) + slack - origin[axis]) * v;
            start = start.max(a.min(b));
            end = end.min(a.max(b));
            (direction[axis], inverse[axis]) = (d, v);
        }
        let widening = frame.widening();
        let scale = number(frame.scale());
        let store = |all: &mut [f32; LANES], x: f64x8<S>| {
            all[first..first + HALF].copy_from_slice(&singles(simd, x));
        };
        for axis in 0..3 {
            let place = (origin[axis] - number(center[axis]) + start * direction[axis]) * scale;
            let pad = place.abs() * number(relative) + slack * number(absolute) * scale;
            let pad = pad.copysign(inverse[axis]);
            let inverse_far = inverse[axis] * number(widening);
            store(&mut group.inverse[axis], inverse[axis]);
            store(&mut group.inverse_far[axis], inverse_far);
            store(&mut group.near_offset[axis], finite(simd, (place + pad) * inverse[axis], number(MAX)));
            store(&mut group.far_offset[axis], finite(simd, (place - pad) * inverse_far, number(-MAX)));
            store(&mut group.origin[axis], place);
            store(&mut group.direction[axis], direction[axis]);
        }
        let slack = slack * number(absolute);
        // Where the rays lie in the scene; never so in a lane without a ray, whose end is -inf.
        let inside = start.simd_le(end).to_bitmask();
        let bound = (t_max - start + slack) * scale * number(widening);
        let bound = singles(simd, finite(simd, bound, number(f64::INFINITY)));
        for lane in lanes.clone() {
            let met = inside >> (lane - first) & 1 == 1;
            group.bound[lane] = if met { bound[lane - first].next_up() } else { ENDED };
            group.t_max[lane] = if met { self.t_max[lane] } else { f64::NEG_INFINITY };
        }
        group.start[lanes.clone()].copy_from_slice(&start.to_array());
        group.slack[lanes].copy_from_slice(&slack.to_array());
    }
}

/// The largest single.
const MAX: f64 = f32::MAX as f64;

/// `x` cut to what a single can hold, and `widest` where it is not a number.
#[inline(always)]
fn finite<S: Simd>(simd: S, x: f64x8<S>, widest: f64x8<S>) -> f64x8<S> {
    let x = x.simd_eq(x).select(x, widest);
    x.max(f64x8::splat(simd, -MAX)).min(f64x8::splat(simd, MAX))
}

/// Each lane as a single, rounded to nearest.
#[inline(always)]
fn singles<S: Simd>(simd: S, lanes: f64x8<S>) -> [f32; HALF] {
    let (low, high) = simd.split_f64x8(lanes);
    simd.narrow_f64x4(low, high).to_array()
}

/// Up to [`GROUPS`] groups.
#[derive(Clone, Debug)]
pub struct Packet {
    groups: Vec<Group>,
    count: usize,
    frame: Frame,
}

impl Packet {
    /// A packet without rays.
    pub fn new(frame: &Frame) -> Self {
        Self { groups: Vec::with_capacity(GROUPS), count: 0, frame: *frame }
    }

    /// Empties it.
    pub fn clear(&mut self) {
        self.groups.clear();
        self.count = 0;
    }

    /// Where its single precision measures from.
    #[inline(always)]
    pub fn frame(&self) -> &Frame {
        &self.frame
    }

    /// How many rays there are.
    pub fn count(&self) -> usize {
        self.count
    }

    /// Adds up to sixteen rays of the batch as one group. Rays that miss the scene have ended from the start.
    ///
    /// The signs of all directions must be those of the first ray.
    #[inline(always)]
    pub fn push<S: Simd>(&mut self, simd: S, queries: &Queries<'_>, rays: &[u32]) {
        self.groups.push(Group::of(simd, &self.frame, queries, rays));
        self.count += rays.len();
    }

    /// The groups that hold rays.
    #[inline(always)]
    pub fn groups(&self) -> &[Group] {
        &self.groups
    }

    /// One group.
    #[inline(always)]
    pub fn group(&self, group: usize) -> &Group {
        &self.groups[group]
    }

    /// Takes a ray's new upper bound of t: nearer, or `f64::NEG_INFINITY` where it has ended.
    #[inline(always)]
    pub fn set_t_max(&mut self, group: usize, lane: usize, t_max: f64) {
        let (scale, widening) = (self.frame.scale(), self.frame.widening());
        let group = &mut self.groups[group];
        let lane = lane % LANES;
        group.t_max[lane] = t_max;
        group.bound[lane] = if t_max == f64::NEG_INFINITY {
            ENDED
        } else {
            bound_in_frame(t_max, group.start[lane], group.slack[lane], scale, widening)
        };
    }

    /// Which lanes of the groups `active` meet the box with these near and far planes.
    #[inline(always)]
    pub fn meets<S: Simd>(&self, simd: S, active: u32, near: [f32; 3], far: [f32; 3]) -> Members {
        let mut met = Members::NONE;
        let mut left = active;
        while left != 0 {
            let group = left.trailing_zeros() as usize % GROUPS;
            left &= left - 1;
            met.add(group, self.group(group).meets(simd, near, far).to_bitmask());
        }
        met
    }

    /// Which lanes still look for something, and the largest bound of any.
    #[inline(always)]
    pub fn alive<S: Simd>(&self, simd: S) -> (Members, f32) {
        let mut alive = Members::NONE;
        let mut largest = f32x16::splat(simd, ENDED);
        for (number, group) in self.groups().iter().enumerate() {
            let bound = f32x16::load_array_ref(simd, &group.bound);
            alive.add(number % GROUPS, bound.simd_ge(f32x16::splat(simd, 0.0)).to_bitmask());
            largest = largest.max(bound);
        }
        (alive, most_of(simd, largest))
    }
}

/// The least of all lanes.
#[inline(always)]
fn least_of<S: Simd>(simd: S, lanes: f32x16<S>) -> f32 {
    let (low, high) = simd.split_f32x16(lanes);
    let (low, high) = simd.split_f32x8(low.min(high));
    low.min(high).to_array().into_iter().fold(f32::INFINITY, f32::min)
}

/// The most of all lanes.
#[inline(always)]
fn most_of<S: Simd>(simd: S, lanes: f32x16<S>) -> f32 {
    let (low, high) = simd.split_f32x16(lanes);
    let (low, high) = simd.split_f32x8(low.max(high));
    low.max(high).to_array().into_iter().fold(f32::NEG_INFINITY, f32::max)
}

/// All rays of a packet at once: where their origins and reciprocal directions lie. A box that this beam misses is
/// missed by every ray.
///
/// With x = plane - o and v in [v0, v1] of one sign, x v lies between the smaller and the larger of x v0 and x v1;
/// the pads of the single rays are in o, and v1 is the widened reciprocal, so the bound of [`crate::narrow`] holds.
#[derive(Clone, Copy, Debug)]
pub struct Beam {
    near_origin: [f32; 3],
    far_origin: [f32; 3],
    inverse: [[f32; 2]; 3],
    /// Which side of a box the rays leave through: 0 the low one, 1 the high one.
    pub far_side: [usize; 3],
}

impl Beam {
    /// Around all rays that have been pushed.
    #[inline(always)]
    pub fn around<S: Simd>(simd: S, packet: &Packet) -> Self {
        let slack = packet.groups.iter().map(Group::most_slack).fold(0.0, f64::max);
        let all = |x| f32x16::splat(simd, x);
        let (mut low, mut high, mut inverse) = ([0.0; 3], [0.0; 3], [[0.0; 2]; 3]);
        for axis in 0..3 {
            let (mut least, mut most) = (all(f32::INFINITY), all(f32::NEG_INFINITY));
            let (mut slowest, mut fastest) = (least, most);
            for group in &packet.groups {
                let load = |lanes: &[[f32; LANES]; 3]| f32x16::load_array_ref(simd, &lanes[axis]);
                let (origin, v, v_far) =
                    (load(&group.origin), load(&group.inverse), load(&group.inverse_far));
                least = least.min(origin);
                most = most.max(origin);
                slowest = slowest.min(v.min(v_far));
                fastest = fastest.max(v.max(v_far));
            }
            let (least, most) = (least_of(simd, least), most_of(simd, most));
            let pad = packet.frame.pad(least.abs().max(most.abs()), slack);
            low[axis] = (least - pad).next_down();
            high[axis] = (most + pad).next_up();
            inverse[axis] = [least_of(simd, slowest), most_of(simd, fastest)];
        }
        let (mut near_origin, mut far_origin, mut far_side) = ([0.0; 3], [0.0; 3], [0; 3]);
        for axis in 0..3 {
            far_side[axis] = usize::from(inverse[axis][0] > 0.0);
            let (near, far) = if far_side[axis] == 1 { (high, low) } else { (low, high) };
            near_origin[axis] = near[axis];
            far_origin[axis] = far[axis];
        }
        Self { near_origin, far_origin, inverse, far_side }
    }

    /// Which of eight boxes (by their planes) any ray may meet before `bound`, and where the first may enter.
    #[inline(always)]
    pub fn meets<S: Simd>(&self, simd: S, planes: &[[[f32; 8]; 2]; 3], bound: f32) -> (u32, [f32; 8]) {
        let splat = |x| f32x8::splat(simd, x);
        let mut enter = splat(0.0);
        let mut leave = splat(bound);
        for axis in 0..3 {
            let far_side = self.far_side[axis] & 1;
            let near =
                f32x8::load_array_ref(simd, &planes[axis][far_side ^ 1]) - splat(self.near_origin[axis]);
            let far = f32x8::load_array_ref(simd, &planes[axis][far_side]) - splat(self.far_origin[axis]);
            let (v0, v1) = (splat(self.inverse[axis][0]), splat(self.inverse[axis][1]));
            enter = enter.max((near * v0).min(near * v1));
            leave = leave.min((far * v0).max(far * v1));
        }
        // Rounding of `plane - o` and of the products is relative: 3 u, less than the widened reciprocal gives to
        // the exits but not to the entries of v0, so those are made smaller.
        let enter = enter * splat(1.0 - 1.0 / (1 << 20) as f32);
        (enter.simd_le(leave).to_bitmask() as u32, enter.to_array())
    }
}

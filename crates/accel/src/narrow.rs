//! Double precision made single so that nothing is lost: boxes rounded outward, rays with a derived slack.
//!
//! Single precision only rules boxes out. It may show a caller an item in vain; it may never hide one.
//!
//! **The frame.** Boxes are stored relative to the centre of the scene and scaled by a power of two, such that the
//! largest half edge of the scene lies in [½, 1]. So every scene uses single precision alike, whether its
//! coordinates are 1e-30 or 1e30 or lie around a point far from the origin. Powers of two scale without rounding;
//! the subtraction of the centre rounds by 2^-53 of a coordinate, which [`crate::clip`]'s slack covers many times.
//!
//! **The ray** is advanced in double precision to where it enters the scene, so that a far origin costs nothing:
//! the single-precision t' counts from there, in the frame's unit, and the origin o lies in or next to the scene.
//!
//! **The bound.** u = 2^-24 is half a unit in the last place. For one axis, let `near` be a box's plane (a stored
//! single, exact), v the reciprocal of the direction and p a pad on the origin's side away from the box, o' = o ± p.
//! We compute `near * v' - q`, where v' = v (1 + a) and q = o' v (1 + b) are rounded from double, |a|, |b| <= u.
//! With or without a fused multiply and add this is, for some |c|, |d| <= u,
//!
//! ```text
//! [near v (1 + a)(1 + c) - o' v (1 + b)] (1 + d) = v [(near - o') (1 + e) + f]
//! |e| <= 3.1 u         |f| <= 3.1 u |o'|
//! ```
//!
//! since |near| <= |near - o'| + |o'|. The term f is a displacement of the plane, and the pad
//! `p = 8 u |o| + slack` exceeds it (3.1 u |o'| <= 3.2 u |o| + slack / 2), so planes are never displaced inward.
//! The term e is relative: an entry is computed as at most (1 + 3.1 u) times the true one, an exit as at least
//! (1 - 3.1 u) times. The exits' reciprocals and the bound are therefore made larger by 8 u, more than twice
//! 3.1 u. All this
//! holds for true values >= 0, which are all that count: entries are cut at 0, the start of the ray, and a box
//! whose exit is truly negative lies behind it.
//!
//! **No NaN.** Components of the direction are at least 2^-80, so v' is finite and not 0; q is cut to the largest
//! finite single. The planes of an absent box are infinite (near +inf, far -inf, whatever the sign), and
//! inf * v' - q is infinite with the right sign. So `min` and `max` never see a NaN, about which x86 and NEON differ.

use crate::clip::largest;
use dotray_geometry::Aabb;
use dotray_geometry::Vec3;

/// Eight half units in the last place of a single, relative: 2^-21.
const EIGHT_U: f64 = 1.0 / (1_u32 << 21) as f64;

/// How much is given away so that nothing is lost; only tests choose anything but [`Slack::DERIVED`].
#[derive(Clone, Copy, Debug)]
pub struct Slack {
    /// The pad, as a share of the origin's coordinates, and the widening of exits.
    relative: f64,
    /// The share of the double-precision slack.
    absolute: f64,
    /// Whether boxes are rounded outward, or to nearest.
    outward: bool,
}

impl Slack {
    /// What the bound above asks for.
    pub const DERIVED: Self = Self { relative: EIGHT_U, absolute: 1.0, outward: true };

    /// None at all: the control that shows that tests can fail.
    #[cfg(test)]
    pub const NONE: Self = Self { relative: 0.0, absolute: 0.0, outward: false };
}

/// A box in the frame, in single precision.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct NarrowBox {
    /// The smallest coordinates, rounded down.
    pub low: [f32; 3],
    /// The largest coordinates, rounded up.
    pub high: [f32; 3],
}

/// Where single precision measures from, and in which unit.
#[derive(Clone, Copy, Debug)]
pub struct Frame {
    scene: Aabb,
    center: Vec3,
    scale: f64,
    slack: Slack,
}

impl Frame {
    /// The frame of a scene with this box.
    pub fn around(scene: Aabb) -> Self {
        // Halved before they are combined, so that not even the largest doubles overflow.
        let (low, high) = (scene.min * 0.5, scene.max * 0.5);
        let half = largest(high - low).max(f64::MIN_POSITIVE);
        // A power of two: its exponent negated, the mantissa cleared; 2^±1000 at most.
        let exponent = ((half.to_bits() >> 52) as i64 - 1023).clamp(-1000, 1000);
        let scale = f64::from_bits(((1023 - exponent - 1) as u64) << 52);
        Self { scene, center: low + high, scale, slack: Slack::DERIVED }
    }

    /// The same frame with another slack.
    #[cfg(test)]
    pub fn with_slack(self, slack: Slack) -> Self {
        Self { slack, ..self }
    }

    /// The scene's box.
    pub fn scene(&self) -> &Aabb {
        &self.scene
    }

    /// A box of the world, rounded outward.
    pub fn narrow(&self, bounds: &Aabb) -> NarrowBox {
        let low = ((bounds.min - self.center) * self.scale).to_array();
        let high = ((bounds.max - self.center) * self.scale).to_array();
        if self.slack.outward {
            NarrowBox {
                low: [round_down(low[0]), round_down(low[1]), round_down(low[2])],
                high: [round_up(high[0]), round_up(high[1]), round_up(high[2])],
            }
        } else {
            NarrowBox { low: low.map(|x| x as f32), high: high.map(|x| x as f32) }
        }
    }

    /// The box of the world that a narrow one stands for: the one that was narrowed, with what rounding added.
    pub fn widen(&self, bounds: &NarrowBox) -> Aabb {
        let corner = |point: [f32; 3]| self.center + Vec3::from_array(point.map(f64::from)) / self.scale;
        Aabb::new(corner(bounds.low), corner(bounds.high))
    }

    /// How long one unit of the world is in the frame.
    pub fn scale(&self) -> f64 {
        self.scale
    }

    /// A point of the world, rounded to nearest.
    #[inline(always)]
    pub fn point(&self, point: Vec3) -> [f32; 3] {
        let point = (point - self.center) * self.scale;
        [point.x as f32, point.y as f32, point.z as f32]
    }

    /// The point of the world that the frame measures from.
    pub(crate) fn center(&self) -> [f64; 3] {
        self.center.to_array()
    }

    /// The shares of the relative and of the absolute slack.
    pub(crate) fn slack_shares(&self) -> (f64, f64) {
        (self.slack.relative, self.slack.absolute)
    }

    /// The factor that makes exits larger.
    pub(crate) fn widening(&self) -> f64 {
        1.0 + self.slack.relative
    }

    /// The pad of a ray's origin along an axis, at least.
    pub(crate) fn pad(&self, origin: f32, slack: f64) -> f32 {
        let pad =
            2.0 * self.slack.relative * f64::from(origin.abs()) + slack * self.slack.absolute * self.scale;
        (pad as f32).next_up()
    }
}

/// A ray in the frame, in single precision, ready for the test of eight boxes.
#[derive(Clone, Copy, Debug)]
pub struct NarrowRay {
    /// Where it enters the scene, rounded to nearest.
    pub origin: [f32; 3],
    /// Its direction, rounded to nearest.
    pub direction: [f32; 3],
    /// The t' up to which boxes count.
    pub bound: f32,
    /// The reciprocals of the direction.
    pub inverse: [f32; 3],
    /// The same, larger by the relative slack: for exits.
    pub inverse_far: [f32; 3],
    /// The padded origin times the reciprocal, for entries.
    pub near_offset: [f32; 3],
    /// The same for exits.
    pub far_offset: [f32; 3],
    /// Which side of a box the ray leaves through: 0 the low one, 1 the high one.
    pub far_side: [usize; 3],
    pub(crate) start: f64,
    pub(crate) scale: f64,
    pub(crate) slack: f64,
    pub(crate) widening: f64,
}

impl NarrowRay {
    /// The t' up to which boxes count where the nearest hit lies at `t_max` in the world.
    #[inline(always)]
    pub fn bound_at(&self, t_max: f64) -> f32 {
        bound_in_frame(t_max, self.start, self.slack, self.scale, self.widening)
    }

    /// Takes the t of the nearest hit.
    #[inline(always)]
    pub fn set_bound(&mut self, t_max: f64) {
        self.bound = self.bound_at(t_max);
    }
}

/// See [`NarrowRay::bound_at`].
#[inline(always)]
pub fn bound_in_frame(t_max: f64, start: f64, slack: f64, scale: f64, widening: f64) -> f32 {
    let t = (t_max - start + slack) * scale * widening;
    // A NaN, from infinities on both sides, rules nothing out.
    if t.is_nan() { f32::INFINITY } else { (t as f32).next_up() }
}

/// A single that is not above `x`: two below the largest such at most. Rounding to nearest moves a number by less than
/// 2^-23 of itself, or than the least normal single; both are taken off before, which is quicker than a look whether
/// it went up.
#[inline(always)]
fn round_down(x: f64) -> f32 {
    let below = x - (x.abs() * (1.0 / (1_u32 << 23) as f64) + f64::from(f32::MIN_POSITIVE));
    (below as f32).min(f32::MAX)
}

/// A single that is not below `x`.
#[inline(always)]
fn round_up(x: f64) -> f32 {
    -round_down(-x)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn rounding_goes_outward() {
        for x in [0.0, 1.0, 0.1, -0.1, 1e-60, -1e-60, 1.0 + 1e-12, -1.0 - 1e-12, 1e60, -1e60] {
            assert!(f64::from(round_down(x)) <= x && x <= f64::from(round_up(x)), "{x}");
        }
        assert!(
            round_down(0.5) >= 0.5_f32.next_down().next_down()
                && round_up(0.5) <= 0.5_f32.next_up().next_up()
        );
    }

    #[test]
    fn every_scene_fills_the_frame_alike() {
        for size in [1e-300, 1e-30, 1.0, 3.0, 1e30, 1e300] {
            for center in [0.0, size * 1e6] {
                let scene = Aabb::new(Vec3::splat(center - size), Vec3::splat(center + size));
                let narrow = Frame::around(scene).narrow(&scene);
                assert!(narrow.high[0] >= 0.5 && narrow.high[0] <= 1.001, "{size} {center} {narrow:?}");
                assert!(narrow.low[0] <= -0.5 && narrow.low[0] >= -1.001, "{size} {center} {narrow:?}");
            }
        }
    }
}

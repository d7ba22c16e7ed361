//! What the round shapes (sphere, cylinder, cone) share.

use crate::aabb::Aabb;
use crate::aabb::image_magnitude;
use crate::hit::Crossings;
use crate::hit::Hit;
use crate::hit::Texcoord;
use crate::vector::{Affine, Vec2, Vec3};

/// The face number of the curved side.
pub(super) const SIDE: u8 = 0;
/// The face number of the upper disc.
pub(super) const TOP: u8 = 1;
/// The face number of the lower disc.
pub(super) const BOTTOM: u8 = 2;

/// The part of a line between two hits, whose parameters may be infinite.
#[derive(Clone, Copy, Debug)]
pub(super) struct Interval {
    pub enter: Hit,
    pub leave: Hit,
}

impl Interval {
    /// The whole line.
    pub const ALL: Self = Self::on_side(f64::NEG_INFINITY, f64::INFINITY);

    /// The part between two points of the curved side.
    #[inline]
    pub const fn on_side(enter: f64, leave: f64) -> Self {
        Self { enter: Hit { t: enter, face: SIDE }, leave: Hit { t: leave, face: SIDE } }
    }

    /// The part of a line between two planes: `y` is its coordinate at t = 0 and grows by `dy` for each unit of t;
    /// the planes stand at `low` and `high`, with their face numbers.
    #[inline]
    pub fn between_planes(y: f64, dy: f64, low: (f64, u8), high: (f64, u8)) -> Option<Self> {
        let meet = |plane: (f64, u8)| Hit { t: (plane.0 - y) / dy, face: plane.1 };
        if dy > 0.0 {
            Some(Self { enter: meet(low), leave: meet(high) })
        } else if dy < 0.0 {
            Some(Self { enter: meet(high), leave: meet(low) })
        } else {
            (low.0 <= y && y <= high.0).then_some(Self::ALL)
        }
    }

    /// The ends of what two intervals share.
    #[inline]
    pub fn crossings_of_both(self, other: Self) -> Crossings {
        let enter = if self.enter.t < other.enter.t { other.enter } else { self.enter };
        let leave = if other.leave.t < self.leave.t { other.leave } else { self.leave };
        Crossings::of_interval(enter, leave)
    }
}

/// Texture coordinates of the upper disc; `radial` is (x, z) relative to its centre.
#[inline]
pub(super) fn top_texcoord(radial: Vec2, radius: f64) -> Texcoord {
    Texcoord::Known(Vec2::new((radial.x / radius + 1.0) / 2.0, (radial.y / radius + 1.0) / 2.0))
}

/// Texture coordinates of the lower disc, seen from below; `radial` is (x, z) relative to its centre.
#[inline]
pub(super) fn bottom_texcoord(radial: Vec2, radius: f64) -> Texcoord {
    Texcoord::Known(Vec2::new((radial.x / radius + 1.0) / 2.0, (1.0 - radial.y / radius) / 2.0))
}

/// The nearest point of the disc about 0, for a point that rounding may have put beside it.
#[inline]
pub(super) fn within_disc(radial: Vec2, radius: f64) -> Vec2 {
    let distance = radial.length();
    if distance > radius { radial * (radius / distance) } else { radial }
}

/// How far a disc about 0 that is horizontal in object coordinates reaches along the world's axes.
#[inline]
pub(super) fn disc_extents(world_from_object: &Affine, radius: f64) -> Vec3 {
    let m = &world_from_object.matrix3;
    let extent = |row: Vec3| Vec2::new(row.x, row.z).length() * radius;
    Vec3::new(extent(m.row(0)), extent(m.row(1)), extent(m.row(2)))
}

/// The tight, padded box of a disc that is horizontal in object coordinates: an ellipse in the world, which reaches as
/// far as these extents say.
#[inline]
pub(super) fn disc_bounds(world_from_object: &Affine, center: Vec3, radius: f64, extents: Vec3) -> Aabb {
    let center_in_world = world_from_object.transform_point3(center);
    let reach = center.abs() + Vec3::splat(radius);
    Aabb::new(center_in_world - extents, center_in_world + extents)
        .padded(image_magnitude(world_from_object, reach))
}

/// A vector taken apart along a unit `axis`: its length along it, and what is perpendicular to it.
///
/// Rounding leaves a little of the axis in the second part, which does no harm: its square adds to the square of
/// the distance from the axis.
#[inline]
pub(super) fn along_and_across(v: Vec3, axis: Vec3) -> (f64, Vec3) {
    let along = v.dot(axis);
    (along, v - axis * along)
}

//! Two-step hits: [`Hit`] for every candidate, [`Surface`] only for the winner.

use crate::vector::{Vec2, Vec3};

/// Where a ray crosses a shape's surface: cheap, made for every candidate.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Hit {
    /// The ray's parameter.
    pub t: f64,
    /// Which part of the surface: the shape's own numbering (side, cap, face of a box …).
    pub face: u8,
}

/// Everything that shading wants to know of the point hit, in the shape's object coordinates.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Surface {
    /// The point, put onto the surface where that can be had for nothing.
    pub point: Vec3,
    /// The outward unit normal of the shape itself: tells enter from exit.
    pub geometric_normal: Vec3,
    /// The normal that shades: interpolated (not renormalised yet, never zero) on a triangle, elsewhere the
    /// geometric one.
    pub shading_normal: Vec3,
    /// (s, t) of SPEC 7.
    pub texcoord: Texcoord,
}

impl Surface {
    /// The unit vectors in the surface along which s and t grow fastest; `None` at a pole, which has none.
    ///
    /// Of triangles only [`Triangle::texture_axes`](crate::Triangle::texture_axes) knows them: everywhere else t grows
    /// to the right of s, seen from outside.
    pub fn texture_axes(&self) -> Option<[Vec3; 2]> {
        let normal = self.geometric_normal;
        let along_s = match self.texcoord {
            Texcoord::Around { radial, .. } => around(radial.x, radial.y)?,
            Texcoord::OnSphere(normal) => around(normal.x, normal.z)?,
            // A plane: the sides of a box turn about y; on what faces up or down, s runs along x.
            Texcoord::Known(_) if normal.y != 0.0 => Vec3::X,
            Texcoord::Known(_) => around(normal.x, normal.z)?,
        };
        Some([along_s, along_s.cross(normal)])
    }
}

/// Along a turn about the y axis, at (x, z).
fn around(x: f64, z: f64) -> Option<Vec3> {
    Vec3::new(z, 0.0, -x).try_normalize()
}

/// Texture coordinates, not worked out before somebody asks: few surfaces have a picture on them, and arc functions
/// cost more than the rest of a hit.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Texcoord {
    /// They are known.
    Known(Vec2),
    /// s turns about the y axis with this direction (x, z); t is known.
    Around {
        /// From the axis to the point.
        radial: Vec2,
        /// t
        t: f64,
    },
    /// Those of the point of a sphere with this unit normal.
    OnSphere(Vec3),
}

impl Texcoord {
    /// (s, t)
    pub fn get(self) -> Vec2 {
        match self {
            Self::Known(texcoord) => texcoord,
            Self::Around { radial, t } => Vec2::new(side_turn(radial.x, radial.y), t),
            Self::OnSphere(normal) => {
                let down = libm::acos(normal.y.clamp(-1.0, 1.0)) / std::f64::consts::PI;
                Vec2::new(side_turn(normal.x, normal.z), down)
            }
        }
    }
}

/// Texture coordinate s around the y axis: 0 and 1 at −z, ½ at +z.
fn side_turn(x: f64, z: f64) -> f64 {
    libm::atan2(x, z) / (2.0 * std::f64::consts::PI) + 0.5
}

/// The surface points that one ray meets on one shape, in ascending order of t (which may be negative):
/// at most two on a convex shape, at most four on a torus.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Crossings {
    /// Places not in use hold t = −∞, which lies in no range, so that `first_within` asks for the count only where
    /// the first two places hold no answer.
    hits: [Hit; 4],
    count: u8,
}

const UNUSED: Hit = Hit { t: f64::NEG_INFINITY, face: 0 };

impl Crossings {
    /// No crossing.
    pub const NONE: Self = Self { hits: [UNUSED; 4], count: 0 };

    /// One crossing.
    #[inline]
    pub const fn one(hit: Hit) -> Self {
        Self { hits: [hit, UNUSED, UNUSED, UNUSED], count: 1 }
    }

    /// Where the ray enters and where it leaves a convex shape; `enter.t <= leave.t`.
    #[inline]
    pub const fn two(enter: Hit, leave: Hit) -> Self {
        Self { hits: [enter, leave, UNUSED, UNUSED], count: 2 }
    }

    /// The two ends of the part of the line inside a convex shape; none where they come in the wrong order
    /// or are not finite numbers.
    #[inline]
    pub fn of_interval(enter: Hit, leave: Hit) -> Self {
        let bounded = f64::NEG_INFINITY < enter.t && leave.t < f64::INFINITY;
        if enter.t <= leave.t && bounded { Self::two(enter, leave) } else { Self::NONE }
    }

    /// The crossings, nearest first.
    #[inline]
    pub fn as_slice(&self) -> &[Hit] {
        &self.hits[..usize::from(self.count)]
    }

    /// The first one with `t_min < t <= t_max`.
    #[inline]
    pub fn first_within(&self, t_min: f64, t_max: f64) -> Option<Hit> {
        let within = |hit: &Hit| t_min < hit.t && hit.t <= t_max;
        let [first, second, rest @ ..] = self.hits;
        if within(&first) {
            return Some(first);
        }
        if within(&second) {
            return Some(second);
        }
        if self.count > 2 { rest.into_iter().find(within) } else { None }
    }

    /// Appends a crossing, the others having come in ascending order; a fifth one is passed over.
    pub(crate) fn push(&mut self, hit: Hit) {
        let last = self.as_slice().last().map_or(f64::NEG_INFINITY, |last| last.t);
        if let Some(place) = self.hits.get_mut(usize::from(self.count)) {
            *place = Hit { t: hit.t.max(last), ..hit };
            self.count += 1;
        }
    }
}

#[cfg(test)]
mod tests {
    use super::Crossings;
    use super::Hit;

    const NEAR: Hit = Hit { t: -1.0, face: 3 };
    const FAR: Hit = Hit { t: 2.0, face: 4 };

    #[test]
    fn the_first_within_lies_above_the_lower_end_and_not_above_the_upper() {
        let both = Crossings::two(NEAR, FAR);
        assert_eq!(both.as_slice(), [NEAR, FAR]);
        assert_eq!(both.first_within(-2.0, 5.0), Some(NEAR));
        assert_eq!(both.first_within(-1.0, 5.0), Some(FAR));
        assert_eq!(both.first_within(-1.0, 2.0), Some(FAR));
        assert_eq!(both.first_within(-1.0, 1.9), None);
        assert_eq!(both.first_within(2.0, f64::INFINITY), None);
    }

    #[test]
    fn four_are_found_in_their_order() {
        let mut all = Crossings::NONE;
        for t in [-1.0, 2.0, 3.0, 5.0, 7.0] {
            all.push(Hit { t, face: 0 });
        }
        let first = |t_min: f64, t_max: f64| all.first_within(t_min, t_max).map(|hit| hit.t);
        assert_eq!(all.as_slice().len(), 4);
        assert_eq!((first(-2.0, 9.0), first(-1.0, 9.0), first(2.0, 9.0)), (Some(-1.0), Some(2.0), Some(3.0)));
        assert_eq!((first(3.0, 9.0), first(3.0, 4.0), first(5.0, 9.0)), (Some(5.0), None, None));
    }

    #[test]
    fn unused_places_are_never_found() {
        assert_eq!(Crossings::NONE.first_within(f64::NEG_INFINITY, f64::INFINITY), None);
        assert!(Crossings::NONE.as_slice().is_empty());
        let one = Crossings::one(FAR);
        assert_eq!(one.as_slice(), [FAR]);
        assert_eq!(one.first_within(2.0, f64::INFINITY), None);
    }

    #[test]
    fn an_interval_is_ordered_and_finite() {
        assert_eq!(Crossings::of_interval(NEAR, FAR), Crossings::two(NEAR, FAR));
        assert_eq!(Crossings::of_interval(FAR, NEAR), Crossings::NONE);
        let at = |t| Hit { t, face: 0 };
        assert_eq!(Crossings::of_interval(NEAR, at(f64::INFINITY)), Crossings::NONE);
        assert_eq!(Crossings::of_interval(at(f64::NEG_INFINITY), FAR), Crossings::NONE);
        assert_eq!(Crossings::of_interval(at(f64::NAN), FAR), Crossings::NONE);
    }
}

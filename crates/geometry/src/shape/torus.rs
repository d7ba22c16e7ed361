//! The torus: the only shape that a line may cross four times.

use super::ShapeError;
use super::round::SIDE;
use crate::aabb::Aabb;
use crate::aabb::image_magnitude;
use crate::hit::Crossings;
use crate::hit::Hit;
use crate::hit::Surface;
use crate::hit::Texcoord;
use crate::ray::Ray;
use crate::roots::bracketed;
use crate::roots::quartic_turns;
use crate::vector::{Affine, Vec2, Vec3};
use std::f64::consts::PI;

/// A torus about y: all points at distance `tube` from the circle of radius `ring` about `center`.
///
/// With `tube` above `ring` it cuts itself; then the lens-shaped part around the axis counts as outside, which is what
/// the quartic says.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Torus {
    center: Vec3,
    tube: f64,
    ring: f64,
}

impl Torus {
    /// A torus about `center`.
    ///
    /// # Errors
    /// A radius that is not above 0; numbers that are not finite.
    pub fn new(center: Vec3, tube: f64, ring: f64) -> Result<Self, ShapeError> {
        if !center.is_finite() || !tube.is_finite() || !ring.is_finite() || !(tube + ring).is_finite() {
            return Err(ShapeError::NotFinite);
        }
        if tube <= 0.0 || ring <= 0.0 {
            return Err(ShapeError::Radius);
        }
        Ok(Self { center, tube, ring })
    }

    /// The point in the middle.
    #[inline]
    pub const fn center(&self) -> Vec3 {
        self.center
    }

    /// The radius of the tube.
    #[inline]
    pub const fn tube(&self) -> f64 {
        self.tube
    }

    /// The radius of the circle in the middle of the tube.
    #[inline]
    pub const fn ring(&self) -> f64 {
        self.ring
    }

    /// See [`super::Shape::crossings`].
    pub fn crossings(&self, ray: &Ray) -> Crossings {
        // Everything is measured from the line's point nearest to the centre and in units of the torus's own size, so
        // that neither far origins nor scale lose digits.
        let size = self.ring + self.tube;
        let speed = ray.direction.length();
        let origin = ray.origin - self.center;
        let t_nearest = -origin.dot(ray.direction) / (speed * speed);
        let line = Line {
            point: (origin + ray.direction * t_nearest) / size,
            direction: ray.direction / speed,
            ring: self.ring / size,
            tube: self.tube / size,
        };
        if !t_nearest.is_finite() || line.point.length_squared() > REACH * REACH {
            return Crossings::NONE;
        }
        let t = |s: f64| t_nearest + s * (size / speed);
        line.roots(|s| Hit { t: t(s), face: SIDE })
    }

    /// See [`super::Shape::surface`].
    pub fn surface(&self, ray: &Ray, hit: Hit) -> Surface {
        let p = ray.at(hit.t) - self.center;
        let radial = Vec2::new(p.x, p.z);
        let (distance, outward) = (radial.length(), radial.normalize_or(Vec2::X));
        let near = Vec2::new(distance - self.ring, p.y);
        let far = Vec2::new(distance + self.ring, p.y);
        // Where the torus cuts itself, the lens's points lie on the tube of the circle's far side.
        let of_lens =
            self.tube > self.ring && (far.length() - self.tube).abs() < (near.length() - self.tube).abs();
        let (ring, across) = if of_lens { (-self.ring, far) } else { (self.ring, near) };
        let across = across.normalize_or(Vec2::X);
        let point = self.center + self.point_at(outward, ring, across);
        // Inside the lens one is outside the torus.
        let out = if of_lens { -across } else { across };
        let normal = Vec3::new(outward.x * out.x, out.y, outward.y * out.x);
        let turn = 0.5 - libm::atan2(near.y, near.x) / (2.0 * PI);
        let texcoord = Texcoord::Around { radial, t: turn };
        Surface { point, geometric_normal: normal, shading_normal: normal, texcoord }
    }

    /// The point of the tube whose circle stands at `ring` along `outward`, towards `across`.
    fn point_at(&self, outward: Vec2, ring: f64, across: Vec2) -> Vec3 {
        let radius = ring + across.x * self.tube;
        Vec3::new(outward.x * radius, across.y * self.tube, outward.y * radius)
    }

    /// See [`super::Shape::bounds`].
    pub fn bounds(&self) -> Aabb {
        self.world_bounds(&Affine::IDENTITY)
    }

    /// See [`super::Shape::world_bounds`]: the torus is the sum of a circle and a ball, and so is its box, exactly.
    pub fn world_bounds(&self, world_from_object: &Affine) -> Aabb {
        let m = &world_from_object.matrix3;
        let extent = |row: Vec3| Vec2::new(row.x, row.z).length() * self.ring + row.length() * self.tube;
        let extents = Vec3::new(extent(m.row(0)), extent(m.row(1)), extent(m.row(2)));
        let center = world_from_object.transform_point3(self.center);
        let size = self.ring + self.tube;
        let reach = self.center.abs() + Vec3::new(size, self.tube, size);
        Aabb::new(center - extents, center + extents).padded(image_magnitude(world_from_object, reach))
    }
}

/// Every point of the torus lies within this distance of its centre, in units of its size.
const REACH: f64 = 1.0 + 1e-9;

/// A line in units of the torus's size, its direction of length 1 and perpendicular to its point but for rounding.
struct Line {
    point: Vec3,
    direction: Vec3,
    ring: f64,
    tube: f64,
}

impl Line {
    /// The crossings, ascending.
    ///
    /// Along the line the torus's equation is a quartic q(s). Between neighbouring turning points q is monotone and has
    /// one root where its signs differ, so none can be missed. The turning points come from q's coefficients, where
    /// small errors do no harm; the signs and roots come from q written as a product, which does not cancel even where
    /// the tube is thin.
    fn roots(&self, hit: impl Fn(f64) -> Hit) -> Crossings {
        let (turns, count) = quartic_turns(self.coefficients(), -REACH, REACH);
        let mut found = Crossings::NONE;
        let (mut low, mut value_low) = (-REACH, self.value(-REACH).0);
        for turn in turns.into_iter().take(count).chain([REACH]) {
            let value = self.value(turn).0;
            if (value_low > 0.0) != (value > 0.0) {
                let root = bracketed(|s| self.value(s), low, turn, value_low);
                found.push(hit(root));
            }
            (low, value_low) = (turn, value);
        }
        found
    }

    /// q's coefficients below that of s⁴, which is 1: those of s³, s², s, 1.
    fn coefficients(&self) -> [f64; 4] {
        let (p, d) = (self.point, self.direction);
        let g = p.dot(d);
        let k = p.length_squared() + self.ring * self.ring - self.tube * self.tube;
        let r = 4.0 * self.ring * self.ring;
        let along = d.x * d.x + d.z * d.z;
        let both = p.x * d.x + p.z * d.z;
        let across = p.x * p.x + p.z * p.z;
        [4.0 * g, 2.0 * k + 4.0 * g * g - r * along, 4.0 * g * k - 2.0 * r * both, k * k - r * across]
    }

    /// q(s) and its slope: with the distance ρ from the axis,
    /// q = ((ρ − ring)² + y² − tube²) · ((ρ + ring)² + y² − tube²).
    fn value(&self, s: f64) -> (f64, f64) {
        let p = self.point + self.direction * s;
        let d = self.direction;
        let rho = (p.x * p.x + p.z * p.z).sqrt();
        let slope_of_rho = if rho > 0.0 { (p.x * d.x + p.z * d.z) / rho } else { 0.0 };
        let factor = |from_ring: f64| {
            let distance = (from_ring * from_ring + p.y * p.y).sqrt();
            let value = (distance - self.tube) * (distance + self.tube);
            (value, 2.0 * (from_ring * slope_of_rho + p.y * d.y))
        };
        let (near, near_slope) = factor(rho - self.ring);
        let (far, far_slope) = factor(rho + self.ring);
        (near * far, near_slope * far + near * far_slope)
    }
}

#[cfg(test)]
mod tests {
    use super::PI;
    use super::Torus;
    use crate::ray::Ray;
    use crate::shape::ShapeError;
    use crate::vector::{Affine, Vec2, Vec3};
    use proptest::prelude::*;

    /// Tube 1 about a circle of radius 3.
    fn torus() -> Torus {
        Torus::new(Vec3::new(1.0, 2.0, 3.0), 1.0, 3.0).unwrap()
    }

    fn hits_of(torus: &Torus, origin: [f64; 3], direction: [f64; 3]) -> Vec<f64> {
        let ray = Ray::new(Vec3::from_array(origin), Vec3::from_array(direction));
        torus.crossings(&ray).as_slice().iter().map(|hit| hit.t).collect()
    }

    fn hits(origin: [f64; 3], direction: [f64; 3]) -> Vec<f64> {
        hits_of(&torus(), origin, direction)
    }

    fn near(found: &[f64], expected: &[f64]) {
        assert_eq!(found.len(), expected.len(), "{found:?} {expected:?}");
        for (a, b) in found.iter().zip(expected) {
            assert!((a - b).abs() < 1e-12, "{found:?} {expected:?}");
        }
    }

    #[test]
    fn meets_rays() {
        near(&hits([-9.0, 2.0, 3.0], [1.0, 0.0, 0.0]), &[6.0, 8.0, 12.0, 14.0]);
        near(&hits([-9.0, 2.0, 3.0], [2.0, 0.0, 0.0]), &[3.0, 4.0, 6.0, 7.0]);
        near(&hits([4.0, 9.0, 3.0], [0.0, -1.0, 0.0]), &[6.0, 8.0]);
        near(&hits([4.0, 2.0, 3.0], [0.0, -1.0, 0.0]), &[-1.0, 1.0]);
        near(&hits([1.0, 9.0, 3.0], [0.0, -1.0, 0.0]), &[]);
        near(&hits([3.9, 2.0, -9.0], [0.0, 0.0, 1.0]), &hits([3.9, 2.0, 15.0], [0.0, 0.0, -1.0]));
        assert!(hits([5.1, 9.0, 3.0], [0.0, -1.0, 0.0]).is_empty(), "beside");
        assert!(hits([-9.0, 3.01, 3.0], [1.0, 0.0, 0.0]).is_empty(), "above");
        assert_eq!(hits([-9.0, 2.0, 4.9], [1.0, 0.0, 0.0]).len(), 4, "just inside the hole");
        assert_eq!(hits([-9.0, 2.0, 5.1], [1.0, 0.0, 0.0]).len(), 2, "just beside the hole");
    }

    #[test]
    fn grazing_rays_meet_in_pairs_or_not_at_all() {
        for shift in [-1e-3, -1e-6, -1e-9, -1e-12, 0.0, 1e-12, 1e-9, 1e-6, 1e-3] {
            let over_the_top = hits([-9.0, 3.0 + shift, 3.0], [1.0, 0.0, 0.0]);
            let beside = hits([5.0 + shift, 2.0, -9.0], [0.0, 0.0, 1.0]);
            if shift <= -1e-9 {
                assert_eq!((over_the_top.len(), beside.len()), (4, 2), "{shift}");
            } else if shift >= 1e-9 {
                assert!(over_the_top.is_empty() && beside.is_empty(), "{shift}");
            } else {
                assert!(over_the_top.len().is_multiple_of(2) && beside.len().is_multiple_of(2), "{shift}");
            }
        }
        // Along the circle where a plane lies on top of the torus.
        assert!(hits([1.0, 3.0, 6.0], [1.0, 0.0, 0.0]).len().is_multiple_of(2));
    }

    #[test]
    fn size_does_not_matter() {
        for scale in [1e-150, 1e-6, 1e-3, 1e3, 1e6, 1e150] {
            let scaled = Torus::new(torus().center() * scale, scale, 3.0 * scale).unwrap();
            let origin = [-9.0, 2.3, 3.4].map(|x: f64| x * scale);
            let found = hits_of(&scaled, origin, [1.0, 0.01, 0.02]);
            let expected = hits([-9.0, 2.3, 3.4], [1.0, 0.01, 0.02]);
            assert_eq!((found.len(), expected.len()), (4, 4));
            for (a, b) in found.iter().zip(&expected) {
                assert!((a / scale - b).abs() < 1e-12, "{scale}: {a} {b}");
            }
        }
    }

    #[test]
    fn thin_tubes_and_far_origins_keep_their_digits() {
        let thin = Torus::new(Vec3::ZERO, 1e-7, 1.0).unwrap();
        let found = hits_of(&thin, [-2.0, 0.0, 0.0], [1.0, 0.0, 0.0]);
        let expected = [1.0 - 1e-7, 1.0 + 1e-7, 3.0 - 1e-7, 3.0 + 1e-7];
        assert_eq!(found.len(), 4);
        assert!(found.iter().zip(expected).all(|(a, b)| (a - b).abs() < 1e-15), "{found:?}");
        let far = 1_073_741_824.0;
        let found = hits([-9.0 - far, 2.0, 3.0], [1.0, 0.0, 0.0]);
        assert_eq!(found.len(), 4);
        assert!(found.iter().zip([6.0, 8.0, 12.0, 14.0]).all(|(a, b)| (a - far - b).abs() < 1e-6));
    }

    #[test]
    fn tells_bad_numbers() {
        assert_eq!(Torus::new(Vec3::ZERO, 0.0, 1.0), Err(ShapeError::Radius));
        assert_eq!(Torus::new(Vec3::ZERO, 1.0, -1.0), Err(ShapeError::Radius));
        assert_eq!(Torus::new(Vec3::ZERO, f64::NAN, 1.0), Err(ShapeError::NotFinite));
        assert_eq!(Torus::new(Vec3::ZERO, f64::MAX, f64::MAX), Err(ShapeError::NotFinite));
    }

    #[test]
    fn describes_its_surface() {
        let surface = |origin: [f64; 3], direction: [f64; 3], which: usize| {
            let ray = Ray::new(Vec3::from_array(origin), Vec3::from_array(direction));
            torus().surface(&ray, torus().crossings(&ray).as_slice()[which])
        };
        let outer = surface([9.0, 2.0, 3.0], [-1.0, 0.0, 0.0], 0);
        assert_eq!((outer.point, outer.geometric_normal), (Vec3::new(5.0, 2.0, 3.0), Vec3::X));
        assert_eq!(outer.texcoord.get(), Vec2::new(0.75, 0.5));
        let inner = surface([9.0, 2.0, 3.0], [-1.0, 0.0, 0.0], 1);
        assert!((inner.point - Vec3::new(3.0, 2.0, 3.0)).length() < 1e-14);
        assert!((inner.geometric_normal - Vec3::NEG_X).length() < 1e-14);
        let top = surface([1.0, 9.0, 6.0], [0.0, -1.0, 0.0], 0);
        assert!((top.point - Vec3::new(1.0, 3.0, 6.0)).length() < 1e-14);
        assert!((top.geometric_normal - Vec3::Y).length() < 1e-14);
        assert!((top.texcoord.get() - Vec2::new(0.5, 0.25)).length() < 1e-14);
    }

    /// The implicit function, written independently of the intersection: negative inside.
    fn implicit(torus: &Torus, p: Vec3) -> f64 {
        let p = p - torus.center();
        let (r, a) = (torus.ring(), torus.tube());
        let k = p.length_squared() + r * r - a * a;
        k * k - 4.0 * r * r * (p.x * p.x + p.z * p.z)
    }

    #[test]
    fn a_torus_that_cuts_itself_has_a_lens() {
        let torus = Torus::new(Vec3::ZERO, 2.0, 1.0).unwrap();
        near(&hits_of(&torus, [-9.0, 0.0, 0.0], [1.0, 0.0, 0.0]), &[6.0, 8.0, 10.0, 12.0]);
        let ray = Ray::new(Vec3::new(-9.0, 0.0, 0.0), Vec3::X);
        let normals: Vec<f64> = torus
            .crossings(&ray)
            .as_slice()
            .iter()
            .map(|hit| torus.surface(&ray, *hit).geometric_normal.x)
            .collect();
        near(&normals, &[-1.0, 1.0, -1.0, 1.0]);
    }

    proptest! {
        #![proptest_config(ProptestConfig::with_cases(3000))]

        #[test]
        fn agrees_with_brute_force(
            tube in 0.05..2.0f64,
            ring in 0.3..2.0f64,
            origin in prop::array::uniform3(-4.0..4.0f64),
            aim in prop::array::uniform3(-2.0..2.0f64),
        ) {
            let torus = Torus::new(Vec3::new(0.1, -0.2, 0.3), tube, ring).unwrap();
            let (origin, aim) = (Vec3::from_array(origin), Vec3::from_array(aim));
            let direction = aim - origin;
            prop_assume!(direction.length() > 1e-3);
            let ray = Ray::new(origin, direction.normalize());
            let crossings = torus.crossings(&ray);
            let found = crossings.as_slice();
            prop_assert!(found.len().is_multiple_of(2));
            prop_assert!(found.windows(2).all(|pair| pair[0].t <= pair[1].t));
            for hit in found {
                let size = tube + ring;
                prop_assert!(implicit(&torus, ray.at(hit.t)).abs() < 1e-12 * size * size * size * size);
                let surface = torus.surface(&ray, *hit);
                prop_assert!((surface.point - ray.at(hit.t)).length() < 1e-6);
                let step = surface.geometric_normal * 1e-5 * size;
                prop_assert!(implicit(&torus, surface.point + step) > -1e-9);
                prop_assert!(implicit(&torus, surface.point - step) < 1e-9);
                prop_assert!(torus.bounds().contains(surface.point));
            }
            // Between the samples the sign of the implicit function says how many crossings lie before.
            for step in 0..=4000 {
                let t = -12.0 + f64::from(step) * 0.006;
                let before = found.iter().filter(|hit| hit.t < t).count();
                let value = implicit(&torus, ray.at(t));
                if value.abs() > 1e-9 {
                    prop_assert_eq!(value < 0.0, !before.is_multiple_of(2), "at {}: {:?}", t, found);
                }
            }
        }

        #[test]
        fn boxes_under_any_map_are_tight(
            entries in prop::array::uniform9(-2.0..2.0f64),
            translation in prop::array::uniform3(-5.0..5.0f64),
        ) {
            let map = Affine::from_cols_array(&[
                entries[0], entries[1], entries[2], entries[3], entries[4], entries[5],
                entries[6], entries[7], entries[8], translation[0], translation[1], translation[2],
            ]);
            let torus = torus();
            let bounds = torus.world_bounds(&map);
            let mut reached = crate::aabb::Aabb::EMPTY;
            for i in 0..200 {
                for j in 0..100 {
                    let (u, v) = (f64::from(i) / 100.0 * PI, f64::from(j) / 50.0 * PI);
                    let outward = Vec2::new(libm::cos(u), libm::sin(u));
                    let across = Vec2::new(libm::cos(v), libm::sin(v));
                    let point = torus.center() + torus.point_at(outward, torus.ring(), across);
                    let point = map.transform_point3(point);
                    prop_assert!(bounds.contains(point));
                    reached = reached.grown(point);
                }
            }
            let slack = 0.01 * bounds.size().max_element();
            prop_assert!((bounds.size() - reached.size()).max_element() <= slack);
        }
    }
}

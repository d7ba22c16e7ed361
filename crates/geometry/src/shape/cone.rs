//! The closed cone, whole or truncated.

use super::ShapeError;
use super::round::BOTTOM;
use super::round::Interval;
use super::round::SIDE;
use super::round::TOP;
use super::round::along_and_across;
use super::round::bottom_texcoord;
use super::round::disc_bounds;
use super::round::disc_extents;
use super::round::top_texcoord;
use super::round::within_disc;
use crate::aabb::Aabb;
use crate::aabb::image_magnitude;
use crate::hit::Crossings;
use crate::hit::Hit;
use crate::hit::Surface;
use crate::hit::Texcoord;
use crate::ray::Ray;
use crate::roots::from_discriminant;
use crate::vector::{Affine, Vec2, Vec3};

/// A cone along y: apex at `center.y + height / 2`, closed by a disc of `radius` at `center.y - height / 2`; or a
/// truncated one, closed by a disc of radius `top` where the apex would be.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Cone {
    center: Vec3,
    radius: f64,
    /// 0 for a whole cone.
    top: f64,
    height: f64,
}

impl Cone {
    /// A cone about `center` (the point at half its height).
    ///
    /// # Errors
    /// A radius or height that is not above 0; numbers that are not finite.
    pub fn new(center: Vec3, radius: f64, height: f64) -> Result<Self, ShapeError> {
        Self::truncated(center, radius, 0.0, height)
    }

    /// A cone about `center` that ends in a disc of radius `top`; 0 makes a whole one, the other radius a cylinder.
    ///
    /// # Errors
    /// A radius or height that is not above 0, a `top` below 0; numbers that are not finite.
    pub fn truncated(center: Vec3, radius: f64, top: f64, height: f64) -> Result<Self, ShapeError> {
        if !center.is_finite() || !radius.is_finite() || !top.is_finite() || !height.is_finite() {
            return Err(ShapeError::NotFinite);
        }
        if radius <= 0.0 || top < 0.0 {
            return Err(ShapeError::Radius);
        }
        if height <= 0.0 {
            return Err(ShapeError::Height);
        }
        Ok(Self { center, radius, top, height })
    }

    /// The point on the axis at half the height.
    #[inline]
    pub const fn center(&self) -> Vec3 {
        self.center
    }

    /// The radius of the disc.
    #[inline]
    pub const fn radius(&self) -> f64 {
        self.radius
    }

    /// The radius of the upper disc; 0 where there is an apex.
    #[inline]
    pub const fn top(&self) -> f64 {
        self.top
    }

    /// The greater one of the two radii.
    #[inline]
    pub const fn widest(&self) -> f64 {
        self.radius.max(self.top)
    }

    /// The distance from the disc to the apex, or to the upper disc.
    #[inline]
    pub const fn height(&self) -> f64 {
        self.height
    }

    /// See [`super::Shape::crossings`].
    #[inline]
    pub fn crossings(&self, ray: &Ray) -> Crossings {
        let origin = ray.origin - self.center;
        let across = |v: Vec3| Vec3::new(v.x, 0.0, v.z);
        if self.top > 0.0 {
            let (y, dy) = (origin.y + self.height * 0.5, ray.direction.y);
            let line =
                LineFromBase { y, dy, across: across(origin), direction_across: across(ray.direction) };
            return line.crossings(self.radius, self.top, self.height);
        }
        let line = LineFromApex {
            y: origin.y - self.height * 0.5,
            dy: ray.direction.y,
            across: across(origin),
            direction_across: across(ray.direction),
        };
        line.crossings(self.radius, self.height)
    }

    /// See [`super::Shape::surface`].
    pub fn surface(&self, ray: &Ray, hit: Hit) -> Surface {
        let p = ray.at(hit.t) - self.center;
        let (radial, half) = (Vec2::new(p.x, p.z), self.height * 0.5);
        let (radial, y, normal, texcoord) = match hit.face {
            BOTTOM => {
                let radial = within_disc(radial, self.radius);
                (radial, -half, Vec3::NEG_Y, bottom_texcoord(radial, self.radius))
            }
            TOP => {
                let radial = within_disc(radial, self.top);
                (radial, half, Vec3::Y, top_texcoord(radial, self.top))
            }
            _side => {
                // The nearest point of the side, as a fraction of the way from its upper end to the base.
                let (r, h) = (self.radius - self.top, self.height);
                let fraction = ((radial.length() - self.top) * r + (half - p.y) * h) / (r * r + h * h);
                let fraction = fraction.clamp(0.0, 1.0);
                let outward = radial.normalize_or_zero();
                let normal = side_normal(Vec3::new(outward.x, 0.0, outward.y), Vec3::Y, r, h);
                let texcoord = Texcoord::Around { radial, t: fraction };
                (outward * (self.top + r * fraction), half - h * fraction, normal, texcoord)
            }
        };
        let point = self.center + Vec3::new(radial.x, y, radial.y);
        Surface { point, geometric_normal: normal, shading_normal: normal, texcoord }
    }

    /// See [`super::Shape::bounds`].
    pub fn bounds(&self) -> Aabb {
        self.world_bounds(&Affine::IDENTITY)
    }

    /// See [`super::Shape::world_bounds`]: the cone is the hull of its disc and its apex, or of its two discs.
    pub fn world_bounds(&self, world_from_object: &Affine) -> Aabb {
        let half = Vec3::Y * (self.height * 0.5);
        let disc = |center, radius| {
            disc_bounds(world_from_object, center, radius, disc_extents(world_from_object, radius))
        };
        let lower = disc(self.center - half, self.radius);
        if self.top > 0.0 {
            return lower.union(disc(self.center + half, self.top));
        }
        let apex = self.center + half;
        let apex_in_world = world_from_object.transform_point3(apex);
        Aabb::new(apex_in_world, apex_in_world)
            .padded(image_magnitude(world_from_object, self.center.abs() + half))
            .union(lower)
    }
}

/// A closed cone anywhere in the world: what a [`Cone`] becomes under a similarity, so that a ray meets it
/// without being transformed.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct OrientedCone {
    base: Vec3,
    axis: Vec3,
    radius: f64,
    top: f64,
    height: f64,
}

impl OrientedCone {
    /// The cone in the world, where `world_from_object` is a similarity that multiplies lengths by `scale`
    /// ([`crate::Transform::similarity_scale`]).
    pub fn from_object(cone: &Cone, world_from_object: &Affine, scale: f64) -> Self {
        let base = cone.center - Vec3::Y * (cone.height * 0.5);
        Self {
            base: world_from_object.transform_point3(base),
            axis: world_from_object.transform_vector3(Vec3::Y).normalize_or(Vec3::Y),
            radius: cone.radius * scale,
            top: cone.top * scale,
            height: cone.height * scale,
        }
    }

    /// The centre of the disc.
    #[inline]
    pub const fn base(&self) -> Vec3 {
        self.base
    }

    /// The unit vector from the disc to the other end.
    #[inline]
    pub const fn axis(&self) -> Vec3 {
        self.axis
    }

    /// The greater one of the radii of its ends.
    #[inline]
    pub const fn widest(&self) -> f64 {
        self.radius.max(self.top)
    }

    /// The distance of its ends.
    #[inline]
    pub const fn height(&self) -> f64 {
        self.height
    }

    /// Every crossing of the ray's whole line with the surface, with [`Cone`]'s face numbers.
    #[inline]
    pub fn crossings(&self, ray: &Ray) -> Crossings {
        let (above_base, across) = along_and_across(ray.origin - self.base, self.axis);
        let (dy, direction_across) = along_and_across(ray.direction, self.axis);
        if self.top > 0.0 {
            let line = LineFromBase { y: above_base, dy, across, direction_across };
            return line.crossings(self.radius, self.top, self.height);
        }
        let line = LineFromApex { y: above_base - self.height, dy, across, direction_across };
        line.crossings(self.radius, self.height)
    }

    /// The outward unit normal where the ray makes the hit.
    pub fn normal(&self, ray: &Ray, hit: Hit) -> Vec3 {
        match hit.face {
            BOTTOM => -self.axis,
            TOP => self.axis,
            _side => {
                let (_, across) = along_and_across(ray.at(hit.t) - self.base, self.axis);
                side_normal(across.normalize_or_zero(), self.axis, self.radius - self.top, self.height)
            }
        }
    }
}

/// The normal of the side whose horizontal part points `outward`; up at the apex, where `outward` is zero.
fn side_normal(outward: Vec3, axis: Vec3, radius: f64, height: f64) -> Vec3 {
    if outward == Vec3::ZERO {
        return axis;
    }
    (outward * height + axis * radius) / (height * height + radius * radius).sqrt()
}

/// A line relative to the apex of a cone: along the axis (upwards) and perpendicular to it.
#[derive(Clone, Copy)]
struct LineFromApex {
    y: f64,
    dy: f64,
    across: Vec3,
    direction_across: Vec3,
}

impl LineFromApex {
    /// Where the line crosses the closed cone.
    #[inline]
    fn crossings(&self, radius: f64, height: f64) -> Crossings {
        // The plane of the apex cuts off the mirrored upper nappe; where rounding lets it be the end of the
        // interval, that end lies at the apex, a point of the side.
        let Some(planes) = Interval::between_planes(self.y, self.dy, (-height, BOTTOM), (0.0, SIDE)) else {
            return Crossings::NONE;
        };
        // Coordinates are taken from the line's point nearest to the apex, so that far origins lose nothing.
        let (along, across) = (self.dy, self.direction_across);
        let length_squared = along * along + across.length_squared();
        let t_nearest = -(self.y * along + self.across.dot(across)) / length_squared;
        let nearest =
            Self { y: self.y + along * t_nearest, across: self.across + across * t_nearest, ..*self };
        let slope = radius / height;
        let (y, dy) = (slope * nearest.y, slope * nearest.dy);
        inside_nappe(nearest.across, nearest.direction_across, y, dy).map_or(
            Crossings::NONE,
            |(enter, leave)| {
                planes.crossings_of_both(Interval::on_side(t_nearest + enter, t_nearest + leave))
            },
        )
    }
}

/// A line relative to the lower disc of a truncated cone: along the axis (upwards) and perpendicular to it.
#[derive(Clone, Copy)]
struct LineFromBase {
    y: f64,
    dy: f64,
    across: Vec3,
    direction_across: Vec3,
}

impl LineFromBase {
    /// Where the line crosses the closed truncated cone. All radii between the planes are above 0, so the planes cut
    /// off the mirrored nappe.
    #[inline]
    fn crossings(&self, radius: f64, top: f64, height: f64) -> Crossings {
        let Some(planes) = Interval::between_planes(self.y, self.dy, (0.0, BOTTOM), (height, TOP)) else {
            return Crossings::NONE;
        };
        // Coordinates are taken from the line's point nearest to the middle, so that far origins lose nothing.
        let (along, across) = (self.dy, self.direction_across);
        let length_squared = along * along + across.length_squared();
        let t_nearest = -((self.y - height * 0.5) * along + self.across.dot(across)) / length_squared;
        let (y, p) = (self.y + along * t_nearest, self.across + across * t_nearest);
        let slope = (top - radius) / height;
        let (radius_there, growth) = (radius + slope * y, slope * along);
        if across == Vec3::ZERO && growth == 0.0 {
            // Along the axis of a cylinder.
            let inside = p.length_squared() <= radius * radius;
            return if inside { planes.crossings_of_both(Interval::ALL) } else { Crossings::NONE };
        }
        inside_nappe(p, across, -radius_there, -growth).map_or(Crossings::NONE, |(enter, leave)| {
            planes.crossings_of_both(Interval::on_side(t_nearest + enter, t_nearest + leave))
        })
    }
}

/// The part of a line inside the infinite cone whose radius is −`y` where the line is at t = 0, `p` away from the axis,
/// and falls by `dy` for each unit of t, which moves the line by `d` across the axis.
///
/// A point lies on the double cone where |p|² − y² = 0, a quadratic in t. With a > 0 the line is
/// flatter than the side and its part inside lies between the roots, on either nappe; with a < 0 it is
/// steeper, meets each nappe once, and is inside the lower one from its lower root down; with a = 0 it is
/// parallel to a straight line of the side and one root is gone. With a near 0 that root is merely far away,
/// and either case gives the same near one.
#[inline]
fn inside_nappe(p: Vec3, d: Vec3, y: f64, dy: f64) -> Option<(f64, f64)> {
    let a = d.length_squared() - dy * dy;
    let h = p.dot(d) - y * dy;
    let c = p.length_squared() - y * y;
    // h² − ac written with the line's moment p × d about the apex (Lagrange's identity), of which nothing
    // cancels for lines near the apex.
    let discriminant = (d * y - p * dy).length_squared() - p.cross(d).length_squared();
    if a > 0.0 {
        if discriminant >= 0.0 {
            let (small, large) = from_discriminant(a, h, c, discriminant);
            return Some(if small <= large { (small, large) } else { (large, small) });
        }
        return None;
    }
    let descends = dy < 0.0;
    if a < 0.0 {
        // A steep line meets both nappes: less than 0 is rounding.
        let (small, large) = from_discriminant(a, h, c, discriminant.max(0.0));
        return Some(if descends {
            (if small <= large { large } else { small }, f64::INFINITY)
        } else {
            (f64::NEG_INFINITY, if small <= large { small } else { large })
        });
    }
    // A line in the tangent plane touches the side at most.
    let root = -c / (2.0 * h);
    (h != 0.0).then_some(if h < 0.0 { (root, f64::INFINITY) } else { (f64::NEG_INFINITY, root) })
}

#[cfg(test)]
mod tests {
    use super::Cone;
    use super::OrientedCone;
    use crate::ray::Ray;
    use crate::shape::ShapeError;
    use crate::shape::round::{BOTTOM, SIDE, TOP};
    use crate::vector::{Affine, Vec2, Vec3};

    /// Apex at (1, 4, 3), base at y = 0, a slope of 1/2.
    fn cone() -> Cone {
        Cone::new(Vec3::new(1.0, 2.0, 3.0), 2.0, 4.0).unwrap()
    }

    fn hits(origin: [f64; 3], direction: [f64; 3]) -> Vec<(f64, u8)> {
        let ray = Ray::new(Vec3::from_array(origin), Vec3::from_array(direction));
        let oriented = OrientedCone::from_object(&cone(), &Affine::IDENTITY, 1.0);
        let hits = cone().crossings(&ray);
        assert_eq!(oriented.crossings(&ray), hits);
        hits.as_slice().iter().map(|hit| (hit.t, hit.face)).collect()
    }

    #[test]
    fn meets_rays() {
        assert_eq!(hits([-4.0, 2.0, 3.0], [1.0, 0.0, 0.0]), [(4.0, SIDE), (6.0, SIDE)]);
        assert_eq!(hits([1.0, 2.0, 3.0], [0.0, 0.0, 0.5]), [(-2.0, SIDE), (2.0, SIDE)], "from inside");
        assert_eq!(hits([-4.0, 2.0, 4.0], [1.0, 0.0, 0.0]), [(5.0, SIDE), (5.0, SIDE)], "tangent");
        assert_eq!(hits([-4.0, 0.0, 3.0], [1.0, 0.0, 0.0]), [(3.0, SIDE), (7.0, SIDE)], "in the base");
        assert!(hits([-4.0, 2.0, 4.1], [1.0, 0.0, 0.0]).is_empty(), "beside");
        assert!(hits([-4.0, 5.0, 3.0], [1.0, 0.0, 0.0]).is_empty(), "the mirrored nappe");
        assert!(hits([-4.0, 7.0, 3.0], [1.0, -0.3, 0.0]).is_empty(), "slanting through the mirrored nappe");
        assert!(hits([-4.0, -0.1, 3.0], [1.0, 0.0, 0.0]).is_empty(), "below");
        assert_eq!(hits([-1.0, -1.0, 3.0], [1.0, 1.0, 0.0]), [(1.0, BOTTOM), (3.0, SIDE)]);
    }

    #[test]
    fn meets_steep_rays() {
        assert_eq!(hits([1.0, 9.0, 3.0], [0.0, -1.0, 0.0]), [(5.0, SIDE), (9.0, BOTTOM)], "down the axis");
        assert_eq!(hits([1.0, -2.0, 3.0], [0.0, 2.0, 0.0]), [(1.0, BOTTOM), (3.0, SIDE)], "up the axis");
        assert_eq!(hits([2.0, 9.0, 3.0], [0.0, -1.0, 0.0]), [(7.0, SIDE), (9.0, BOTTOM)], "parallel to it");
        assert_eq!(
            hits([0.0, 8.0, 3.0], [0.25, -1.0, 0.0]),
            [(4.0, SIDE), (8.0, BOTTOM)],
            "through the apex"
        );
        assert!(hits([3.5, 9.0, 3.0], [0.0, -1.0, 0.0]).is_empty());
        assert!(hits([3.1, 9.0, 3.0], [0.0, 1.0, 0.0]).is_empty());
    }

    #[test]
    fn meets_rays_parallel_to_its_side() {
        // The generator through (3, 0, 3) runs along (0.5, −1, 0); this line lies 1 to its left.
        assert_eq!(hits([0.0, 4.0, 3.0], [0.5, -1.0, 0.0]), [(1.0, SIDE), (4.0, BOTTOM)]);
        assert_eq!(hits([2.0, 0.0, 3.0], [-0.5, 1.0, 0.0]), [(0.0, BOTTOM), (3.0, SIDE)]);
        assert!(hits([2.0, 4.0, 3.0], [0.5, -1.0, 0.0]).is_empty(), "on the outside");
        // Near to parallel on either side of it, the answer moves by little.
        for slant in [-1e-9, -1e-12, -1e-15, 1e-16, 1e-14, 1e-11] {
            let near = hits([0.0, 4.0, 3.0], [0.5 + slant, -1.0, 0.0]);
            assert!((near[0].0 - 1.0).abs() < 1e-8 && near[0].1 == SIDE, "{slant}");
            assert_eq!(near[1], (4.0, BOTTOM), "{slant}");
        }
    }

    #[test]
    fn far_origins_lose_nothing() {
        // Both distances are exact in binary, so only the arithmetic of the cone can lose digits.
        let far = 1_073_741_824.0;
        for (start, direction, expected) in [
            ([0.0, 4.0, 3.0], [0.5, -1.0, 0.0], [1.0, 4.0]),
            ([1.0, 2.0, 3.0], [1.0, 0.0, 0.0], [-1.0, 1.0]),
            ([0.5, 2.0, 3.0], [0.25, -1.0, 0.0], [-2.0 / 3.0, 2.0]),
        ] {
            let [dx, dy, dz] = direction;
            let found = hits([start[0] - far * dx, start[1] - far * dy, start[2] - far * dz], direction);
            assert!((found[0].0 - far - expected[0]).abs() < 1e-6, "{found:?} {expected:?}");
            assert!((found[1].0 - far - expected[1]).abs() < 1e-6, "{found:?} {expected:?}");
        }
    }

    /// Discs of radius 2 at y = 0 and 1 at y = 4, about (1, y, 3).
    fn truncated() -> Cone {
        Cone::truncated(Vec3::new(1.0, 2.0, 3.0), 2.0, 1.0, 4.0).unwrap()
    }

    fn truncated_hits(shape: &Cone, origin: [f64; 3], direction: [f64; 3]) -> Vec<(f64, u8)> {
        let ray = Ray::new(Vec3::from_array(origin), Vec3::from_array(direction));
        let oriented = OrientedCone::from_object(shape, &Affine::IDENTITY, 1.0);
        let hits = shape.crossings(&ray);
        assert_eq!(oriented.crossings(&ray), hits);
        hits.as_slice().iter().map(|hit| (hit.t, hit.face)).collect()
    }

    #[test]
    fn truncated_cones_meet_rays() {
        let hits = |origin, direction| truncated_hits(&truncated(), origin, direction);
        assert_eq!(hits([-4.0, 2.0, 3.0], [1.0, 0.0, 0.0]), [(3.5, SIDE), (6.5, SIDE)]);
        assert_eq!(hits([1.0, 9.0, 3.0], [0.0, -1.0, 0.0]), [(5.0, TOP), (9.0, BOTTOM)]);
        assert_eq!(hits([2.5, 9.0, 3.0], [0.0, -1.0, 0.0]), [(7.0, SIDE), (9.0, BOTTOM)]);
        assert_eq!(hits([1.5, -9.0, 3.0], [0.0, 1.0, 0.0]), [(9.0, BOTTOM), (13.0, TOP)]);
        assert!(hits([-4.0, 4.1, 3.0], [1.0, 0.0, 0.0]).is_empty(), "above");
        assert!(hits([1.0, 12.0, -9.0], [0.0, 0.0, 1.0]).is_empty(), "the mirrored nappe");
        // The same upside down: the ray through the mirrored point meets it alike.
        let turned = Cone::truncated(Vec3::new(1.0, 2.0, 3.0), 1.0, 2.0, 4.0).unwrap();
        for (origin, direction) in
            [([-4.0, 0.5, 3.1], [1.0, 0.25, 0.0]), ([2.0, 9.0, 3.5], [-0.2, -1.0, 0.1])]
        {
            let mirrored = truncated_hits(
                &turned,
                [origin[0], 4.0 - origin[1], origin[2]],
                [direction[0], -direction[1], direction[2]],
            );
            let upright = hits(origin, direction);
            assert_eq!(upright.len(), 2);
            for (a, b) in upright.iter().zip(&mirrored) {
                assert!(
                    (a.0 - b.0).abs() < 1e-12 && (a.1 == SIDE) == (b.1 == SIDE),
                    "{upright:?} {mirrored:?}"
                );
            }
        }
    }

    #[test]
    fn a_truncated_cone_of_equal_radii_is_a_cylinder() {
        let middle = Vec3::new(1.0, 2.0, 3.0);
        let cylinder = crate::shape::Cylinder::new(middle, 2.0, 4.0).unwrap();
        for slant in [0.0, 1e-15, -1e-12, 1e-9] {
            let cone = Cone::truncated(middle, 2.0, 2.0 + slant, 4.0).unwrap();
            for (origin, direction) in [
                ([-4.0, 1.5, 3.1], [1.0, 0.25, 0.0]),
                ([1.5, 9.0, 3.5], [0.0, -1.0, 0.0]),
                ([1.0, -9.0, 3.0], [0.01, 1.0, -0.02]),
                ([9.0, 9.0, 9.0], [-1.0, -0.9, -0.8]),
            ] {
                let ray = Ray::new(Vec3::from_array(origin), Vec3::from_array(direction).normalize());
                let (found, expected) = (cone.crossings(&ray), cylinder.crossings(&ray));
                assert_eq!(found.as_slice().len(), 2);
                for (a, b) in found.as_slice().iter().zip(expected.as_slice()) {
                    assert!((a.t - b.t).abs() < 1e-8 && a.face == b.face, "{slant}: {found:?} {expected:?}");
                }
            }
        }
    }

    #[test]
    fn describes_the_surface_of_a_truncated_cone() {
        let surface = |origin: [f64; 3], direction: [f64; 3]| {
            let ray = Ray::new(Vec3::from_array(origin), Vec3::from_array(direction));
            let hit = truncated().crossings(&ray).as_slice()[0];
            let oriented = OrientedCone::from_object(&truncated(), &Affine::IDENTITY, 1.0);
            let surface = truncated().surface(&ray, hit);
            assert!((oriented.normal(&ray, hit) - surface.geometric_normal).length() < 1e-15);
            surface
        };
        let side = surface([9.0, 2.0, 3.0], [-1.0, 0.0, 0.0]);
        assert_eq!(side.point, Vec3::new(2.5, 2.0, 3.0));
        assert!((side.geometric_normal - Vec3::new(4.0, 1.0, 0.0) / 17f64.sqrt()).length() < 1e-15);
        assert_eq!(side.texcoord.get(), Vec2::new(0.75, 0.5));
        let top = surface([1.5, 9.0, 3.0], [0.0, -1.0, 0.0]);
        assert_eq!((top.point, top.geometric_normal), (Vec3::new(1.5, 4.0, 3.0), Vec3::Y));
        assert_eq!(top.texcoord.get(), Vec2::new(0.75, 0.5));
        let bounds = truncated().bounds();
        assert!((bounds.max - Vec3::new(3.0, 4.0, 5.0)).length() < 1e-9);
        assert!((bounds.min - Vec3::new(-1.0, 0.0, 1.0)).length() < 1e-9);
    }

    #[test]
    fn tells_bad_numbers() {
        assert_eq!(Cone::new(Vec3::ZERO, 0.0, 1.0), Err(ShapeError::Radius));
        assert_eq!(Cone::new(Vec3::ZERO, -1.0, 1.0), Err(ShapeError::Radius));
        assert_eq!(Cone::new(Vec3::ZERO, 1.0, 0.0), Err(ShapeError::Height));
        assert_eq!(Cone::new(Vec3::ZERO, f64::NAN, 1.0), Err(ShapeError::NotFinite));
        assert_eq!(Cone::truncated(Vec3::ZERO, 1.0, -1.0, 1.0), Err(ShapeError::Radius));
        assert_eq!(Cone::truncated(Vec3::ZERO, 1.0, f64::INFINITY, 1.0), Err(ShapeError::NotFinite));
    }

    #[test]
    fn describes_its_surface() {
        let surface = |origin: [f64; 3], direction: [f64; 3]| {
            let ray = Ray::new(Vec3::from_array(origin), Vec3::from_array(direction));
            let hit = cone().crossings(&ray).as_slice()[0];
            let oriented = OrientedCone::from_object(&cone(), &Affine::IDENTITY, 1.0);
            let surface = cone().surface(&ray, hit);
            assert!((oriented.normal(&ray, hit) - surface.geometric_normal).length() < 1e-15);
            surface
        };
        let right = surface([9.0, 1.0, 3.0], [-1.0, 0.0, 0.0]);
        assert_eq!(right.point, Vec3::new(2.5, 1.0, 3.0));
        assert!((right.geometric_normal - Vec3::new(2.0, 1.0, 0.0) / 5f64.sqrt()).length() < 1e-15);
        assert_eq!(right.texcoord.get(), Vec2::new(0.75, 0.75));
        let base = surface([2.0, -9.0, 2.0], [0.0, 1.0, 0.0]);
        assert_eq!((base.point, base.geometric_normal), (Vec3::new(2.0, 0.0, 2.0), Vec3::NEG_Y));
        assert_eq!(base.texcoord.get(), Vec2::new(0.75, 0.75));
        let apex = surface([1.0, 9.0, 3.0], [0.0, -1.0, 0.0]);
        assert_eq!((apex.point, apex.geometric_normal), (Vec3::new(1.0, 4.0, 3.0), Vec3::Y));
        assert_eq!(apex.texcoord.get(), Vec2::new(0.5, 0.0));
    }
}

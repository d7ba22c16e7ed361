//! The closed cylinder.

use super::ShapeError;
use super::round::BOTTOM;
use super::round::Interval;
use super::round::TOP;
use super::round::along_and_across;
use super::round::bottom_texcoord;
use super::round::disc_bounds;
use super::round::disc_extents;
use super::round::top_texcoord;
use super::round::within_disc;
use crate::aabb::Aabb;
use crate::hit::Crossings;
use crate::hit::Hit;
use crate::hit::Surface;
use crate::hit::Texcoord;
use crate::ray::Ray;
use crate::vector::{Affine, Vec2, Vec3};

/// A cylinder along y, closed by two discs at `center.y ± height / 2`.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Cylinder {
    center: Vec3,
    radius: f64,
    height: f64,
}

impl Cylinder {
    /// A cylinder about `center`.
    ///
    /// # Errors
    /// A radius or height that is not above 0; numbers that are not finite.
    pub fn new(center: Vec3, radius: f64, height: f64) -> Result<Self, ShapeError> {
        if !center.is_finite() || !radius.is_finite() || !height.is_finite() {
            return Err(ShapeError::NotFinite);
        }
        if radius <= 0.0 {
            return Err(ShapeError::Radius);
        }
        if height <= 0.0 {
            return Err(ShapeError::Height);
        }
        Ok(Self { center, radius, height })
    }

    /// The point on the axis at half the height.
    #[inline]
    pub const fn center(&self) -> Vec3 {
        self.center
    }

    /// The radius.
    #[inline]
    pub const fn radius(&self) -> f64 {
        self.radius
    }

    /// The distance of the two discs.
    #[inline]
    pub const fn height(&self) -> f64 {
        self.height
    }

    /// See [`super::Shape::crossings`].
    #[inline]
    pub fn crossings(&self, ray: &Ray) -> Crossings {
        let origin = ray.origin - self.center;
        let half = self.height * 0.5;
        Interval::between_planes(origin.y, ray.direction.y, (-half, BOTTOM), (half, TOP)).map_or(
            Crossings::NONE,
            |planes| {
                let across = |v: Vec3| Vec3::new(v.x, 0.0, v.z);
                cut_by_side(planes, across(origin), across(ray.direction), self.radius)
            },
        )
    }

    /// See [`super::Shape::surface`].
    pub fn surface(&self, ray: &Ray, hit: Hit) -> Surface {
        let p = ray.at(hit.t) - self.center;
        let (radial, half) = (Vec2::new(p.x, p.z), self.height * 0.5);
        let (radial, y, normal, texcoord) = match hit.face {
            TOP => {
                let radial = within_disc(radial, self.radius);
                (radial, half, Vec3::Y, top_texcoord(radial, self.radius))
            }
            BOTTOM => {
                let radial = within_disc(radial, self.radius);
                (radial, -half, Vec3::NEG_Y, bottom_texcoord(radial, self.radius))
            }
            _side => {
                let outward = radial.normalize_or(Vec2::X);
                let y = p.y.clamp(-half, half);
                let texcoord = Texcoord::Around { radial, t: (half - y) / self.height };
                (outward * self.radius, y, Vec3::new(outward.x, 0.0, outward.y), texcoord)
            }
        };
        let point = self.center + Vec3::new(radial.x, y, radial.y);
        Surface { point, geometric_normal: normal, shading_normal: normal, texcoord }
    }

    /// See [`super::Shape::bounds`].
    pub fn bounds(&self) -> Aabb {
        self.world_bounds(&Affine::IDENTITY)
    }

    /// See [`super::Shape::world_bounds`]: the cylinder is the hull of its two discs.
    pub fn world_bounds(&self, world_from_object: &Affine) -> Aabb {
        let half = Vec3::Y * (self.height * 0.5);
        let extents = disc_extents(world_from_object, self.radius);
        let disc = |center| disc_bounds(world_from_object, center, self.radius, extents);
        disc(self.center - half).union(disc(self.center + half))
    }
}

/// A closed cylinder anywhere in the world: what a [`Cylinder`] becomes under a similarity, so that a ray meets it
/// without being transformed.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct OrientedCylinder {
    base: Vec3,
    axis: Vec3,
    radius: f64,
    height: f64,
}

impl OrientedCylinder {
    /// The cylinder in the world, where `world_from_object` is a similarity that multiplies lengths by `scale`
    /// ([`crate::Transform::similarity_scale`]).
    pub fn from_object(cylinder: &Cylinder, world_from_object: &Affine, scale: f64) -> Self {
        let base = cylinder.center - Vec3::Y * (cylinder.height * 0.5);
        Self {
            base: world_from_object.transform_point3(base),
            axis: world_from_object.transform_vector3(Vec3::Y).normalize_or(Vec3::Y),
            radius: cylinder.radius * scale,
            height: cylinder.height * scale,
        }
    }

    /// The centre of the lower disc.
    #[inline]
    pub const fn base(&self) -> Vec3 {
        self.base
    }

    /// The unit vector from the lower disc to the upper.
    #[inline]
    pub const fn axis(&self) -> Vec3 {
        self.axis
    }

    /// The radius.
    #[inline]
    pub const fn radius(&self) -> f64 {
        self.radius
    }

    /// The distance of the two discs.
    #[inline]
    pub const fn height(&self) -> f64 {
        self.height
    }

    /// Every crossing of the ray's whole line with the surface, with [`Cylinder`]'s face numbers.
    #[inline]
    pub fn crossings(&self, ray: &Ray) -> Crossings {
        let (y, across) = along_and_across(ray.origin - self.base, self.axis);
        let (dy, direction_across) = along_and_across(ray.direction, self.axis);
        Interval::between_planes(y, dy, (0.0, BOTTOM), (self.height, TOP))
            .map_or(Crossings::NONE, |planes| cut_by_side(planes, across, direction_across, self.radius))
    }

    /// The outward unit normal where the ray makes the hit.
    pub fn normal(&self, ray: &Ray, hit: Hit) -> Vec3 {
        match hit.face {
            TOP => self.axis,
            BOTTOM => -self.axis,
            _side => {
                let (_, across) = along_and_across(ray.at(hit.t) - self.base, self.axis);
                across.normalize_or(self.axis.any_orthonormal_vector())
            }
        }
    }
}

/// Below this square a direction counts as parallel to the axis: its digits end where f64's range does, and no
/// cylinder is long enough to tell.
const PARALLEL: f64 = 1e-200;

/// The part between the planes that also lies within `radius` of the axis; `origin` and `direction` are the
/// ray's parts perpendicular to it. As for the sphere, the line's nearest point to the axis decides.
#[inline]
fn cut_by_side(planes: Interval, origin: Vec3, direction: Vec3, radius: f64) -> Crossings {
    let length_squared = direction.length_squared();
    if length_squared <= PARALLEL {
        let inside = origin.length_squared() <= radius * radius;
        return if inside { planes.crossings_of_both(Interval::ALL) } else { Crossings::NONE };
    }
    let per_length_squared = 1.0 / length_squared;
    let t_nearest = -origin.dot(direction) * per_length_squared;
    let nearest = origin + direction * t_nearest;
    let depth = radius * radius - nearest.length_squared();
    if depth >= 0.0 {
        let half = (depth * per_length_squared).sqrt();
        planes.crossings_of_both(Interval::on_side(t_nearest - half, t_nearest + half))
    } else {
        Crossings::NONE
    }
}

#[cfg(test)]
mod tests {
    use super::Cylinder;
    use super::OrientedCylinder;
    use crate::ray::Ray;
    use crate::shape::ShapeError;
    use crate::shape::round::{BOTTOM, SIDE, TOP};
    use crate::vector::{Affine, Vec2, Vec3};

    fn cylinder() -> Cylinder {
        Cylinder::new(Vec3::new(1.0, 2.0, 3.0), 2.0, 6.0).unwrap()
    }

    fn hits(origin: [f64; 3], direction: [f64; 3]) -> Vec<(f64, u8)> {
        let ray = Ray::new(Vec3::from_array(origin), Vec3::from_array(direction));
        let oriented = OrientedCylinder::from_object(&cylinder(), &Affine::IDENTITY, 1.0);
        let hits = cylinder().crossings(&ray);
        assert_eq!(oriented.crossings(&ray), hits);
        hits.as_slice().iter().map(|hit| (hit.t, hit.face)).collect()
    }

    #[test]
    fn meets_rays() {
        assert_eq!(hits([-4.0, 2.0, 3.0], [1.0, 0.0, 0.0]), [(3.0, SIDE), (7.0, SIDE)]);
        assert_eq!(hits([1.0, 2.0, 3.0], [0.0, 0.0, 0.5]), [(-4.0, SIDE), (4.0, SIDE)], "from inside");
        assert_eq!(hits([-4.0, 2.0, 5.0], [1.0, 0.0, 0.0]), [(5.0, SIDE), (5.0, SIDE)], "tangent");
        assert_eq!(hits([-4.0, 5.0, 3.0], [1.0, 0.0, 0.0]).len(), 2, "in the plane of a disc");
        assert!(hits([-4.0, 2.0, 5.1], [1.0, 0.0, 0.0]).is_empty(), "beside");
        assert!(hits([-4.0, 5.1, 3.0], [1.0, 0.0, 0.0]).is_empty(), "above");
        assert!(hits([-4.0, 4.0, 3.0], [1.0, 2.0, 0.0]).is_empty(), "passes above the rim");
        assert_eq!(hits([-1.0, 9.0, 3.0], [1.0, -2.0, 0.0]), [(2.0, TOP), (4.0, SIDE)]);
    }

    #[test]
    fn meets_rays_along_its_axis() {
        assert_eq!(hits([1.5, 9.0, 3.0], [0.0, -1.0, 0.0]), [(4.0, TOP), (10.0, BOTTOM)]);
        assert_eq!(hits([1.5, 2.0, 3.0], [0.0, 2.0, 0.0]), [(-1.5, BOTTOM), (1.5, TOP)], "from inside");
        assert_eq!(hits([3.0, 9.0, 3.0], [0.0, -1.0, 0.0]).len(), 2, "along the side");
        assert!(hits([3.1, 9.0, 3.0], [0.0, -1.0, 0.0]).is_empty());
        // So slanted that squares vanish, or nearly.
        for slant in [1e-30, 1e-90, 1e-110, 1e-160, 1e-310] {
            assert_eq!(hits([1.5, 9.0, 3.0], [slant, -1.0, slant]), [(4.0, TOP), (10.0, BOTTOM)], "{slant}");
            assert!(hits([3.1, 9.0, 3.0], [slant, -1.0, slant]).is_empty(), "{slant}");
        }
    }

    #[test]
    fn tells_bad_numbers() {
        assert_eq!(Cylinder::new(Vec3::ZERO, 0.0, 1.0), Err(ShapeError::Radius));
        assert_eq!(Cylinder::new(Vec3::ZERO, 1.0, 0.0), Err(ShapeError::Height));
        assert_eq!(Cylinder::new(Vec3::ZERO, 1.0, -1.0), Err(ShapeError::Height));
        assert_eq!(Cylinder::new(Vec3::ZERO, 1.0, f64::INFINITY), Err(ShapeError::NotFinite));
        assert_eq!(Cylinder::new(Vec3::NAN, 1.0, 1.0), Err(ShapeError::NotFinite));
    }

    #[test]
    fn describes_its_surface() {
        let surface = |origin: [f64; 3], direction: [f64; 3]| {
            let ray = Ray::new(Vec3::from_array(origin), Vec3::from_array(direction));
            let hit = cylinder().crossings(&ray).as_slice()[0];
            let oriented = OrientedCylinder::from_object(&cylinder(), &Affine::IDENTITY, 1.0);
            let surface = cylinder().surface(&ray, hit);
            assert_eq!(oriented.normal(&ray, hit), surface.geometric_normal);
            surface
        };
        let right = surface([9.0, 3.5, 3.0], [-1.0, 0.0, 0.0]);
        assert_eq!((right.point, right.geometric_normal), (Vec3::new(3.0, 3.5, 3.0), Vec3::X));
        assert_eq!(right.texcoord.get(), Vec2::new(0.75, 0.25));
        let top = surface([2.0, 9.0, 2.0], [0.0, -1.0, 0.0]);
        assert_eq!((top.point, top.geometric_normal), (Vec3::new(2.0, 5.0, 2.0), Vec3::Y));
        assert_eq!(top.texcoord.get(), Vec2::new(0.75, 0.25));
        let bottom = surface([2.0, -9.0, 2.0], [0.0, 1.0, 0.0]);
        assert_eq!((bottom.point, bottom.geometric_normal), (Vec3::new(2.0, -1.0, 2.0), Vec3::NEG_Y));
        assert_eq!(bottom.texcoord.get(), Vec2::new(0.75, 0.75));
    }
}

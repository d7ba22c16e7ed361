//! The sphere.

use super::ShapeError;
use crate::aabb::Aabb;
use crate::aabb::image_magnitude;
use crate::hit::Crossings;
use crate::hit::Hit;
use crate::hit::Surface;
use crate::hit::Texcoord;
use crate::ray::Ray;
use crate::vector::{Affine, Vec3};

/// A sphere.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Sphere {
    center: Vec3,
    radius: f64,
}

/// A sphere whose numbers are those of single precision.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct NarrowSphere {
    center: [f32; 3],
    radius: f32,
}

impl From<NarrowSphere> for Sphere {
    #[inline]
    fn from(narrow: NarrowSphere) -> Self {
        let center = Vec3::from_array(narrow.center.map(f64::from));
        Self { center, radius: f64::from(narrow.radius) }
    }
}

impl Sphere {
    /// A sphere about `center`.
    ///
    /// # Errors
    /// A radius that is not above 0; numbers that are not finite.
    pub fn new(center: Vec3, radius: f64) -> Result<Self, ShapeError> {
        if !center.is_finite() || !radius.is_finite() {
            return Err(ShapeError::NotFinite);
        }
        if radius <= 0.0 {
            return Err(ShapeError::Radius);
        }
        Ok(Self { center, radius })
    }

    /// The point in the middle.
    #[inline]
    pub const fn center(&self) -> Vec3 {
        self.center
    }

    /// The radius.
    #[inline]
    pub const fn radius(&self) -> f64 {
        self.radius
    }

    /// The same sphere in half the memory; `None` where single precision would round a number.
    #[inline]
    pub fn narrowed(&self) -> Option<NarrowSphere> {
        let narrow = NarrowSphere { center: self.center.as_vec3().to_array(), radius: self.radius as f32 };
        (Self::from(narrow) == *self).then_some(narrow)
    }

    /// See [`super::Shape::crossings`].
    ///
    /// The line's point nearest to the centre decides: its distance to the centre does not cancel however far
    /// the origin is, as b² − ac does (Haines et al., 'Precision improvements for ray/sphere intersection',
    /// Ray Tracing Gems 2019). We also take the roots from there, which costs one division.
    #[inline]
    pub fn crossings(&self, ray: &Ray) -> Crossings {
        let from_center = ray.origin - self.center;
        let per_length_squared = 1.0 / ray.direction.length_squared();
        let t_nearest = -from_center.dot(ray.direction) * per_length_squared;
        let nearest = from_center + ray.direction * t_nearest;
        let depth = self.radius * self.radius - nearest.length_squared();
        if depth >= 0.0 {
            let half = (depth * per_length_squared).sqrt();
            let at = |t| Hit { t, face: 0 };
            Crossings::of_interval(at(t_nearest - half), at(t_nearest + half))
        } else {
            // Also where numbers overflowed and `depth` is not a number.
            Crossings::NONE
        }
    }

    /// See [`super::Shape::surface`].
    pub fn surface(&self, ray: &Ray, hit: Hit) -> Surface {
        let normal = (ray.at(hit.t) - self.center).normalize_or(Vec3::Y);
        Surface {
            point: self.center + normal * self.radius,
            geometric_normal: normal,
            shading_normal: normal,
            texcoord: Texcoord::OnSphere(normal),
        }
    }

    /// See [`super::Shape::bounds`]. The same as [`Sphere::world_bounds`] under the identity, which millions of spheres
    /// should not pay for.
    #[inline]
    pub fn bounds(&self) -> Aabb {
        let extent = Vec3::splat(self.radius);
        Aabb::new(self.center - extent, self.center + extent).padded(self.center.abs() + extent)
    }

    /// See [`super::Shape::world_bounds`]: an ellipsoid reaches along an axis as far as the matrix row is long.
    pub fn world_bounds(&self, world_from_object: &Affine) -> Aabb {
        let m = &world_from_object.matrix3;
        let extent = Vec3::new(m.row(0).length(), m.row(1).length(), m.row(2).length()) * self.radius;
        let center = world_from_object.transform_point3(self.center);
        let reach = self.center.abs() + Vec3::splat(self.radius);
        Aabb::new(center - extent, center + extent).padded(image_magnitude(world_from_object, reach))
    }
}

#[cfg(test)]
mod tests {
    use super::Sphere;
    use crate::ray::Ray;
    use crate::shape::ShapeError;
    use crate::vector::{Affine, Vec2, Vec3};

    fn roots(sphere: &Sphere, origin: [f64; 3], direction: [f64; 3]) -> Vec<f64> {
        let ray = Ray::new(Vec3::from_array(origin), Vec3::from_array(direction));
        sphere.crossings(&ray).as_slice().iter().map(|hit| hit.t).collect()
    }

    #[test]
    fn is_narrowed_where_nothing_is_lost() {
        let center = Vec3::new(-0.0, f64::from(0.1_f32), f64::from(f32::MAX));
        for radius in [1.0, f64::from(0.1_f32), f64::from(f32::MIN_POSITIVE / 8.0)] {
            let sphere = Sphere::new(center, radius).unwrap();
            let again = Sphere::from(sphere.narrowed().unwrap());
            assert_eq!(again, sphere);
            assert!(again.center().x.is_sign_negative());
        }
        for (center, radius) in [(center, 0.1), (center, 1e-60), (Vec3::new(0.0, 0.0, 1e300), 1.0)] {
            assert_eq!(Sphere::new(center, radius).unwrap().narrowed(), None);
        }
    }

    #[test]
    fn meets_rays() {
        let sphere = Sphere::new(Vec3::new(1.0, 2.0, 3.0), 2.0).unwrap();
        assert_eq!(roots(&sphere, [-4.0, 2.0, 3.0], [1.0, 0.0, 0.0]), [3.0, 7.0]);
        assert_eq!(roots(&sphere, [-4.0, 2.0, 3.0], [0.5, 0.0, 0.0]), [6.0, 14.0]);
        assert_eq!(roots(&sphere, [1.0, 2.0, 3.0], [0.0, 0.0, -1.0]), [-2.0, 2.0], "from inside");
        assert_eq!(roots(&sphere, [1.0, 9.0, 3.0], [0.0, 1.0, 0.0]), [-9.0, -5.0], "behind");
        assert_eq!(roots(&sphere, [-4.0, 4.0, 3.0], [1.0, 0.0, 0.0]), [5.0, 5.0], "tangent");
        assert!(roots(&sphere, [-4.0, 4.0 + 1e-12, 3.0], [1.0, 0.0, 0.0]).is_empty(), "miss");
    }

    #[test]
    fn far_origins_and_odd_lengths_lose_nothing() {
        let sphere = Sphere::new(Vec3::ZERO, 1.0).unwrap();
        // b² − ac would lose all digits of the radius here.
        assert_eq!(roots(&sphere, [-1e9, 0.0, 0.0], [1.0, 0.0, 0.0]), [1e9 - 1.0, 1e9 + 1.0]);
        assert!(roots(&sphere, [-1e9, 1.0 + 1e-15, 0.0], [1.0, 0.0, 0.0]).is_empty());
        assert_eq!(roots(&sphere, [-1e9, 1.0 - 1e-15, 0.0], [1.0, 0.0, 0.0]).len(), 2);
        for length in [1e-30, 1e30] {
            let t = roots(&sphere, [-3.0, 0.0, 0.0], [length, 0.0, 0.0]);
            assert!((t[0] * length - 2.0).abs() < 1e-14 && (t[1] * length - 4.0).abs() < 1e-14);
        }
    }

    #[test]
    fn extreme_numbers_give_no_nan() {
        let sphere = Sphere::new(Vec3::splat(1e300), 1e300).unwrap();
        assert!(roots(&sphere, [-1e300; 3], [1.0, 1.0, 0.0]).is_empty());
        let sphere = Sphere::new(Vec3::ZERO, 1.0).unwrap();
        assert!(roots(&sphere, [0.0; 3], [0.0; 3]).is_empty());
    }

    #[test]
    fn tells_bad_numbers() {
        assert_eq!(Sphere::new(Vec3::ZERO, 0.0), Err(ShapeError::Radius));
        assert_eq!(Sphere::new(Vec3::ZERO, -1.0), Err(ShapeError::Radius));
        assert_eq!(Sphere::new(Vec3::ZERO, f64::NAN), Err(ShapeError::NotFinite));
        assert_eq!(Sphere::new(Vec3::new(f64::INFINITY, 0.0, 0.0), 1.0), Err(ShapeError::NotFinite));
    }

    #[test]
    fn describes_its_surface() {
        let sphere = Sphere::new(Vec3::new(0.0, 1.0, 0.0), 2.0).unwrap();
        let seen_along = |direction: Vec3| {
            let ray = Ray::new(Vec3::new(0.0, 1.0, 0.0) - direction * 5.0, direction);
            sphere.surface(&ray, sphere.crossings(&ray).as_slice()[0])
        };
        let front = seen_along(Vec3::NEG_Z);
        assert_eq!((front.point, front.geometric_normal), (Vec3::new(0.0, 1.0, 2.0), Vec3::Z));
        assert_eq!(front.texcoord.get(), Vec2::new(0.5, 0.5));
        assert_eq!(seen_along(Vec3::NEG_X).texcoord.get(), Vec2::new(0.75, 0.5));
        assert_eq!(seen_along(Vec3::NEG_Y).texcoord.get().y, 0.0);
        assert_eq!(seen_along(Vec3::Y).texcoord.get().y, 1.0);
    }

    #[test]
    fn bounds_are_those_under_the_identity() {
        let sphere = Sphere::new(Vec3::new(-3.7, 0.3, 1e5), 0.11).unwrap();
        assert_eq!(sphere.bounds(), sphere.world_bounds(&Affine::IDENTITY));
    }

    #[test]
    fn an_ellipsoid_is_bounded_tightly() {
        let sphere = Sphere::new(Vec3::X, 1.0).unwrap();
        let turned = Affine::from_rotation_z(0.5) * Affine::from_scale(Vec3::new(2.0, 1.0, 1.0));
        let extent = (sphere.world_bounds(&turned).size() * 0.5).x;
        let exact = (4.0 * libm::cos(0.5) * libm::cos(0.5) + libm::sin(0.5) * libm::sin(0.5)).sqrt();
        assert!((extent - exact).abs() < 1e-13);
    }
}

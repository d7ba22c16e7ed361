//! The sphere.

use super::ShapeError;
use crate::aabb::Aabb;
use crate::hit::{Crossings, Hit, Surface};
use crate::ray::Ray;
use crate::vector::{Affine, Vec2, Vec3};

/// A sphere.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Sphere {
    center: Vec3,
    radius: f64,
}

impl Sphere {
    /// A sphere about `center`.
    ///
    /// # Errors
    /// A radius that is not above 0; numbers that are not finite.
    pub fn new(center: Vec3, radius: f64) -> Result<Self, ShapeError> {
        let _ = (center, radius);
        todo!()
    }

    /// See [`super::Shape::crossings`].
    #[inline]
    pub fn crossings(&self, ray: &Ray) -> Crossings {
        let _ = ray;
        todo!()
    }

    /// See [`super::Shape::surface`].
    pub fn surface(&self, ray: &Ray, hit: Hit) -> Surface {
        let _ = (ray, hit, Vec2::ZERO);
        todo!()
    }

    /// See [`super::Shape::bounds`].
    pub fn bounds(&self) -> Aabb {
        todo!()
    }

    /// See [`super::Shape::world_bounds`].
    pub fn world_bounds(&self, world_from_object: &Affine) -> Aabb {
        self.bounds().transformed(world_from_object)
    }
}

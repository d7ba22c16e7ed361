//! The closed cylinder.

use super::ShapeError;
use crate::aabb::Aabb;
use crate::hit::{Crossings, Hit, Surface};
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
        let _ = (center, radius, height);
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

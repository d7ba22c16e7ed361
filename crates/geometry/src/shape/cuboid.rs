//! The box (`box` is a keyword of Rust).

use super::ShapeError;
use crate::aabb::Aabb;
use crate::hit::{Crossings, Hit, Surface};
use crate::ray::Ray;
use crate::vector::{Affine, Vec2, Vec3};

/// A box along the axes of its object coordinates. One edge of 0 makes it a rectangle.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Cuboid {
    center: Vec3,
    size: Vec3,
}

impl Cuboid {
    /// A box about `center` with **full** edge lengths `size`.
    ///
    /// # Errors
    /// An edge below 0 or more than one of 0; numbers that are not finite.
    pub fn new(center: Vec3, size: Vec3) -> Result<Self, ShapeError> {
        let _ = (center, size);
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

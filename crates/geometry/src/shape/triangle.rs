//! The triangle.

use super::ShapeError;
use crate::aabb::Aabb;
use crate::hit::{Crossings, Hit, Surface};
use crate::ray::Ray;
use crate::vector::{Affine, Vec2, Vec3};

/// A triangle: points, normals and texture coordinates of its three corners.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Triangle {
    vertices: [Vec3; 3],
    normals: [Vec3; 3],
    texcoords: [Vec2; 3],
}

impl Triangle {
    /// A triangle; a normal of length 0 counts as the unit face normal (counter-clockwise seen from outside).
    ///
    /// # Errors
    /// Three points on a line; numbers that are not finite.
    pub fn new(vertices: [Vec3; 3], normals: [Vec3; 3], texcoords: [Vec2; 3]) -> Result<Self, ShapeError> {
        let _ = (vertices, normals, texcoords);
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

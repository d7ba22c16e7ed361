//! The closed list of shapes and its dispatch; each shape's file holds all that is known of it.

mod round;

mod cone;
mod cuboid;
mod cylinder;
mod open;
mod sphere;
mod torus;
mod triangle;

pub use cone::{Cone, OrientedCone};
pub use cuboid::Cuboid;
pub use cylinder::{Cylinder, OrientedCylinder};
pub use open::OpenSide;
pub use sphere::{NarrowSphere, Sphere};
pub use torus::Torus;
pub use triangle::{
    Triangle, TriangleRay, corner_bounds, face_normal, interpolated_normal, intersect_vertices,
};

use crate::aabb::Aabb;
use crate::hit::{Crossings, Hit, Surface};
use crate::ray::Ray;
use crate::vector::{Affine, Vec3};

/// Why numbers do not make a shape.
#[derive(Clone, Copy, Debug, PartialEq, Eq, thiserror::Error)]
pub enum ShapeError {
    /// A number is infinite or not a number.
    #[error("a number is not finite")]
    NotFinite,
    /// The radius is not above 0.
    #[error("the radius must be above 0")]
    Radius,
    /// The height is not above 0.
    #[error("the height must be above 0")]
    Height,
    /// An edge is below 0, or more than one is 0.
    #[error("the edges must be 0 or more, at most one of them 0")]
    Edge,
    /// The three points lie on a line.
    #[error("the triangle has no area")]
    Area,
}

/// A shape in its object coordinates.
///
/// ```
/// use dotray_geometry::{Ray, Shape, Sphere, Vec3};
///
/// let shape = Shape::Sphere(Sphere::new(Vec3::ZERO, 1.0)?);
/// let ray = Ray::new(Vec3::new(0.0, 0.0, 5.0), Vec3::NEG_Z);
/// let hit = shape.intersect(&ray, 0.0, f64::INFINITY).expect("the ray aims at the sphere");
/// assert_eq!((hit.t, shape.surface(&ray, hit).geometric_normal), (4.0, Vec3::Z));
/// # Ok::<(), dotray_geometry::ShapeError>(())
/// ```
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Shape {
    /// A sphere.
    Sphere(Sphere),
    /// A box along the axes.
    Cuboid(Cuboid),
    /// A closed cylinder along y.
    Cylinder(Cylinder),
    /// A closed cone along y, apex up.
    Cone(Cone),
    /// A triangle with normals and texture coordinates at its corners.
    Triangle(Triangle),
    /// A torus about y.
    Torus(Torus),
    /// A cylinder or cone without its discs.
    Open(OpenSide),
}

/// One line for each question that every shape answers.
macro_rules! each_shape {
    ($shape:expr, $inner:ident => $answer:expr) => {
        match $shape {
            Shape::Sphere($inner) => $answer,
            Shape::Cuboid($inner) => $answer,
            Shape::Cylinder($inner) => $answer,
            Shape::Cone($inner) => $answer,
            Shape::Triangle($inner) => $answer,
            Shape::Torus($inner) => $answer,
            Shape::Open($inner) => $answer,
        }
    };
}

impl Shape {
    /// Every crossing of the ray's whole line with the surface, ascending.
    pub fn crossings(&self, ray: &Ray) -> Crossings {
        each_shape!(self, shape => shape.crossings(ray))
    }

    /// The nearest crossing with `t_min < t <= t_max`.
    pub fn intersect(&self, ray: &Ray, t_min: f64, t_max: f64) -> Option<Hit> {
        self.crossings(ray).first_within(t_min, t_max)
    }

    /// What shading wants to know of a hit that this very ray made.
    pub fn surface(&self, ray: &Ray, hit: Hit) -> Surface {
        each_shape!(self, shape => shape.surface(ray, hit))
    }

    /// The unit vectors in the surface along which s and t grow fastest, at a surface point of this shape; `None` where
    /// there are none.
    pub fn texture_axes(&self, surface: &Surface) -> Option<[Vec3; 2]> {
        match self {
            Self::Triangle(triangle) => triangle.texture_axes(),
            Self::Sphere(_)
            | Self::Cuboid(_)
            | Self::Cylinder(_)
            | Self::Cone(_)
            | Self::Torus(_)
            | Self::Open(_) => surface.texture_axes(),
        }
    }

    /// The smallest box around the shape, padded by what rounding may move points of its surface.
    pub fn bounds(&self) -> Aabb {
        each_shape!(self, shape => shape.bounds())
    }

    /// A tight world box of the shape under `world_from_object`, padded likewise.
    pub fn world_bounds(&self, world_from_object: &Affine) -> Aabb {
        each_shape!(self, shape => shape.world_bounds(world_from_object))
    }
}

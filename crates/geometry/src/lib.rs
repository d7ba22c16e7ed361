//! Vectors, rays, boxes, transforms and the analytic shapes: double precision, no I/O, no threads.
//!
//! The order of the `mod` lines is the floor order: a module uses only modules listed above it.

pub mod vector;

pub mod ray;

pub mod aabb;

pub mod transform;

pub mod hit;

pub mod roots;

pub mod shape;

pub use aabb::Aabb;
pub use hit::{Crossings, Hit, Surface, Texcoord};
pub use ray::Ray;
pub use shape::{
    Cone, Cuboid, Cylinder, OpenSide, OrientedCone, OrientedCylinder, Shape, ShapeError, Sphere, Torus,
    Triangle,
};
pub use shape::{TriangleRay, face_normal, interpolated_normal, intersect_vertices};
pub use transform::{SingularMatrix, Transform, similarity_scale};
pub use vector::{Affine, Mat3, Mat4, Vec2, Vec3, Vec4};

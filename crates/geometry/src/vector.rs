//! The vector and matrix types: glam's double-precision ones, whose operations are plain scalar IEEE
//! arithmetic and therefore give the same bits on every machine.

pub use glam::{
    DAffine3 as Affine, DMat3 as Mat3, DMat4 as Mat4, DVec2 as Vec2, DVec3 as Vec3, DVec4 as Vec4,
};

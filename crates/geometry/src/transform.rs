//! From object to world and back.

use crate::vector::{Affine, Mat3, Vec3};

/// An invertible affine map between an object frame and the world, with its inverse.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Transform {
    /// Takes object coordinates to world coordinates.
    pub world_from_object: Affine,
    /// Takes world coordinates to object coordinates.
    pub object_from_world: Affine,
}

/// The matrix has no usable inverse.
#[derive(Clone, Copy, Debug, PartialEq, Eq, thiserror::Error)]
#[error("the matrix is singular")]
pub struct SingularMatrix;

impl Transform {
    /// The frame that is the world.
    pub const IDENTITY: Self = Self { world_from_object: Affine::IDENTITY, object_from_world: Affine::IDENTITY };

    /// The transform of `world_from_object`.
    ///
    /// # Errors
    /// [`SingularMatrix`] where |det| ≤ 1e-14 × the product of the lengths of the three rows (SPEC 2), or
    /// where the inverse is not finite.
    pub fn new(world_from_object: Affine) -> Result<Self, SingularMatrix> {
        let m = world_from_object.matrix3;
        let rows = m.row(0).length() * m.row(1).length() * m.row(2).length();
        let determinant = m.determinant();
        if !(determinant.abs() > 1e-14 * rows) {
            return Err(SingularMatrix);
        }
        let object_from_world = world_from_object.inverse();
        if !object_from_world.is_finite() || !world_from_object.is_finite() {
            return Err(SingularMatrix);
        }
        Ok(Self { world_from_object, object_from_world })
    }

    /// An object-space normal as a unit vector of the world: by the inverse transpose, renormalised.
    #[inline]
    pub fn world_normal(&self, normal_in_object: Vec3) -> Vec3 {
        let m = &self.object_from_world.matrix3;
        // Columns of the inverse dotted with the normal are the rows of the inverse transpose.
        Vec3::new(m.x_axis.dot(normal_in_object), m.y_axis.dot(normal_in_object), m.z_axis.dot(normal_in_object))
            .normalize()
    }

    /// The uniform scale of a similarity (rotation, reflection, one scale for all axes), or `None` where lengths
    /// change with the direction by more than rounding (relative 1e-12).
    pub fn similarity_scale(&self) -> Option<f64> {
        let m: &Mat3 = &self.world_from_object.matrix3;
        let (xx, yy, zz) = (m.x_axis.length_squared(), m.y_axis.length_squared(), m.z_axis.length_squared());
        let (xy, yz, zx) = (m.x_axis.dot(m.y_axis), m.y_axis.dot(m.z_axis), m.z_axis.dot(m.x_axis));
        let slack = 1e-12 * xx;
        let even = (xx - yy).abs() <= slack && (xx - zz).abs() <= slack;
        let square = xy.abs() <= slack && yz.abs() <= slack && zx.abs() <= slack;
        (even && square).then(|| xx.sqrt())
    }
}

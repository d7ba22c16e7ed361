//! The transforms of nested groups.

use dotray_geometry::Affine;
use dotray_geometry::Mat4;
use dotray_geometry::SingularMatrix;
use dotray_geometry::Transform;

/// The transform of a group inside `parent`, the outermost matrix standing leftmost. `parent_from_group` is the
/// matrix as written, its last row `0 0 0 1`.
///
/// # Errors
/// [`SingularMatrix`] where the product has no usable inverse or is not finite.
pub fn nested(parent: &Transform, parent_from_group: &Mat4) -> Result<Transform, SingularMatrix> {
    nested_in(&parent.world_from_object, parent_from_group)
}

/// The same inside the group of this matrix.
///
/// # Errors
/// See [`nested`].
pub fn nested_in(world_from_parent: &Affine, parent_from_group: &Mat4) -> Result<Transform, SingularMatrix> {
    // The inverse is that of the product, not the product of the inverses: see the test of deep chains.
    Transform::new(*world_from_parent * Affine::from_mat4(*parent_from_group))
}

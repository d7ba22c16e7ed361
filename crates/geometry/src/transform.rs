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
    pub const IDENTITY: Self =
        Self { world_from_object: Affine::IDENTITY, object_from_world: Affine::IDENTITY };

    /// The transform of `world_from_object`.
    ///
    /// # Errors
    /// [`SingularMatrix`] where |det| ≤ 1e-14 × the product of the lengths of the three rows (SPEC 2), or
    /// where the inverse is not finite.
    pub fn new(world_from_object: Affine) -> Result<Self, SingularMatrix> {
        if !world_from_object.is_finite() {
            return Err(SingularMatrix);
        }
        let balanced = Balanced::new(&world_from_object.matrix3);
        let m = &balanced.matrix;
        let rows = m.row(0).length() * m.row(1).length() * m.row(2).length();
        let well_conditioned = m.determinant().abs() > 1e-14 * rows;
        if !well_conditioned {
            return Err(SingularMatrix);
        }
        let object_from_world = balanced.inverse(world_from_object.translation);
        if !object_from_world.is_finite() {
            return Err(SingularMatrix);
        }
        Ok(Self { world_from_object, object_from_world })
    }

    /// The transform of a matrix that [`Transform::new`] has accepted before, without the inverse being kept: the very
    /// same one.
    #[inline]
    pub fn again(world_from_object: Affine) -> Self {
        let balanced = Balanced::new(&world_from_object.matrix3);
        let object_from_world = balanced.inverse(world_from_object.translation);
        Self { world_from_object, object_from_world }
    }

    /// An object-space normal as a unit vector of the world: by the inverse transpose, renormalised.
    #[inline]
    pub fn world_normal(&self, normal_in_object: Vec3) -> Vec3 {
        let m = &self.object_from_world.matrix3;
        // Columns of the inverse dotted with the normal are the rows of the inverse transpose.
        Vec3::new(
            m.x_axis.dot(normal_in_object),
            m.y_axis.dot(normal_in_object),
            m.z_axis.dot(normal_in_object),
        )
        .normalize()
    }

    /// The uniform scale of a similarity: see [`similarity_scale`].
    pub fn similarity_scale(&self) -> Option<f64> {
        similarity_scale(&self.world_from_object)
    }
}

/// The uniform scale of a similarity (rotation, reflection, one scale for all axes), or `None` where lengths
/// change with the direction by more than rounding (relative 1e-12). It is the length of the x axis's image.
#[inline]
pub fn similarity_scale(world_from_object: &Affine) -> Option<f64> {
    let m = &world_from_object.matrix3;
    let (xx, yy, zz) = (m.x_axis.length_squared(), m.y_axis.length_squared(), m.z_axis.length_squared());
    let (xy, yz, zx) = (m.x_axis.dot(m.y_axis), m.y_axis.dot(m.z_axis), m.z_axis.dot(m.x_axis));
    let slack = 1e-12 * xx;
    // Squares near the ends of f64's range tell nothing of the lengths.
    let measurable = (1e-280..1e280).contains(&xx);
    let even = (xx - yy).abs() <= slack && (xx - zz).abs() <= slack;
    let square = xy.abs() <= slack && yz.abs() <= slack && zx.abs() <= slack;
    (measurable && even && square).then(|| xx.sqrt())
}

/// A matrix whose rows have been brought to a size near 1 by powers of two, which rounds nothing: so neither deep
/// chains of scalings nor very uneven ones make determinants overflow or vanish.
struct Balanced {
    matrix: Mat3,
    /// The binary logarithm of what each row was multiplied by.
    shifts: [i32; 3],
}

impl Balanced {
    #[inline]
    fn new(m: &Mat3) -> Self {
        let shifts = [m.row(0), m.row(1), m.row(2)].map(|row| -exponent(row.abs().max_element()));
        if shifts == [0; 3] {
            // As most turns are: whoever waits for the inverse need not wait for the powers first.
            return Self { matrix: *m, shifts };
        }
        let balance = |column: Vec3| scaled_by_powers(column, shifts);
        Self { matrix: Mat3::from_cols(balance(m.x_axis), balance(m.y_axis), balance(m.z_axis)), shifts }
    }

    /// The inverse of the map of which this is the matrix.
    #[inline]
    fn inverse(&self, translation: Vec3) -> Affine {
        // (S M)⁻¹ = M⁻¹ S⁻¹, so M⁻¹ has the columns of (S M)⁻¹ times the powers.
        let inverse = self.matrix.inverse();
        let unbalance = |column: Vec3, shift: i32| scaled_by_powers(column, [shift; 3]);
        let matrix3 = match self.shifts {
            [0, 0, 0] => inverse,
            [x, y, z] => Mat3::from_cols(
                unbalance(inverse.x_axis, x),
                unbalance(inverse.y_axis, y),
                unbalance(inverse.z_axis, z),
            ),
        };
        Affine { matrix3, translation: -(matrix3 * translation) }
    }
}

/// The power of two of `x`; 0 for 0.
#[inline]
fn exponent(x: f64) -> i32 {
    let biased = (x.to_bits() >> 52) as i32 & 0x7ff;
    // Those of 0 and of what is smaller than any normal number do not stand there.
    if biased == 0 { libm::frexp(x).1 } else { biased - 1022 }
}

/// The coordinates times 2 to the power of each shift.
#[inline]
fn scaled_by_powers(v: Vec3, shifts: [i32; 3]) -> Vec3 {
    Vec3::new(scaled(v.x, shifts[0]), scaled(v.y, shifts[1]), scaled(v.z, shifts[2]))
}

#[inline]
fn scaled(x: f64, shift: i32) -> f64 {
    // Most powers are numbers themselves.
    if (-1022..=1023).contains(&shift) {
        x * f64::from_bits(((shift + 1023) as u64) << 52)
    } else {
        libm::scalbn(x, shift)
    }
}

#[cfg(test)]
mod tests {
    use proptest::prelude::*;

    use super::SingularMatrix;
    use super::Transform;
    use crate::vector::{Affine, Mat3, Vec3};

    fn of_rows(rows: [[f64; 3]; 3]) -> Result<Transform, SingularMatrix> {
        Transform::new(Affine::from_mat3(Mat3::from_cols_array_2d(&rows).transpose()))
    }

    /// How far the inverse times the matrix is from the identity.
    fn defect(transform: &Transform) -> f64 {
        let product = transform.object_from_world.matrix3 * transform.world_from_object.matrix3;
        (product - Mat3::IDENTITY).to_cols_array().into_iter().fold(0.0, |worst, x| x.abs().max(worst))
    }

    #[test]
    fn finds_singular_matrices() {
        let singular = [
            [[1.0, 2.0, 3.0], [0.0, 0.0, 0.0], [4.0, 5.0, 6.0]],
            [[1.0, 2.0, 3.0], [1.0, 2.0, 3.0], [4.0, 5.0, 6.0]],
            [[1.0, 2.0, 3.0], [4.0, 5.0, 6.0], [7.0, 8.0, 9.0]],
            [[0.1, 0.2, 0.3], [0.4, 0.5, 0.6], [0.7, 0.8, 0.9]],
            [[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [1.0, 1.0, 1e-15]],
            [[0.0; 3]; 3],
        ];
        for rows in singular {
            assert_eq!(of_rows(rows), Err(SingularMatrix), "{rows:?}");
        }
        assert!(of_rows([[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [1.0, 1.0, 1e-12]]).is_ok());
        assert!(of_rows([[1.0, f64::NAN, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]]).is_err());
        assert!(of_rows([[f64::INFINITY, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]]).is_err());
    }

    #[test]
    fn size_alone_is_not_singular() {
        let turn = Mat3::from_rotation_y(0.7) * Mat3::from_rotation_x(0.3);
        for scale in [1e-200, 1e-110, 1e-30, 1e-3, 1.0, 1e30, 1e110, 1e200] {
            let transform = Transform::new(Affine::from_mat3(turn * scale)).unwrap();
            assert!(defect(&transform) < 1e-15 * 4.0, "{scale}");
        }
        let uneven = of_rows([[1e-90, 0.0, 0.0], [0.0, 1e90, 0.0], [0.0, 0.0, 1e-120]]).unwrap();
        assert!(defect(&uneven) < 1e-15);
        assert_eq!(Transform::again(uneven.world_from_object), uneven);
    }

    #[test]
    fn deep_chains_keep_their_inverse() {
        let step = Affine::from_scale_rotation_translation(
            Vec3::splat(0.9),
            glam::DQuat::from_rotation_y(0.37),
            Vec3::new(0.1, -0.2, 0.3),
        );
        let chain = (0..1000).fold(Affine::IDENTITY, |all, _| all * step);
        let transform = Transform::new(chain).unwrap();
        assert!(defect(&transform) < 1e-13);
        let scale = transform.similarity_scale().unwrap();
        assert!((scale / libm::pow(0.9, 1000.0) - 1.0).abs() < 1e-11);
    }

    #[test]
    fn knows_similarities() {
        let turn = Mat3::from_rotation_z(1.1) * Mat3::from_rotation_x(-0.4);
        let scale_of = |m: Mat3| Transform::new(Affine::from_mat3(m)).unwrap().similarity_scale();
        assert!((scale_of(turn * 3.0).unwrap() - 3.0).abs() < 1e-14);
        let mirror = Mat3::from_diagonal(Vec3::new(-2.0, 2.0, 2.0));
        assert!((scale_of(turn * mirror).unwrap() - 2.0).abs() < 1e-14);
        assert_eq!(scale_of(turn * Mat3::from_diagonal(Vec3::new(1.0, 1.0, 1.0 + 1e-9))), None);
        let shear = Mat3::from_cols(Vec3::X, Vec3::new(1e-9, 1.0, 0.0), Vec3::Z);
        assert_eq!(scale_of(shear), None);
        // The lengths' squares vanish: no scale may be claimed.
        assert_eq!(scale_of(Mat3::IDENTITY * 1e-200), None);
    }

    #[test]
    fn normals_stay_perpendicular_to_their_surface() {
        let shear = of_rows([[1.0, 2.0, 0.0], [0.0, 0.5, 0.3], [0.1, 0.0, -3.0]]).unwrap();
        let (normal, tangent) = (Vec3::new(1.0, 2.0, -1.0), Vec3::new(1.0, 0.0, 1.0));
        let world_normal = shear.world_normal(normal);
        let world_tangent = shear.world_from_object.transform_vector3(tangent);
        assert!(world_normal.dot(world_tangent).abs() < 1e-15 * 8.0);
        assert!((world_normal.length() - 1.0).abs() < 1e-15);
    }

    #[test]
    fn powers_of_two_are_those_of_the_mathematical_library() {
        let numbers = [0.0, -0.0, 1.0, -1.5, 0.75, 1e-310, 5e-324, 1e308, -3e-200, f64::MIN_POSITIVE];
        for x in numbers {
            assert_eq!(super::exponent(x), libm::frexp(x).1, "{x:e}");
            for shift in [-1074, -1023, -1022, -1000, -53, -1, 0, 1, 60, 1023, 1024, 1100] {
                let (ours, theirs) = (super::scaled(x, shift), libm::scalbn(x, shift));
                assert_eq!(ours.to_bits(), theirs.to_bits(), "{x:e} by {shift}");
            }
        }
    }

    proptest! {
        #![proptest_config(ProptestConfig::with_cases(1000))]

        #[test]
        fn points_come_back(entries in prop::array::uniform9(-2.0..2.0f64),
            translation in prop::array::uniform3(-5.0..5.0f64),
                            point in prop::array::uniform3(-5.0..5.0f64)) {
            let matrix = Mat3::from_cols_array(&entries);
            prop_assume!(matrix.determinant().abs() > 1e-2);
            let affine = Affine::from_mat3_translation(matrix, Vec3::from_array(translation));
            let transform = Transform::new(affine).unwrap();
            let point = Vec3::from_array(point);
            let back = transform.object_from_world.transform_point3(affine.transform_point3(point));
            prop_assert!((back - point).length() < 1e-10);
            prop_assert_eq!(Transform::again(affine), transform);
        }
    }
}

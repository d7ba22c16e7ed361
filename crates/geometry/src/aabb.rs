//! Axis-aligned boxes in double precision.

use crate::vector::{Affine, Vec3};

/// An axis-aligned box; empty where `min` exceeds `max`.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Aabb {
    /// The corner with the smallest coordinates.
    pub min: Vec3,
    /// The corner with the largest coordinates.
    pub max: Vec3,
}

impl Aabb {
    /// The box that holds nothing; the neutral element of [`Aabb::union`].
    pub const EMPTY: Self = Self { min: Vec3::INFINITY, max: Vec3::NEG_INFINITY };

    /// The box between two corners.
    #[inline]
    pub const fn new(min: Vec3, max: Vec3) -> Self {
        Self { min, max }
    }

    /// The smallest box around the points.
    pub fn around(points: impl IntoIterator<Item = Vec3>) -> Self {
        points.into_iter().fold(Self::EMPTY, |bounds, point| bounds.grown(point))
    }

    /// The smallest box that holds both.
    #[inline]
    pub fn union(self, other: Self) -> Self {
        Self { min: self.min.min(other.min), max: self.max.max(other.max) }
    }

    /// The smallest box that also holds `point`.
    #[inline]
    pub fn grown(self, point: Vec3) -> Self {
        Self { min: self.min.min(point), max: self.max.max(point) }
    }

    /// Whether it holds no point.
    #[inline]
    pub fn is_empty(&self) -> bool {
        !(self.min.x <= self.max.x && self.min.y <= self.max.y && self.min.z <= self.max.z)
    }

    /// Whether the closed box holds `point`.
    #[inline]
    pub fn contains(&self, point: Vec3) -> bool {
        self.min.cmple(point).all() && point.cmple(self.max).all()
    }

    /// The point in the middle.
    #[inline]
    pub fn center(&self) -> Vec3 {
        (self.min + self.max) * 0.5
    }

    /// The edge lengths; zero for the empty box.
    #[inline]
    pub fn size(&self) -> Vec3 {
        (self.max - self.min).max(Vec3::ZERO)
    }

    /// Half the area of the surface: what the surface-area heuristic compares.
    #[inline]
    pub fn half_area(&self) -> f64 {
        let size = self.size();
        size.x * size.y + size.y * size.z + size.z * size.x
    }

    /// Grown on every side by 16 roundings of numbers of size `magnitude`: what the few operations between
    /// a shape and a point on it may be off by.
    #[inline]
    pub fn padded(self, magnitude: Vec3) -> Self {
        let slack = magnitude * (16.0 * f64::EPSILON);
        Self { min: self.min - slack, max: self.max + slack }
    }

    /// The axis-aligned box around the eight transformed corners, padded by what rounding may have taken;
    /// empty stays empty.
    pub fn transformed(&self, to_from_here: &Affine) -> Self {
        if self.is_empty() {
            return Self::EMPTY;
        }
        let corner = |i: usize| {
            Vec3::new(
                if i & 1 == 0 { self.min.x } else { self.max.x },
                if i & 2 == 0 { self.min.y } else { self.max.y },
                if i & 4 == 0 { self.min.z } else { self.max.z },
            )
        };
        let corners = Self::around((0..8).map(|i| to_from_here.transform_point3(corner(i))));
        corners.padded(image_magnitude(to_from_here, self.min.abs().max(self.max.abs())))
    }
}

/// The size of the numbers that meet when points whose coordinates are at most `reach` are transformed.
pub(crate) fn image_magnitude(to_from_here: &Affine, reach: Vec3) -> Vec3 {
    let m = &to_from_here.matrix3;
    m.x_axis.abs() * reach.x
        + m.y_axis.abs() * reach.y
        + m.z_axis.abs() * reach.z
        + to_from_here.translation.abs()
}

#[cfg(test)]
mod tests {
    use super::Aabb;
    use crate::vector::{Affine, Vec3};

    #[test]
    fn empty_is_neutral_and_stays_empty() {
        let unit = Aabb::new(Vec3::ZERO, Vec3::ONE);
        assert!(Aabb::EMPTY.is_empty() && !unit.is_empty());
        assert_eq!(Aabb::EMPTY.union(unit), unit);
        assert!(Aabb::EMPTY.transformed(&Affine::from_scale(Vec3::new(-1.0, 2.0, 3.0))).is_empty());
        assert_eq!((Aabb::EMPTY.size(), Aabb::EMPTY.half_area()), (Vec3::ZERO, 0.0));
    }

    #[test]
    fn measures() {
        let bounds = Aabb::around([Vec3::new(1.0, 2.0, 3.0), Vec3::new(0.0, 4.0, 6.0)]);
        assert_eq!((bounds.center(), bounds.size()), (Vec3::new(0.5, 3.0, 4.5), Vec3::new(1.0, 2.0, 3.0)));
        assert_eq!(bounds.half_area(), 11.0);
        assert!(bounds.contains(bounds.min) && bounds.contains(bounds.max));
        assert!(!bounds.contains(Vec3::new(0.5, 3.0, 6.1)));
    }

    #[test]
    fn a_turned_box_holds_its_corners_and_little_more() {
        let quarter = Affine::from_rotation_z(std::f64::consts::FRAC_PI_4);
        let turned = Aabb::new(Vec3::NEG_ONE, Vec3::ONE).transformed(&quarter);
        let diagonal = 2f64.sqrt();
        let exact = Aabb::new(Vec3::new(-diagonal, -diagonal, -1.0), Vec3::new(diagonal, diagonal, 1.0));
        assert_eq!(turned.union(exact), turned);
        assert!((turned.max - exact.max).max_element() < 1e-14);
    }
}

//! Cylinders and cones without their discs: one sees into them.

use super::cone::Cone;
use super::cylinder::Cylinder;
use super::round::SIDE;
use crate::aabb::Aabb;
use crate::hit::Crossings;
use crate::hit::Hit;
use crate::hit::Surface;
use crate::ray::Ray;
use crate::vector::Affine;

/// The side of a round shape alone.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum OpenSide {
    /// Of a cylinder.
    Cylinder(Cylinder),
    /// Of a cone.
    Cone(Cone),
}

impl OpenSide {
    /// See [`super::Shape::crossings`]: those of the closed shape that lie on its side. A line meets the side only at
    /// the ends of its part inside the closed shape, for that is convex.
    pub fn crossings(&self, ray: &Ray) -> Crossings {
        let closed = match self {
            Self::Cylinder(cylinder) => cylinder.crossings(ray),
            Self::Cone(cone) => cone.crossings(ray),
        };
        let mut found = Crossings::NONE;
        closed.as_slice().iter().filter(|hit| hit.face == SIDE).for_each(|hit| found.push(*hit));
        found
    }

    /// See [`super::Shape::surface`].
    pub fn surface(&self, ray: &Ray, hit: Hit) -> Surface {
        match self {
            Self::Cylinder(cylinder) => cylinder.surface(ray, hit),
            Self::Cone(cone) => cone.surface(ray, hit),
        }
    }

    /// See [`super::Shape::bounds`].
    pub fn bounds(&self) -> Aabb {
        self.world_bounds(&Affine::IDENTITY)
    }

    /// See [`super::Shape::world_bounds`].
    pub fn world_bounds(&self, world_from_object: &Affine) -> Aabb {
        match self {
            Self::Cylinder(cylinder) => cylinder.world_bounds(world_from_object),
            Self::Cone(cone) => cone.world_bounds(world_from_object),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::OpenSide;
    use crate::ray::Ray;
    use crate::shape::{Cone, Cylinder};
    use crate::vector::Vec3;

    #[test]
    fn one_sees_into_them() {
        let tube = OpenSide::Cylinder(Cylinder::new(Vec3::ZERO, 1.0, 2.0).unwrap());
        let hat = OpenSide::Cone(Cone::new(Vec3::ZERO, 1.0, 2.0).unwrap());
        let hits = |shape: &OpenSide, origin: [f64; 3], direction: [f64; 3]| -> Vec<f64> {
            let ray = Ray::new(Vec3::from_array(origin), Vec3::from_array(direction));
            shape.crossings(&ray).as_slice().iter().map(|hit| hit.t).collect()
        };
        assert_eq!(hits(&tube, [-3.0, 0.0, 0.0], [1.0, 0.0, 0.0]), [2.0, 4.0]);
        assert!(hits(&tube, [0.5, 3.0, 0.0], [0.0, -1.0, 0.0]).is_empty(), "through both ends");
        assert_eq!(hits(&tube, [-1.0, 3.0, 0.0], [1.0, -1.0, 0.0]), [2.0], "into the upper end");
        assert_eq!(hits(&hat, [-3.0, -0.5, 0.0], [1.0, 0.0, 0.0]).len(), 2);
        assert_eq!(hits(&hat, [0.25, -3.0, 0.0], [0.0, 1.0, 0.0]), [3.5], "from below");
    }
}

//! The box (`box` is a keyword of Rust).

use super::ShapeError;
use crate::aabb::Aabb;
use crate::hit::Crossings;
use crate::hit::Hit;
use crate::hit::Surface;
use crate::hit::Texcoord;
use crate::ray::Ray;
use crate::vector::{Affine, Vec2, Vec3};

/// A box along the axes of its object coordinates. One edge of 0 makes it a rectangle.
///
/// Its faces are numbered −x, +x, −y, +y, −z, +z from 0.
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
        if !center.is_finite() || !size.is_finite() {
            return Err(ShapeError::NotFinite);
        }
        let edges = size.to_array();
        let flat_edges = edges.iter().filter(|&&edge| edge == 0.0).count();
        if edges.iter().any(|&edge| edge < 0.0) || flat_edges > 1 {
            return Err(ShapeError::Edge);
        }
        Ok(Self { center, size })
    }

    /// The point in the middle.
    #[inline]
    pub const fn center(&self) -> Vec3 {
        self.center
    }

    /// The full edge lengths.
    #[inline]
    pub const fn size(&self) -> Vec3 {
        self.size
    }

    /// The corners with the smallest and with the largest coordinates.
    #[inline]
    fn corners(&self) -> (Vec3, Vec3) {
        let half = self.size * 0.5;
        (self.center - half, self.center + half)
    }

    /// See [`super::Shape::crossings`]. A rectangle has one crossing, on the face towards the ray, and none with
    /// a ray in its plane.
    #[inline]
    pub fn crossings(&self, ray: &Ray) -> Crossings {
        let (low, high) = self.corners();
        let mut enter = Hit { t: f64::NEG_INFINITY, face: 0 };
        let mut leave = Hit { t: f64::INFINITY, face: 0 };
        let mut flat_face = None;
        for axis in 0..3 {
            let (o, d, low, high) = (ray.origin[axis], ray.direction[axis], low[axis], high[axis]);
            let is_flat = self.size[axis] == 0.0;
            if d == 0.0 {
                // Parallel to this slab: no division, for 0/0 is not a number.
                if is_flat || o < low || o > high {
                    return Crossings::NONE;
                }
                continue;
            }
            let low_face = 2 * axis as u8;
            let at_low = Hit { t: (low - o) / d, face: low_face };
            let at_high = Hit { t: (high - o) / d, face: low_face + 1 };
            let (near, far) = if d > 0.0 { (at_low, at_high) } else { (at_high, at_low) };
            if is_flat {
                flat_face = Some(near.face);
            }
            enter = if near.t > enter.t { near } else { enter };
            leave = if far.t < leave.t { far } else { leave };
        }
        match flat_face {
            Some(face) if enter.t <= leave.t && enter.t.is_finite() => {
                Crossings::one(Hit { t: enter.t, face })
            }
            Some(_) => Crossings::NONE,
            None => Crossings::of_interval(enter, leave),
        }
    }

    /// See [`super::Shape::surface`].
    pub fn surface(&self, ray: &Ray, hit: Hit) -> Surface {
        let (low, high) = self.corners();
        let face = hit.face.min(5);
        let (axis, is_high) = (usize::from(face / 2), face % 2 == 1);
        let mut point = ray.at(hit.t).max(low).min(high);
        point[axis] = if is_high { high[axis] } else { low[axis] };
        let normal = Vec3::AXES[axis] * if is_high { 1.0 } else { -1.0 };
        // Fractions of the edges from the low and from the high corner; the flat axis of a rectangle is not used.
        // The divisor is the distance of the rounded corners, so that no fraction exceeds 1.
        let size = (high - low).max(Vec3::splat(f64::MIN_POSITIVE));
        let up = (point - low) / size;
        let down = (high - point) / size;
        let texcoord = match face {
            0 => Vec2::new(up.z, down.y),
            1 => Vec2::new(down.z, down.y),
            2 => Vec2::new(up.x, down.z),
            3 => Vec2::new(up.x, up.z),
            4 => Vec2::new(down.x, down.y),
            _front => Vec2::new(up.x, down.y),
        };
        Surface {
            point,
            geometric_normal: normal,
            shading_normal: normal,
            texcoord: Texcoord::Known(texcoord),
        }
    }

    /// See [`super::Shape::bounds`].
    pub fn bounds(&self) -> Aabb {
        self.world_bounds(&Affine::IDENTITY)
    }

    /// See [`super::Shape::world_bounds`].
    pub fn world_bounds(&self, world_from_object: &Affine) -> Aabb {
        let (low, high) = self.corners();
        Aabb::new(low, high).transformed(world_from_object)
    }
}

#[cfg(test)]
mod tests {
    use super::Cuboid;
    use crate::ray::Ray;
    use crate::shape::ShapeError;
    use crate::vector::{Vec2, Vec3};

    fn hits(cuboid: &Cuboid, origin: [f64; 3], direction: [f64; 3]) -> Vec<(f64, u8)> {
        let ray = Ray::new(Vec3::from_array(origin), Vec3::from_array(direction));
        cuboid.crossings(&ray).as_slice().iter().map(|hit| (hit.t, hit.face)).collect()
    }

    #[test]
    fn meets_rays() {
        let cuboid = Cuboid::new(Vec3::new(1.0, 2.0, 3.0), Vec3::new(2.0, 4.0, 6.0)).unwrap();
        assert_eq!(hits(&cuboid, [-4.0, 2.0, 3.0], [1.0, 0.0, 0.0]), [(4.0, 0), (6.0, 1)]);
        assert_eq!(hits(&cuboid, [1.0, 9.0, 3.0], [0.0, -2.0, 0.0]), [(2.5, 3), (4.5, 2)]);
        assert_eq!(hits(&cuboid, [1.0, 2.0, 3.0], [0.0, 0.0, 1.0]), [(-3.0, 4), (3.0, 5)], "from inside");
        assert_eq!(hits(&cuboid, [-1.0, 1.0, 3.0], [1.0, 1.0, 0.0]), [(1.0, 0), (3.0, 1)]);
        assert_eq!(hits(&cuboid, [-1.0, 0.0, 3.0], [1.0, 4.0, 0.0]), [(1.0, 0), (1.0, 3)], "an edge");
        assert!(hits(&cuboid, [-4.0, 4.5, 3.0], [1.0, 0.0, 0.0]).is_empty());
        assert!(hits(&cuboid, [-1.0, 3.0, 3.0], [1.0, 2.0, 0.0]).is_empty());
    }

    #[test]
    fn rays_in_the_plane_of_a_face_are_no_nan() {
        let cuboid = Cuboid::new(Vec3::ZERO, Vec3::splat(2.0)).unwrap();
        for plane in [-1.0, 1.0] {
            for zero in [0.0, -0.0] {
                assert_eq!(hits(&cuboid, [-4.0, plane, 0.0], [1.0, zero, zero]), [(3.0, 0), (5.0, 1)]);
            }
        }
        // A direction so small that 1/d is infinite.
        assert_eq!(hits(&cuboid, [-4.0, 1.0, 0.0], [1.0, -1e-310, 0.0]), [(3.0, 0), (5.0, 1)]);
        assert!(hits(&cuboid, [0.0; 3], [0.0; 3]).is_empty());
    }

    #[test]
    fn a_rectangle_has_one_crossing_on_the_face_towards_the_ray() {
        let sheet = Cuboid::new(Vec3::new(0.0, 1.0, 0.0), Vec3::new(2.0, 0.0, 2.0)).unwrap();
        assert_eq!(hits(&sheet, [0.5, 4.0, 0.0], [0.0, -1.0, 0.0]), [(3.0, 3)]);
        assert_eq!(hits(&sheet, [0.5, -4.0, 0.0], [0.0, 1.0, 0.0]), [(5.0, 2)]);
        assert_eq!(hits(&sheet, [0.5, 4.0, 0.0], [0.0, 1.0, 0.0]), [(-3.0, 2)], "behind");
        assert_eq!(hits(&sheet, [-1.0, 0.0, 0.0], [0.5, 1.0, 0.25]), [(1.0, 2)]);
        assert_eq!(hits(&sheet, [-2.0, 0.0, 0.0], [1.0, 1.0, 0.0]), [(1.0, 2)], "its edge");
        assert!(hits(&sheet, [-2.5, 0.0, 0.0], [1.0, 1.0, 0.0]).is_empty());
        assert!(hits(&sheet, [-4.0, 1.0, 0.0], [1.0, 0.0, 0.0]).is_empty(), "in its plane");
    }

    #[test]
    fn tells_bad_numbers() {
        assert_eq!(Cuboid::new(Vec3::ZERO, Vec3::new(1.0, -1.0, 1.0)), Err(ShapeError::Edge));
        assert_eq!(Cuboid::new(Vec3::ZERO, Vec3::new(0.0, 1.0, 0.0)), Err(ShapeError::Edge));
        assert_eq!(Cuboid::new(Vec3::ZERO, Vec3::new(1.0, f64::NAN, 1.0)), Err(ShapeError::NotFinite));
        assert!(Cuboid::new(Vec3::ZERO, Vec3::new(1.0, -0.0, 1.0)).is_ok());
    }

    #[test]
    fn describes_its_surface() {
        let cuboid = Cuboid::new(Vec3::new(1.0, 2.0, 3.0), Vec3::new(2.0, 4.0, 8.0)).unwrap();
        // A point a quarter along each edge from the low corner, seen on each of the six faces.
        let inner = Vec3::new(0.5, 1.0, 1.0);
        let expected = [
            (Vec3::NEG_X, Vec2::new(0.25, 0.75)),
            (Vec3::X, Vec2::new(0.75, 0.75)),
            (Vec3::NEG_Y, Vec2::new(0.25, 0.75)),
            (Vec3::Y, Vec2::new(0.25, 0.25)),
            (Vec3::NEG_Z, Vec2::new(0.75, 0.75)),
            (Vec3::Z, Vec2::new(0.25, 0.75)),
        ];
        for (normal, texcoord) in expected {
            let ray = Ray::new(inner + normal * 20.0, -normal);
            let surface = cuboid.surface(&ray, cuboid.crossings(&ray).as_slice()[0]);
            assert_eq!((surface.geometric_normal, surface.texcoord.get()), (normal, texcoord));
            let offset = (surface.point - Vec3::new(1.0, 2.0, 3.0)) * normal;
            assert_eq!(offset.element_sum(), (Vec3::new(1.0, 2.0, 4.0) * normal.abs()).element_sum());
        }
    }
}

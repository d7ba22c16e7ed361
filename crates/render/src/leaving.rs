//! Which rays cannot meet the shape again that they leave, so that nobody need test it.
//!
//! Every shadow ray and every secondary ray starts on a shape, within single precision of it, so that nothing but its
//! test in double precision can tell that it does not meet that shape again. Yet a ray that leaves a convex body
//! outwards never does, nor does one that leaves a plane. The test would say so as well, except where rounding moves
//! the crossing at the ray's start beyond the smallest t that counts, 1e-9 of the scene's size.
//!
//! With u = 1.1e-16 and a scene of size 1, the start and the shape's numbers are off by some u, so that the test puts
//! the crossing at a t of some 10 u / c, where c is the cosine between the ray and the normal: less than 2e-12 where c
//! is above [`LEAST_COSINE`]. Of a triangle, the products of its test are off by some 10 u times the square of its
//! longest edge; their sum is c times twice its area, so c counts as less where the triangle is a sliver.

use dotray_geometry::Affine;
use dotray_geometry::Transform;
use dotray_geometry::Vec3;

/// See above.
const LEAST_COSINE: f64 = 1e-3;

/// A shape that is tested in object coordinates may have them stretched by as much: the product of the Frobenius norms
/// of the matrix and its inverse, 3 for a rotation. Errors grow by no more.
const MOST_STRETCHED: f64 = 8.0;

/// What no ray leaves.
pub const NOTHING: u32 = u32::MAX;

/// How a ray has to leave a surface so as not to meet the same shape again.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Leaving {
    position: u32,
    /// The least cosine between the ray and the normal.
    least: f64,
    /// Whether the other side of the surface will do as well.
    either_side: bool,
}

impl Leaving {
    /// A shape that may always be met again.
    pub const NOTHING: Self = Self { position: NOTHING, least: f64::INFINITY, either_side: false };

    /// A sphere, box or closed cylinder.
    pub fn solid(position: u32) -> Self {
        Self { position, least: LEAST_COSINE, either_side: false }
    }

    /// A sphere, box or closed cylinder of this frame.
    pub fn framed_solid(position: u32, frame: &Transform) -> Self {
        let norm_squared = |map: &Affine| {
            let m = &map.matrix3;
            m.x_axis.length_squared() + m.y_axis.length_squared() + m.z_axis.length_squared()
        };
        let stretched = norm_squared(&frame.world_from_object) * norm_squared(&frame.object_from_world);
        if stretched <= MOST_STRETCHED * MOST_STRETCHED { Self::solid(position) } else { Self::NOTHING }
    }

    /// A triangle with these corners.
    pub fn triangle(position: u32, corners: &[Vec3; 3]) -> Self {
        let [a, b, c] = *corners;
        let (first, second, third) = (b - a, c - a, c - b);
        let longest = first.length_squared().max(second.length_squared()).max(third.length_squared());
        let double_area = first.cross(second).length();
        Self { position, least: LEAST_COSINE * longest / double_area, either_side: true }
    }

    /// The position of the shape if a ray in this direction does not meet it again, else [`NOTHING`]; `outward` is the
    /// shape's own normal.
    #[inline]
    pub fn left_by(&self, direction: Vec3, outward: Vec3) -> u32 {
        let cosine = direction.dot(outward);
        let cosine = if self.either_side { cosine.abs() } else { cosine };
        if cosine > self.least { self.position } else { NOTHING }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use dotray_geometry::Cuboid;
    use dotray_geometry::Cylinder;
    use dotray_geometry::Hit;
    use dotray_geometry::Mat3;
    use dotray_geometry::Ray;
    use dotray_geometry::Shape;
    use dotray_geometry::Sphere;
    use dotray_geometry::Vec2;
    use dotray_geometry::shape::OrientedCylinder;
    use dotray_geometry::shape::Triangle;

    /// Numbers that look random, by the finaliser of splitmix64 (Steele, Lea, Flood, OOPSLA 2014).
    struct Random(u64);

    impl Random {
        /// From 0 to 1.
        fn share(&mut self) -> f64 {
            self.0 = self.0.wrapping_add(0x9e37_79b9_7f4a_7c15);
            let mut hash = self.0;
            hash = (hash ^ (hash >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
            hash = (hash ^ (hash >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
            ((hash ^ (hash >> 31)) >> 11) as f64 / (1_u64 << 53) as f64
        }

        /// Each coordinate from -1 to 1.
        fn vector(&mut self) -> Vec3 {
            let mut coordinate = || 2.0 * self.share() - 1.0;
            Vec3::new(coordinate(), coordinate(), coordinate())
        }

        fn direction(&mut self) -> Vec3 {
            self.vector().normalize_or(Vec3::X)
        }

        /// From 1e-6 to 1, each decade as often.
        fn length(&mut self) -> f64 {
            libm::exp10(-6.0 * self.share())
        }

        /// A direction whose cosine with the normal is from just above the least to 1.
        fn leaving(&mut self, normal: Vec3) -> Vec3 {
            let cosine = LEAST_COSINE * libm::pow(1.0 / LEAST_COSINE, self.share()) * 1.001;
            let aside = self.direction().reject_from_normalized(normal).normalize_or(Vec3::ZERO);
            (normal * cosine.min(1.0) + aside * (1.0 - cosine * cosine).max(0.0).sqrt()).normalize()
        }

        /// A solid in a scene of size 3.
        fn solid(&mut self) -> Shape {
            let center = self.vector();
            match (self.share() * 3.0) as u32 {
                0 => Shape::Sphere(Sphere::new(center, self.length()).expect("a radius")),
                1 => {
                    let size = Vec3::new(self.length(), self.length(), self.length());
                    Shape::Cuboid(Cuboid::new(center, size).expect("edges"))
                }
                _ => {
                    let (radius, height) = (self.length(), self.length());
                    Shape::Cylinder(Cylinder::new(center, radius, height).expect("a radius"))
                }
            }
        }

        /// A turn, and stretched a little.
        fn frame(&mut self) -> Transform {
            let (x, other) = (self.direction(), self.direction());
            let z = x.cross(other).normalize_or(x.any_orthonormal_vector());
            let mut stretched = |axis: Vec3| axis * (0.7 + 0.6 * self.share());
            let matrix = Mat3::from_cols(stretched(x), stretched(z.cross(x)), stretched(z));
            Transform::new(Affine::from_mat3_translation(matrix, self.vector())).expect("invertible")
        }
    }

    /// No t that counts, with room to spare: the scenes here are of size 3.
    fn is_not_met_again(crossings: &[Hit]) -> bool {
        crossings.iter().all(|hit| hit.t < 3e-10)
    }

    #[test]
    fn who_leaves_a_solid_outwards_does_not_meet_it_again() {
        let mut random = Random(1);
        let mut left = 0;
        for _ in 0..400_000 {
            let shape = random.solid();
            let center = shape.bounds().center();
            let origin = center + random.direction() * 2.0;
            let aim = center + (shape.bounds().max - shape.bounds().min) * random.vector() * 0.4;
            let toward = Ray::new(origin, (aim - origin).normalize());
            let frame = random.frame();
            let toward_in_world = toward.transformed(&frame.world_from_object);
            let Some(hit) = shape.intersect(&toward, 1e-9, f64::INFINITY) else { continue };
            let surface = shape.surface(&toward, hit);
            let direction = random.leaving(surface.geometric_normal);
            if Leaving::solid(7).left_by(direction, surface.geometric_normal) == 7 {
                left += 1;
                let again = Ray::new(surface.point, direction);
                assert!(is_not_met_again(shape.crossings(&again).as_slice()), "{shape:?} {again:?}");
                if let Shape::Cylinder(cylinder) = &shape {
                    let oriented = OrientedCylinder::from_object(cylinder, &Affine::IDENTITY, 1.0);
                    assert!(is_not_met_again(oriented.crossings(&again).as_slice()), "{shape:?} {again:?}");
                }
            }
            // The same in a frame.
            let in_object = toward_in_world.transformed(&frame.object_from_world);
            let Some(hit) = shape.intersect(&in_object, 1e-9, f64::INFINITY) else { continue };
            let surface = shape.surface(&in_object, hit);
            let normal = frame.world_normal(surface.geometric_normal);
            let direction = random.leaving(normal);
            if Leaving::framed_solid(7, &frame).left_by(direction, normal) == 7 {
                let again = Ray::new(frame.world_from_object.transform_point3(surface.point), direction);
                let again = again.transformed(&frame.object_from_world);
                assert!(
                    is_not_met_again(shape.crossings(&again).as_slice()),
                    "{shape:?} {frame:?} {again:?}"
                );
            }
        }
        assert!(left > 100_000, "{left}");
    }

    #[test]
    fn who_leaves_a_triangle_does_not_meet_it_again() {
        let mut random = Random(2);
        let mut left = 0;
        for _ in 0..400_000 {
            let corner = random.vector();
            let corners = [
                corner,
                corner + random.vector() * random.length(),
                corner + random.vector() * random.length(),
            ];
            let Ok(triangle) = Triangle::new(corners, [Vec3::ZERO; 3], [Vec2::ZERO; 3]) else { continue };
            let (a, b) = (random.share(), random.share());
            let (a, b) = if a + b > 1.0 { (1.0 - a, 1.0 - b) } else { (a, b) };
            let aim = corners[0] * (1.0 - a - b) + corners[1] * a + corners[2] * b;
            let origin = random.vector();
            let toward = Ray::new(origin, (aim - origin).normalize());
            let Some(hit) = Shape::Triangle(triangle).intersect(&toward, 1e-9, f64::INFINITY) else {
                continue;
            };
            let surface = triangle.surface(&toward, hit);
            let normal = surface.geometric_normal;
            let direction = random.leaving(normal) * if random.share() < 0.5 { 1.0 } else { -1.0 };
            if Leaving::triangle(7, &corners).left_by(direction, normal) == 7 {
                left += 1;
                let again = Ray::new(surface.point, direction);
                assert!(is_not_met_again(triangle.crossings(&again).as_slice()), "{corners:?} {again:?}");
            }
        }
        assert!(left > 50_000, "{left}");
    }

    #[test]
    fn who_goes_in_or_grazes_may_meet_it_again() {
        let solid = Leaving::solid(7);
        assert_eq!(solid.left_by(Vec3::Y, Vec3::Y), 7);
        assert_eq!(solid.left_by(Vec3::NEG_Y, Vec3::Y), NOTHING);
        assert_eq!(solid.left_by(Vec3::new(1.0, 1e-4, 0.0), Vec3::Y), NOTHING);
        let sliver = Leaving::triangle(7, &[Vec3::ZERO, Vec3::X, Vec3::new(0.5, 1e-4, 0.0)]);
        assert_eq!(sliver.left_by(Vec3::Z, Vec3::Z), NOTHING);
        assert_eq!(Leaving::NOTHING.left_by(Vec3::Y, Vec3::Y), NOTHING);
        let flat = Transform::new(Affine::from_scale(Vec3::new(1.0, 1e-3, 1.0))).expect("invertible");
        assert_eq!(Leaving::framed_solid(7, &flat), Leaving::NOTHING);
    }
}

//! The triangle.

use super::ShapeError;
use crate::aabb::Aabb;
use crate::aabb::image_magnitude;
use crate::hit::Crossings;
use crate::hit::Hit;
use crate::hit::Surface;
use crate::hit::Texcoord;
use crate::ray::Ray;
use crate::vector::{Affine, Vec2, Vec3};

/// A triangle: points, normals and texture coordinates of its three corners.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Triangle {
    vertices: [Vec3; 3],
    normals: [Vec3; 3],
    texcoords: [Vec2; 3],
}

impl Triangle {
    /// A triangle; a normal of length 0 counts as the unit face normal (counter-clockwise seen from outside).
    ///
    /// # Errors
    /// Three points on a line (to within rounding); numbers that are not finite.
    pub fn new(vertices: [Vec3; 3], normals: [Vec3; 3], texcoords: [Vec2; 3]) -> Result<Self, ShapeError> {
        let finite =
            vertices.iter().chain(&normals).all(|v| v.is_finite()) && texcoords.iter().all(|t| t.is_finite());
        if !finite {
            return Err(ShapeError::NotFinite);
        }
        let (first, second, cross) = edges_and_cross(&vertices);
        // Rounding the edges and their product leaves up to some 4e-16 of the product of their lengths.
        let has_area = cross.length() > 1e-15 * first.length() * second.length();
        if !has_area {
            return Err(ShapeError::Area);
        }
        Ok(Self { vertices, normals, texcoords })
    }

    /// A triangle with these corners, which have been checked before, and the normals and texture coordinates of this
    /// one.
    #[inline]
    pub const fn with_vertices(&self, vertices: [Vec3; 3]) -> Self {
        Self { vertices, normals: self.normals, texcoords: self.texcoords }
    }

    /// Whether normals and texture coordinates are the same, bit by bit.
    pub fn is_dressed_like(&self, other: &Self) -> bool {
        fn bits<const N: usize>(numbers: [f64; N]) -> [u64; N] {
            numbers.map(f64::to_bits)
        }
        let corner = |triangle: &Self, i: usize| {
            (bits(triangle.normals[i].to_array()), bits(triangle.texcoords[i].to_array()))
        };
        (0..3).all(|i| corner(self, i) == corner(other, i))
    }

    /// The corners.
    #[inline]
    pub const fn vertices(&self) -> &[Vec3; 3] {
        &self.vertices
    }

    /// The normals of the corners, as given.
    #[inline]
    pub const fn normals(&self) -> &[Vec3; 3] {
        &self.normals
    }

    /// The texture coordinates of the corners.
    #[inline]
    pub const fn texcoords(&self) -> &[Vec2; 3] {
        &self.texcoords
    }

    /// See [`super::Shape::crossings`].
    #[inline]
    pub fn crossings(&self, ray: &Ray) -> Crossings {
        intersect_vertices(ray, self.vertices).map_or(Crossings::NONE, |t| Crossings::one(Hit { t, face: 0 }))
    }

    /// See [`super::Shape::surface`].
    pub fn surface(&self, ray: &Ray, _hit: Hit) -> Surface {
        self.surface_at(TriangleRay::new(ray).barycentric(&self.vertices))
    }

    /// The surface at the barycentric coordinates α, β, γ.
    pub fn surface_at(&self, weights: [f64; 3]) -> Surface {
        let [alpha, beta, gamma] = weights;
        let [v1, v2, v3] = self.vertices;
        let [t1, t2, t3] = self.texcoords;
        let geometric_normal = face_normal(&self.vertices);
        Surface {
            point: v1 * alpha + v2 * beta + v3 * gamma,
            geometric_normal,
            shading_normal: interpolated_normal(weights, &self.normals, geometric_normal),
            texcoord: Texcoord::Known(t1 * alpha + t2 * beta + t3 * gamma),
        }
    }

    /// The unit vectors in its plane along which s and t grow fastest; `None` where its texture coordinates stay on
    /// a line.
    pub fn texture_axes(&self) -> Option<[Vec3; 2]> {
        let [v1, v2, v3] = self.vertices;
        let [t1, t2, t3] = self.texcoords;
        let (size, (first, second)) =
            ((v2 - v1).abs().max((v3 - v1).abs()).max_element(), (t2 - t1, t3 - t1));
        let [edge, other] = [v2 / size - v1 / size, v3 / size - v1 / size];
        if first.perp_dot(second) == 0.0 {
            return None;
        }
        // What is 1 more along the one edge and 0 along the other grows along these.
        let normal = edge.cross(other);
        let (along_first, along_second) = (other.cross(normal), normal.cross(edge));
        let slope = |of_first: f64, of_second: f64| along_first * of_first + along_second * of_second;
        Some([slope(first.x, second.x).try_normalize()?, slope(first.y, second.y).try_normalize()?])
    }

    /// See [`super::Shape::bounds`].
    pub fn bounds(&self) -> Aabb {
        self.world_bounds(&Affine::IDENTITY)
    }

    /// See [`super::Shape::world_bounds`].
    pub fn world_bounds(&self, world_from_object: &Affine) -> Aabb {
        corner_bounds(&self.vertices, world_from_object)
    }
}

/// The box in the world of a triangle with these corners.
pub fn corner_bounds(vertices: &[Vec3; 3], world_from_object: &Affine) -> Aabb {
    let [v1, v2, v3] = vertices.map(|v| v.abs());
    Aabb::around(vertices.map(|v| world_from_object.transform_point3(v)))
        .padded(image_magnitude(world_from_object, v1.max(v2).max(v3)))
}

/// The unit normal of the side from which the corners run counter-clockwise; +y where they have no area.
pub fn face_normal(vertices: &[Vec3; 3]) -> Vec3 {
    let (_, _, cross) = edges_and_cross(vertices);
    cross.normalize_or(Vec3::Y)
}

/// The sum of the corners' normals by their barycentric weights, at the lengths given: a normal of length 0 counts
/// as `face_normal`, and so does a sum of 0. Not renormalised, but of a length that can be.
pub fn interpolated_normal(weights: [f64; 3], normals: &[Vec3; 3], face_normal: Vec3) -> Vec3 {
    let [n1, n2, n3] = normals.map(|n| if n == Vec3::ZERO { face_normal } else { n });
    let sum = n1 * weights[0] + n2 * weights[1] + n3 * weights[2];
    if (1e-200..1e200).contains(&sum.length_squared()) {
        return sum;
    }
    // The square of the length may have left the range of f64.
    let size = sum.abs().max_element();
    if size > 0.0 && size.is_finite() { sum / size } else { face_normal }
}

/// Two edges and their cross product, all three brought to sizes near 1 where squares might overflow or vanish.
fn edges_and_cross(vertices: &[Vec3; 3]) -> (Vec3, Vec3, Vec3) {
    let [v1, v2, v3] = *vertices;
    let (first, second) = (v2 - v1, v3 - v1);
    let size = first.abs().max(second.abs()).max_element();
    if (1e-50..1e50).contains(&size) {
        return (first, second, first.cross(second));
    }
    let (first, second) = (v2 / size - v1 / size, v3 / size - v1 / size);
    (first, second, first.cross(second))
}

/// The ray's parameter where it meets the triangle with these corners, from either side.
///
/// Two triangles that share an edge (the same two corners, bit by bit) leave no gap between them.
#[inline]
pub fn intersect_vertices(ray: &Ray, vertices: [Vec3; 3]) -> Option<f64> {
    TriangleRay::new(ray).intersect(&vertices)
}

/// A ray made ready to meet many triangles.
///
/// Watertight after Woop, Benthin and Wald, 'Watertight Ray/Triangle Intersection', JCGT 2013: the triangle is
/// moved so that the ray starts at 0, and sheared so that it runs along its largest axis; then the signs of three
/// plane products say on which side of each edge it passes. An edge seen from its other triangle gives exactly the
/// opposite product, and 0 counts as inside on both. Unlike the paper we tell no front from back, so the other two
/// axes need no swapping, and have no wider type for products of 0, which need none when 0 is inside.
#[derive(Clone, Copy, Debug)]
pub struct TriangleRay {
    origin: Vec3,
    main_axis: Axis,
    shear_x: f64,
    shear_y: f64,
    per_z: f64,
}

#[derive(Clone, Copy, Debug)]
enum Axis {
    X,
    Y,
    Z,
}

impl Axis {
    /// The coordinates in cyclic order, such that this axis is the last.
    #[inline]
    fn to_last(self, v: Vec3) -> Vec3 {
        match self {
            Self::X => Vec3::new(v.y, v.z, v.x),
            Self::Y => Vec3::new(v.z, v.x, v.y),
            Self::Z => v,
        }
    }
}

/// How a ray passes a triangle: for each corner the product of the edge across from it, and their sum.
struct Passage {
    products: [f64; 3],
    sum: f64,
    /// The corners' distances along the ray.
    depths: [f64; 3],
}

impl TriangleRay {
    /// The axis and the shear of a ray.
    #[inline]
    pub fn new(ray: &Ray) -> Self {
        let size = ray.direction.abs();
        let main_axis = if size.x > size.y && size.x > size.z {
            Axis::X
        } else if size.y > size.z {
            Axis::Y
        } else {
            Axis::Z
        };
        let direction = main_axis.to_last(ray.direction);
        Self {
            origin: ray.origin,
            main_axis,
            shear_x: direction.x / direction.z,
            shear_y: direction.y / direction.z,
            per_z: 1.0 / direction.z,
        }
    }

    /// The ray's parameter where it meets the triangle: [`intersect_vertices`] to the last bit.
    #[inline]
    pub fn intersect(&self, vertices: &[Vec3; 3]) -> Option<f64> {
        let Passage { products: [u, v, w], sum, depths } = self.pass(vertices);
        let inside = (u >= 0.0 && v >= 0.0 && w >= 0.0) || (u <= 0.0 && v <= 0.0 && w <= 0.0);
        // The sum is 0 where the ray runs in the triangle's plane.
        (inside && sum != 0.0).then(|| (u * depths[0] + v * depths[1] + w * depths[2]) / sum)
    }

    /// The barycentric coordinates α, β, γ of the point where the ray meets the triangle's plane, from the very
    /// numbers that decided the hit; thirds where it does not.
    #[inline]
    pub fn barycentric(&self, vertices: &[Vec3; 3]) -> [f64; 3] {
        let Passage { products, sum, .. } = self.pass(vertices);
        if sum == 0.0 { [1.0 / 3.0; 3] } else { products.map(|product| product / sum) }
    }

    #[inline]
    fn pass(&self, vertices: &[Vec3; 3]) -> Passage {
        // Written out: `array::map` is a loop of the library that is not always inlined.
        let seen = |vertex: Vec3| self.main_axis.to_last(vertex - self.origin);
        let (a, b, c) = (seen(vertices[0]), seen(vertices[1]), seen(vertices[2]));
        let sheared = |p: Vec3| Vec2::new(p.x - self.shear_x * p.z, p.y - self.shear_y * p.z);
        let (a2, b2, c2) = (sheared(a), sheared(b), sheared(c));
        let u = c2.x * b2.y - c2.y * b2.x;
        let v = a2.x * c2.y - a2.y * c2.x;
        let w = b2.x * a2.y - b2.y * a2.x;
        Passage {
            products: [u, v, w],
            sum: u + v + w,
            depths: [a.z * self.per_z, b.z * self.per_z, c.z * self.per_z],
        }
    }
}

#[cfg(test)]
mod tests {
    use super::Triangle;
    use super::TriangleRay;
    use super::intersect_vertices;
    use crate::ray::Ray;
    use crate::shape::ShapeError;
    use crate::vector::{Vec2, Vec3};

    const CORNERS: [Vec3; 3] = [Vec3::new(0.0, 0.0, 2.0), Vec3::new(4.0, 0.0, 2.0), Vec3::new(0.0, 4.0, 2.0)];

    fn t_of(origin: [f64; 3], direction: [f64; 3]) -> Option<f64> {
        intersect_vertices(&Ray::new(Vec3::from_array(origin), Vec3::from_array(direction)), CORNERS)
    }

    fn with_normals(normals: [Vec3; 3]) -> Triangle {
        Triangle::new(CORNERS, normals, [Vec2::ZERO, Vec2::X, Vec2::Y]).unwrap()
    }

    #[test]
    fn meets_rays_from_both_sides() {
        assert_eq!(t_of([1.0, 1.0, 5.0], [0.0, 0.0, -1.0]), Some(3.0));
        assert_eq!(t_of([1.0, 1.0, -5.0], [0.0, 0.0, 2.0]), Some(3.5));
        assert_eq!(t_of([1.0, 1.0, 5.0], [0.0, 0.0, 1.0]), Some(-3.0), "behind");
        assert_eq!(t_of([3.0, 3.0, 5.0], [0.0, 0.0, -1.0]), None);
        assert_eq!(t_of([-0.1, 1.0, 5.0], [0.0, 0.0, -1.0]), None);
        assert_eq!(t_of([-9.0, 1.0, -8.0], [1.0, 0.0, 1.0]), Some(10.0), "a slanted ray");
        assert_eq!(t_of([-9.0, 1.0, 2.0], [1.0, 0.0, 0.0]), None, "a ray in the plane");
        assert_eq!(t_of([1.0, 1.0, 5.0], [0.0, 0.0, 0.0]), None);
    }

    #[test]
    fn edges_and_corners_belong_to_it() {
        for [x, y] in [[0.0, 0.0], [4.0, 0.0], [0.0, 4.0], [2.0, 0.0], [0.0, 1.5], [2.0, 2.0]] {
            assert_eq!(t_of([x, y, 0.0], [0.0, 0.0, 1.0]), Some(2.0));
        }
    }

    #[test]
    fn every_axis_can_be_the_main_one() {
        let turned = |v: Vec3, by: usize| if by == 0 { v } else { Vec3::new(v.z, v.x, v.y) };
        let (mut corners, mut ray) = (CORNERS, Ray::new(Vec3::new(1.0, 1.5, 5.0), Vec3::new(0.1, 0.2, -1.0)));
        for _ in 0..3 {
            assert!((intersect_vertices(&ray, corners).unwrap() - 3.0).abs() < 1e-14);
            let [alpha, beta, gamma] = TriangleRay::new(&ray).barycentric(&corners);
            assert!((alpha + beta + gamma - 1.0).abs() < 1e-15);
            assert!((beta - 1.3 / 4.0).abs() < 1e-15 && (gamma - 2.1 / 4.0).abs() < 1e-15);
            corners = corners.map(|v| turned(v, 1));
            ray = Ray::new(turned(ray.origin, 1), turned(ray.direction, 1));
        }
    }

    #[test]
    fn tells_bad_numbers() {
        let normals = [Vec3::Z; 3];
        let of = |corners| Triangle::new(corners, normals, [Vec2::ZERO; 3]);
        assert_eq!(of([Vec3::ZERO, Vec3::X, Vec3::X * 2.0]), Err(ShapeError::Area));
        assert_eq!(of([Vec3::ZERO, Vec3::X, Vec3::X]), Err(ShapeError::Area));
        assert_eq!(of([Vec3::ONE; 3]), Err(ShapeError::Area));
        let step = Vec3::new(0.1, 0.2, 0.3);
        assert_eq!(of([step, step * 2.0, step * 3.0]), Err(ShapeError::Area), "but for rounding on a line");
        assert_eq!(of([Vec3::ZERO, Vec3::X, Vec3::NAN]), Err(ShapeError::NotFinite));
        let bad_texcoords = [Vec2::ZERO, Vec2::NAN, Vec2::ZERO];
        assert_eq!(Triangle::new(CORNERS, normals, bad_texcoords), Err(ShapeError::NotFinite));
        for size in [1e-300, 1e-200, 1e-100, 1e100, 1e300] {
            let triangle = of(CORNERS.map(|v| v * size)).unwrap();
            assert_eq!(super::face_normal(triangle.vertices()), Vec3::Z);
        }
        assert!(of([Vec3::ZERO, Vec3::X, Vec3::new(0.5, 1e-14, 0.0)]).is_ok(), "a sliver");
    }

    #[test]
    fn describes_its_surface() {
        let ray = Ray::new(Vec3::new(1.0, 2.0, 5.0), Vec3::NEG_Z);
        let shading_normal = |normals| {
            let triangle = with_normals(normals);
            let surface = triangle.surface(&ray, triangle.crossings(&ray).as_slice()[0]);
            assert_eq!((surface.point, surface.geometric_normal), (Vec3::new(1.0, 2.0, 2.0), Vec3::Z));
            assert_eq!(surface.texcoord.get(), Vec2::new(0.25, 0.5));
            surface.shading_normal
        };
        // Lengths count: α = ¼, β = ¼, γ = ½.
        let uneven = [Vec3::X * 4.0, Vec3::Y * 2.0, Vec3::Z];
        assert_eq!(shading_normal(uneven), Vec3::new(1.0, 0.5, 0.5));
        assert_eq!(shading_normal([Vec3::X * 4.0, Vec3::ZERO, Vec3::X]), Vec3::new(1.5, 0.0, 0.25));
        assert_eq!(shading_normal([Vec3::X, Vec3::X, Vec3::NEG_X]), Vec3::Z, "a sum of zero");
        assert_eq!(shading_normal([Vec3::ZERO; 3]), Vec3::Z);
        assert_eq!(shading_normal([Vec3::X * 1e-250; 3]), Vec3::X);
        assert_eq!(shading_normal([Vec3::X * 1e250; 3]), Vec3::X);
    }
}

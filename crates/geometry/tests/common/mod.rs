//! Random shapes, maps and rays, and a measure of inside and outside that shares nothing with the intersections.

// Each test program uses its own part of this file.
#![allow(dead_code)]

use dotray_geometry::{
    Affine, Cone, Cuboid, Cylinder, Mat3, Ray, Shape, Sphere, Torus, Triangle, Vec2, Vec3,
};
use proptest::array::uniform3;
use proptest::prelude::*;

/// So many random cases, and no file written where one fails: a case worth keeping becomes a test of its own.
pub fn config(cases: u32) -> ProptestConfig {
    ProptestConfig {
        cases,
        failure_persistence: None,
        max_global_rejects: 10 * cases,
        ..ProptestConfig::default()
    }
}

/// A point of the cube of half width `reach`.
pub fn point(reach: f64) -> impl Strategy<Value = Vec3> {
    uniform3(-reach..reach).prop_map(Vec3::from_array)
}

/// A direction of length 1, now and then one along or across an axis.
pub fn unit() -> impl Strategy<Value = Vec3> {
    let free = point(1.0).prop_filter("too short", |v| v.length() > 0.1).prop_map(Vec3::normalize);
    prop_oneof![
        8 => free,
        1 => prop::sample::select(vec![Vec3::X, Vec3::NEG_X, Vec3::Y, Vec3::NEG_Y, Vec3::Z, Vec3::NEG_Z]),
        1 => (-3.2..3.2f64).prop_map(|turn| Vec3::new(libm::cos(turn), 0.0, libm::sin(turn))),
    ]
}

/// From a thousandth to a thousand, evenly over the sizes.
pub fn length() -> impl Strategy<Value = f64> {
    (-3.0..3.0f64).prop_map(|exponent| libm::pow(10.0, exponent))
}

/// A closed shape of any proportions.
pub fn solid() -> impl Strategy<Value = Shape> {
    let center = || point(10.0);
    prop_oneof![
        (center(), length()).prop_map(|(c, r)| Shape::Sphere(Sphere::new(c, r).unwrap())),
        (center(), uniform3(length()))
            .prop_map(|(c, size)| { Shape::Cuboid(Cuboid::new(c, Vec3::from_array(size)).unwrap()) }),
        (center(), length(), length()).prop_map(|(c, r, h)| Shape::Cylinder(Cylinder::new(c, r, h).unwrap())),
        (center(), length(), length()).prop_map(|(c, r, h)| Shape::Cone(Cone::new(c, r, h).unwrap())),
        (center(), length(), 0.01..1.0f64)
            .prop_map(|(c, ring, part)| Shape::Torus(Torus::new(c, ring * part, ring).unwrap())),
    ]
}

/// A triangle with given normals and texture coordinates.
pub fn triangle() -> impl Strategy<Value = Shape> {
    uniform3(point(10.0)).prop_filter_map("no area", |vertices| {
        Triangle::new(vertices, [Vec3::X, Vec3::Y, Vec3::Z], [Vec2::ZERO, Vec2::X, Vec2::Y])
            .ok()
            .map(Shape::Triangle)
    })
}

/// A map with shear, mirroring and uneven scales.
pub fn affine() -> impl Strategy<Value = Affine> {
    (prop::array::uniform9(-3.0..3.0f64), point(20.0)).prop_filter_map(
        "nearly singular",
        |(entries, translation)| {
            let matrix = Mat3::from_cols_array(&entries);
            (matrix.determinant().abs() > 0.05).then(|| Affine::from_mat3_translation(matrix, translation))
        },
    )
}

/// A rotation or reflection with one scale, and the scale.
pub fn similarity() -> impl Strategy<Value = (Affine, f64)> {
    (unit(), -3.2..3.2f64, length(), any::<bool>(), point(20.0)).prop_map(
        |(axis, angle, scale, mirror, translation)| {
            let sign = if mirror { -1.0 } else { 1.0 };
            let matrix =
                Mat3::from_axis_angle(axis, angle) * Mat3::from_diagonal(Vec3::new(sign, 1.0, 1.0) * scale);
            (Affine::from_mat3_translation(matrix, translation), scale)
        },
    )
}

/// The numbers of which [`ray_near`] makes a ray.
pub type Aim = (Vec3, Vec3, f64, f64);

/// Where to aim at, from which direction, at which distance, and the length of the direction.
pub fn aim() -> impl Strategy<Value = Aim> {
    let far = (0.0..9.0f64).prop_map(|exponent| libm::pow(10.0, exponent));
    let distance = prop_oneof![1 => Just(0.0), 2 => 0.0..3.0f64, 1 => far];
    let length = (-30.0..30.0f64).prop_map(|exponent| libm::pow(10.0, exponent));
    (point(1.3), unit(), distance, prop_oneof![Just(1.0), length])
}

/// A ray that passes through a point in or near the shape's box, from a distance counted in the box's size.
pub fn ray_near(shape: &Shape, (target, unit, distance, length): Aim) -> Ray {
    let bounds = shape.bounds();
    let target = bounds.center() + bounds.size() * 0.5 * target;
    Ray::new(target - unit * (distance * bounds.size().length()), unit * length)
}

/// How deep inside the shape a point lies (negative outside), in no exact unit but of the size of a distance near
/// the surface.
pub fn depth(shape: &Shape, p: Vec3) -> f64 {
    match shape {
        Shape::Sphere(s) => s.radius() - p.distance(s.center()),
        Shape::Cuboid(c) => (c.size() * 0.5 - (p - c.center()).abs()).min_element(),
        Shape::Cylinder(c) => {
            let p = p - c.center();
            (c.height() * 0.5 - p.y.abs()).min(c.radius() - libm::hypot(p.x, p.z))
        }
        Shape::Cone(c) => {
            let p = p - c.center();
            let below_apex = c.height() * 0.5 - p.y;
            // The distance to the side is the horizontal gap times the cosine of the side's slope.
            let gap = below_apex * c.radius() / c.height() - libm::hypot(p.x, p.z);
            (p.y + c.height() * 0.5).min(gap * c.height() / libm::hypot(c.radius(), c.height()))
        }
        Shape::Torus(torus) => {
            let p = p - torus.center();
            torus.tube() - libm::hypot(libm::hypot(p.x, p.z) - torus.ring(), p.y)
        }
        Shape::Triangle(_) | Shape::Open(_) => f64::NAN,
    }
}

//! World boxes hold every hit, and no more room than they need.

mod common;

use common::{affine, aim, point, ray_near, solid, triangle};
use dotray_geometry::{Aabb, Affine, Cone, Cuboid, Cylinder, Hit, Ray, Shape, Vec2, Vec3};
use proptest::prelude::*;

/// A point of the surface for two numbers in 0..=1, by the shape's own parametrisation; `part` picks a face.
fn surface_point(shape: &Shape, part: u8, s: f64, t: f64) -> Vec3 {
    let turn = s * std::f64::consts::TAU;
    let round = Vec3::new(libm::cos(turn), 0.0, libm::sin(turn));
    let sign = if part == 0 { -1.0 } else { 1.0 };
    match shape {
        Shape::Sphere(sphere) => {
            let tilt = t * std::f64::consts::PI;
            sphere.center() + (round * libm::sin(tilt) + Vec3::Y * libm::cos(tilt)) * sphere.radius()
        }
        Shape::Cuboid(cuboid) => {
            let corner = Vec3::new(sign, (2.0 * s - 1.0).signum(), (2.0 * t - 1.0).signum());
            cuboid.center() + cuboid.size() * 0.5 * corner
        }
        Shape::Cylinder(cylinder) => {
            cylinder.center() + round * cylinder.radius() + Vec3::Y * (sign * 0.5 * cylinder.height())
        }
        Shape::Cone(cone) if part == 0 => cone.center() + Vec3::Y * (0.5 * cone.height()),
        Shape::Cone(cone) => cone.center() + round * cone.radius() - Vec3::Y * (0.5 * cone.height()),
        Shape::Torus(torus) => {
            let across = t * std::f64::consts::TAU;
            let radius = torus.ring() + torus.tube() * libm::cos(across);
            torus.center() + round * radius + Vec3::Y * (torus.tube() * libm::sin(across))
        }
        Shape::Triangle(triangle) => triangle.vertices()[usize::from(part % 3)],
        Shape::Open(_) => Vec3::NAN,
    }
}

fn check_hits(shape: &Shape, to_world: &Affine, ray: &Ray) -> Result<(), TestCaseError> {
    let bounds = shape.world_bounds(to_world);
    for &hit in shape.crossings(ray).as_slice() {
        let point = to_world.transform_point3(shape.surface(ray, hit).point);
        prop_assert!(bounds.contains(point), "{:?} {}", bounds, point);
    }
    Ok(())
}

proptest! {
    #![proptest_config(common::config(10_000))]

    #[test]
    fn hits_lie_in_the_world_bounds(shape in solid(), to_world in affine(), aim in aim()) {
        check_hits(&shape, &to_world, &ray_near(&shape, aim))?;
    }

    #[test]
    fn hits_of_triangles_lie_in_the_world_bounds(shape in triangle(), to_world in affine(),
        weights in (0.0..1.0f64, 0.0..1.0f64),
                                                 origin in point(50.0)) {
        let Shape::Triangle(triangle) = shape else { unreachable!() };
        let [a, b, c] = *triangle.vertices();
        let (beta, gamma) = if weights.0 + weights.1 > 1.0 { (1.0 - weights.0, 1.0 - weights.1) } else { weights };
        let target = a + (b - a) * beta + (c - a) * gamma;
        let ray = Ray::new(origin, target - origin);
        check_hits(&shape, &to_world, &ray)?;
        // The hit is the target, and what is interpolated there is what its coordinates say.
        let normal = dotray_geometry::face_normal(triangle.vertices());
        prop_assume!((target - origin).normalize().dot(normal).abs() > 1e-3);
        prop_assume!(beta.min(gamma).min(1.0 - beta - gamma) > 1e-6);
        let hit = shape.intersect(&ray, 0.0, 2.0).unwrap();
        prop_assert!((hit.t - 1.0).abs() < 1e-11);
        let surface = shape.surface(&ray, hit);
        prop_assert!(surface.point.distance(target) < 1e-9);
        prop_assume!((b - a).cross(c - a).length() > 1.0);
        prop_assert!((surface.texcoord.get() - Vec2::new(beta, gamma)).length() < 1e-9);
        prop_assert!((surface.shading_normal - Vec3::new(1.0 - beta - gamma, beta, gamma)).length() < 1e-9);
        prop_assert!(surface.geometric_normal.dot((b - a).cross(c - a)) > 0.0);
    }
}

#[test]
fn surfaces_stay_within_the_shape_wherever_rounding_put_the_hit() {
    // From far away, or where the hit was found in the world's own form of the shape, the ray's point may lie
    // beside the part of the surface that was hit, and at a rim the other face may be told.
    let ray = Ray::new(Vec3::new(3.0, 3.0, 0.0), Vec3::new(-1.0, -1.0, 0.0));
    let cylinder = Shape::Cylinder(Cylinder::new(Vec3::ZERO, 1.0, 2.0).unwrap());
    let cone = Shape::Cone(Cone::new(Vec3::ZERO, 1.0, 2.0).unwrap());
    let cuboid = Shape::Cuboid(Cuboid::new(Vec3::ZERO, Vec3::splat(2.0)).unwrap());
    for shape in [cylinder, cone, cuboid] {
        for face in 0..6 {
            for t in [1.0, 1.999, 2.0, 2.001, 3.999, 4.001, 6.0] {
                let point = shape.surface(&ray, Hit { t, face }).point;
                assert!(shape.bounds().contains(point), "{shape:?} {face} {t} {point}");
            }
        }
    }
}

proptest! {
    #![proptest_config(common::config(300))]

    #[test]
    fn world_bounds_are_tight(shape in prop_oneof![4 => solid(), 1 => triangle()], to_world in affine()) {
        let mut reached = Aabb::EMPTY;
        for part in 0..3 {
            for i in 0..=200 {
                for j in 0..=(if matches!(shape, Shape::Sphere(_) | Shape::Torus(_)) { 100 } else { 2 }) {
                    let steps = if matches!(shape, Shape::Sphere(_) | Shape::Torus(_)) { 100.0 } else { 2.0 };
                    let (s, t) = (f64::from(i) / 200.0, f64::from(j) / steps);
                    reached = reached.grown(to_world.transform_point3(surface_point(&shape, part, s, t)));
                }
            }
        }
        let bounds = shape.world_bounds(&to_world);
        prop_assert!(bounds.contains(reached.min) && bounds.contains(reached.max));
        let spare = (reached.min - bounds.min).max(bounds.max - reached.max);
        prop_assert!(spare.cmple(reached.size() * 1e-3 + 1e-12).all(), "{} of {}", spare, reached.size());
    }
}

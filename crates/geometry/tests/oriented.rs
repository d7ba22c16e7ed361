//! The world's cylinders and cones against those of their own coordinates.

mod common;

use common::{aim, length, point, ray_near, similarity};
use dotray_geometry::{
    Cone, Crossings, Cylinder, OrientedCone, OrientedCylinder, Ray, Shape, Transform, Vec3,
};
use glam::DQuat as Quat;
use proptest::prelude::*;

/// Compares crossings but near a tangent, where roots move by the square root of a rounding.
fn check(
    shape: &Shape,
    to_world: &Transform,
    aim: common::Aim,
    cross: impl Fn(&Ray) -> Crossings,
    normal: impl Fn(&Ray, dotray_geometry::Hit) -> Vec3,
) -> Result<(), TestCaseError> {
    let ray_in_object = ray_near(shape, aim);
    let ray = ray_in_object.transformed(&to_world.world_from_object);
    let expected = shape.crossings(&ray.transformed(&to_world.object_from_world));
    let found = cross(&ray);
    let size = shape.bounds().size().min_element();
    let chord = |crossings: &Crossings| match crossings.as_slice() {
        [enter, leave] => (leave.t - enter.t) * ray_in_object.direction.length(),
        _ => 0.0,
    };
    let reach =
        shape.bounds().size().length() + shape.bounds().center().length() + ray_in_object.origin.length();
    if chord(&expected).max(chord(&found)) < 1e-3 * size || size < 1e-4 * reach {
        return Ok(());
    }
    prop_assert_eq!(found.as_slice().len(), 2);
    prop_assert_eq!(expected.as_slice().len(), 2);
    for (a, b) in found.as_slice().iter().zip(expected.as_slice()) {
        prop_assert!((a.t - b.t).abs() * ray_in_object.direction.length() <= 1e-9 * reach, "{:?} {:?}", a, b);
        let surface = shape.surface(&ray_in_object, *b);
        // At a rim either face may be told, and near the apex the normal may be any.
        if a.face == b.face && normal_is_certain(shape, surface.point) {
            let expected = to_world.world_normal(surface.geometric_normal);
            prop_assert!((normal(&ray, *a) - expected).length() < 1e-6);
        }
    }
    Ok(())
}

fn normal_is_certain(shape: &Shape, point: Vec3) -> bool {
    match shape {
        Shape::Cone(cone) => cone.center().y + cone.height() * 0.5 - point.y > 0.05 * cone.height(),
        Shape::Sphere(_)
        | Shape::Cuboid(_)
        | Shape::Cylinder(_)
        | Shape::Triangle(_)
        | Shape::Torus(_)
        | Shape::Open(_) => true,
    }
}

proptest! {
    #![proptest_config(common::config(20_000))]

    #[test]
    fn cylinders_agree(
        center in point(10.0), radius in length(), height in length(), map in similarity(), aim in aim(),
    ) {
        let cylinder = Cylinder::new(center, radius, height).unwrap();
        let to_world = Transform::new(map.0).unwrap();
        let scale = to_world.similarity_scale().unwrap();
        prop_assert!((scale / map.1 - 1.0).abs() < 1e-14);
        let oriented = OrientedCylinder::from_object(&cylinder, &map.0, scale);
        let shape = Shape::Cylinder(cylinder);
        check(&shape, &to_world, aim, |ray| oriented.crossings(ray), |ray, hit| oriented.normal(ray, hit))?;
    }

    #[test]
    fn cones_agree(center in point(10.0), radius in length(), height in length(), map in similarity(), aim in aim()) {
        let cone = Cone::new(center, radius, height).unwrap();
        let to_world = Transform::new(map.0).unwrap();
        let oriented = OrientedCone::from_object(&cone, &map.0, map.1);
        check(&Shape::Cone(cone), &to_world, aim, |ray| oriented.crossings(ray), |ray, hit| oriented.normal(ray, hit))?;
    }

    #[test]
    fn rays_along_a_slanted_axis_hit_both_caps(map in similarity(), x in -0.7..0.7f64, z in -0.7..0.7f64,
                                               miss in 1.01..5.0f64) {
        let cylinder = Cylinder::new(Vec3::ZERO, 1.0, 2.0).unwrap();
        let oriented = OrientedCylinder::from_object(&cylinder, &map.0, map.1);
        let inside = Ray::new(Vec3::new(x, 5.0, z), Vec3::NEG_Y).transformed(&map.0);
        let crossings = oriented.crossings(&inside);
        prop_assert_eq!(crossings.as_slice().iter().map(|hit| hit.face).collect::<Vec<_>>(), [1, 2]);
        let beside = Ray::new(Vec3::new(miss, 5.0, 0.0), Vec3::NEG_Y).transformed(&map.0);
        prop_assert!(oriented.crossings(&beside).as_slice().is_empty());
        // The very axis as direction: what is left across it is nothing but rounding, in any direction.
        let across = oriented.axis().any_orthonormal_vector();
        let across = Quat::from_axis_angle(oriented.axis(), x * 5.0) * across * map.1;
        for (offset, count) in [(0.9999, 2), (1.0001, 0)] {
            let along = Ray::new(oriented.base() + across * offset, oriented.axis() * miss);
            prop_assert_eq!(oriented.crossings(&along).as_slice().len(), count);
        }
    }
}

//! Crossings of every solid against an independent measure of inside and outside.

mod common;

use common::{aim, depth, ray_near, solid};
use dotray_geometry::{Cone, Cuboid, Ray, Shape, Vec3};
use proptest::prelude::*;

/// The size of the numbers that went into a point of the ray near the shape.
fn magnitude(shape: &Shape, ray: &Ray) -> f64 {
    let bounds = shape.bounds();
    bounds.max.abs().max(bounds.min.abs()).max_element() + ray.origin.abs().max_element()
}

/// Walks along the line and compares every sample with the interval between the crossings.
fn check_samples(shape: &Shape, ray: &Ray) -> Result<(), TestCaseError> {
    let crossings = shape.crossings(ray);
    let hits = crossings.as_slice();
    let most = if matches!(shape, Shape::Torus(_)) { 4 } else { 2 };
    prop_assert!(hits.len().is_multiple_of(2) && hits.len() <= most);
    let bounds = shape.bounds();
    let reach = bounds.size().length() / ray.direction.length();
    let t_middle = (bounds.center() - ray.origin).dot(ray.direction) / ray.direction.length_squared();
    let slack = 1e-11 * magnitude(shape, ray);
    let fractions = (-100..=100).map(|i| f64::from(i) / 100.0);
    let evenly = fractions.clone().map(|fraction| t_middle + fraction * reach);
    let between = fractions
        .filter_map(|x| hits.get(1).map(|leave| hits[0].t + (x * 0.6 + 0.5) * (leave.t - hits[0].t)));
    for t in evenly.chain(between) {
        let depth = depth(shape, ray.at(t));
        if depth.abs() > slack {
            let claimed = hits.chunks(2).any(|part| part[0].t <= t && t <= part[1].t);
            prop_assert_eq!(depth > 0.0, claimed, "at t = {}, depth {}, slack {}", t, depth, slack);
        }
    }
    Ok(())
}

proptest! {
    #![proptest_config(common::config(20_000))]

    #[test]
    fn the_part_between_the_crossings_is_inside(shape in solid(), aim in aim()) {
        check_samples(&shape, &ray_near(&shape, aim))?;
    }

    #[test]
    fn hits_lie_on_the_surface(shape in solid(), aim in aim()) {
        let ray = ray_near(&shape, aim);
        let crossings = shape.crossings(&ray);
        let scale = magnitude(&shape, &ray);
        let mut previous = f64::NEG_INFINITY;
        for &hit in crossings.as_slice() {
            prop_assert!(previous <= hit.t && hit.t.is_finite());
            previous = hit.t;
            let raw = ray.at(hit.t);
            prop_assert!(depth(&shape, raw).abs() <= 1e-12 * scale, "depth {}", depth(&shape, raw));
            let surface = shape.surface(&ray, hit);
            let own_size = shape.bounds().max.abs().max(shape.bounds().min.abs()).max_element();
            prop_assert!(depth(&shape, surface.point).abs() <= 1e-15 * 8.0 * own_size);
            // At the rim of a flat cone, rounding along the axis is a longer way along the side.
            let flatness = shape.bounds().size().max_element() / shape.bounds().size().min_element();
            prop_assert!(surface.point.distance(raw) <= 1e-12 * scale * flatness);
            prop_assert!(shape.bounds().contains(surface.point));
            prop_assert!((surface.geometric_normal.length() - 1.0).abs() < 1e-15 * 4.0);
            prop_assert_eq!(surface.shading_normal, surface.geometric_normal);
            prop_assert!((-1e-15..=1.0 + 1e-15).contains(&surface.texcoord.get().x), "{}", surface.texcoord.get());
            prop_assert!((-1e-15..=1.0 + 1e-15).contains(&surface.texcoord.get().y), "{}", surface.texcoord.get());
        }
    }

    #[test]
    fn normals_point_out(shape in solid(), aim in aim()) {
        let ray = ray_near(&shape, aim);
        let size = shape.bounds().size().min_element();
        for &hit in shape.crossings(&ray).as_slice() {
            let surface = shape.surface(&ray, hit);
            let step = surface.geometric_normal * (1e-4 * size);
            // Where numbers are much larger than the shape, the step drowns in rounding.
            prop_assume!(magnitude(&shape, &ray) < 1e6 * size);
            prop_assert!(depth(&shape, surface.point + step) < 0.0);
        }
    }

    #[test]
    fn crossings_do_not_depend_on_the_length_of_the_direction(shape in solid(), aim in aim(), power in -90..90i32) {
        let ray = ray_near(&shape, (aim.0, aim.1, aim.2, 1.0));
        let factor = libm::scalbn(1.0, power);
        let scaled = Ray::new(ray.origin, ray.direction * factor);
        let (plain, stretched) = (shape.crossings(&ray), shape.crossings(&scaled));
        prop_assert_eq!(plain.as_slice().len(), stretched.as_slice().len());
        for (a, b) in plain.as_slice().iter().zip(stretched.as_slice()) {
            prop_assert_eq!((a.t, a.face), (b.t * factor, b.face));
        }
    }

    #[test]
    fn a_rectangle_is_met_once(center in common::point(5.0), axis in 0..3usize, edges in (0.1..4.0f64, 0.1..4.0f64),
                               aim in aim()) {
        let mut size = Vec3::ZERO;
        (size[(axis + 1) % 3], size[(axis + 2) % 3]) = edges;
        let rectangle = Cuboid::new(center, size).unwrap();
        let shape = Shape::Cuboid(rectangle);
        let ray = ray_near(&shape, aim);
        let crossings = shape.crossings(&ray);
        let t = (center[axis] - ray.origin[axis]) / ray.direction[axis];
        let gap = ((ray.at(t) - center).abs() - size * 0.5).to_array();
        let outside = gap[(axis + 1) % 3].max(gap[(axis + 2) % 3]);
        if ray.direction[axis] == 0.0 {
            prop_assert!(crossings.as_slice().is_empty());
        } else if outside.abs() > 1e-9 * (1.0 + ray.origin.abs().max_element()) {
            prop_assert_eq!(crossings.as_slice().len(), usize::from(outside < 0.0));
        }
        for &hit in crossings.as_slice() {
            prop_assert_eq!(hit.t, t);
            let normal = shape.surface(&ray, hit).geometric_normal;
            prop_assert!(normal[axis] * ray.direction[axis] < 0.0, "the face towards the ray");
        }
    }

    #[test]
    fn rays_at_the_apex_are_told_apart(radius in 0.1..10.0f64, height in 0.1..10.0f64, unit in common::unit(),
                                       distance in 0.1..100.0f64) {
        let cone = Cone::new(Vec3::ZERO, radius, height).unwrap();
        let apex = Vec3::new(0.0, height * 0.5, 0.0);
        let ray = Ray::new(apex - unit * distance, unit);
        let steepness = unit.y.abs() * radius - libm::hypot(unit.x, unit.z) * height;
        let crossings = cone.crossings(&ray);
        // Steeper than the side, the ray crosses from the apex to the base; flatter, it touches the apex at most.
        if steepness > 1e-9 {
            prop_assert_eq!(crossings.as_slice().len(), 2);
            let mut ends = [crossings.as_slice()[0].t, crossings.as_slice()[1].t];
            if unit.y > 0.0 { ends.reverse(); }
            prop_assert!((ends[0] - distance).abs() < 1e-6 * (1.0 + distance), "{:?}", ends);
            prop_assert!((ray.at(ends[1]).y + height * 0.5).abs() < 1e-12 * (1.0 + distance));
        } else if steepness < -1e-9 && let [enter, leave] = crossings.as_slice() {
            prop_assert!(leave.t - enter.t < 1e-6 * (1.0 + distance));
        }
        for &hit in crossings.as_slice() {
            prop_assert!((cone.surface(&ray, hit).geometric_normal.length() - 1.0).abs() < 1e-15 * 4.0);
        }
    }

    #[test]
    fn rays_parallel_to_the_side_of_a_cone_keep_their_root(
        radius in 0.1..10.0f64, height in 0.1..10.0f64, turn in -3.2..3.2f64, offset in common::point(1.0),
        tilt in prop_oneof![Just(0.0), -1e-13..1e-13f64, -1e-7..1e-7f64], up in any::<bool>(),
    ) {
        let cone = Cone::new(Vec3::ZERO, radius, height).unwrap();
        let generator = Vec3::new(radius * libm::cos(turn) * (1.0 + tilt), -height, radius * libm::sin(turn));
        let direction = if up { -generator } else { generator };
        let ray = Ray::new(offset * Vec3::new(radius, height, radius), direction);
        check_samples(&Shape::Cone(cone), &ray)?;
    }

    #[test]
    fn no_number_makes_a_crossing_nan(shape in solid(), numbers in prop::array::uniform6(any::<f64>())) {
        prop_assume!(numbers.iter().all(|x| x.is_finite()));
        let [ox, oy, oz, dx, dy, dz] = numbers;
        let ray = Ray::new(Vec3::new(ox, oy, oz), Vec3::new(dx, dy, dz));
        for &hit in shape.crossings(&ray).as_slice() {
            prop_assert!(hit.t.is_finite());
        }
    }

    #[test]
    fn surfaces_are_finite_for_rays_of_any_sensible_size(shape in solid(), aim in aim(), power in -60..60i32,
                                                         zeros in prop::array::uniform6(any::<bool>())) {
        let mut ray = ray_near(&shape, aim);
        for axis in 0..3 {
            if zeros[axis] && zeros[axis + 3] { ray.direction[axis] = 0.0; }
            if zeros[axis + 3] { ray.origin[axis] *= libm::pow(10.0, f64::from(power)); }
        }
        for &hit in shape.crossings(&ray).as_slice() {
            let surface = shape.surface(&ray, hit);
            prop_assert!(surface.point.is_finite() && surface.texcoord.get().is_finite());
            prop_assert!((surface.geometric_normal.length() - 1.0).abs() < 1e-15 * 4.0);
            prop_assert!(shape.bounds().contains(surface.point));
        }
    }
}

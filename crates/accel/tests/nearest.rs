//! All accelerators at all SIMD levels find what double-precision brute force finds, bit for bit.

mod common;

use common::{Item, Random, Rays, Scene, Sphere, build, nearest, query, trace, walk};
use dotray_accel::simd::{available_levels, level_name};
use dotray_accel::{Accelerator, GroupEvent, Kind, Quality, Query, Settings};
use dotray_geometry::{Aabb, Vec3};
use proptest::prelude::*;

/// Spheres with N·π·r² about `depth` in the unit cube.
fn spheres(count: usize, depth: f64, seed: u64) -> Scene<Sphere> {
    let mut random = Random::new(seed);
    let radius = (depth / (std::f64::consts::PI * count as f64)).sqrt();
    let sphere =
        |random: &mut Random| Sphere { center: random.point(), radius: radius * random.between(0.5, 1.5) };
    Scene((0..count).map(|_| sphere(&mut random)).collect())
}

/// Rays of every kind that is hard on a box test.
fn hard_rays(scene: &Scene<Sphere>, count: usize, seed: u64) -> Vec<Query> {
    let mut random = Random::new(seed);
    let mut rays = Vec::with_capacity(count);
    while rays.len() < count {
        let sphere = scene.0[random.below(scene.0.len() as u64) as usize];
        let axis = random.below(3) as usize;
        let sign = if random.below(2) == 0 { 1.0 } else { -1.0 };
        let mut along = Vec3::ZERO;
        along[axis] = sign;
        let aim = sphere.center + random.direction() * sphere.radius * random.between(0.0, 1.0001);
        rays.push(match random.below(8) {
            // From somewhere to somewhere.
            0 => query(random.point(), random.direction()),
            // Along an axis.
            1 => query(aim - along * random.between(0.0, 3.0), along),
            // Grazing the sphere.
            2 => {
                let across = random.direction().cross(random.direction()).normalize();
                let direction = across.any_orthonormal_vector();
                let foot = sphere.center + across * sphere.radius * (1.0 + random.between(-1e-9, 1e-9));
                query(foot - direction * random.between(0.1, 4.0), direction)
            }
            // From far away.
            3 => {
                let direction = random.direction();
                let distance = about_power_of_ten(random.between(4.0, 8.0));
                query(aim - direction * distance, direction)
            }
            // Next to where the sphere touches its box, in the box's plane or almost.
            4 => {
                let mut pole = sphere.center;
                pole[axis] += sign * sphere.radius * (1.0 - random.below(3) as f64 * 1e-10);
                let mut direction = random.direction();
                direction[axis] *= [0.0, 1e-12, 1e-7][random.below(3) as usize];
                let direction = direction.normalize();
                query(pole - direction * random.between(0.0, 2.0), direction)
            }
            // From the surface of a sphere.
            5 => query(aim, random.direction()),
            // Nearly along an axis.
            6 => {
                let direction = (along + random.direction() * 1e-9).normalize();
                query(aim - direction * random.between(0.0, 3.0), direction)
            }
            // Only a part of the ray counts.
            _ => {
                let mut query = query(random.point(), random.direction());
                query.t_min = random.between(0.0, 0.3);
                query.t_max = query.t_min + random.between(0.0, 0.5);
                query
            }
        });
    }
    rays
}

/// Ten to the power of `x`, near enough.
fn about_power_of_ten(x: f64) -> f64 {
    let whole = x.floor();
    (0..whole as i32).fold(1.0 + 9.0 * (x - whole), |product, _| product * 10.0)
}

/// All kinds and levels against the truth, nearest and any hit.
fn check<I: Item>(scene: &Scene<I>, groups: &[GroupEvent], queries: &[Query]) {
    let truth = nearest(scene, queries);
    for kind in Kind::ALL {
        let built = build(kind, scene, groups);
        for level in available_levels() {
            let found = trace(&built, level, scene, queries, false);
            for (i, (found, truth)) in found.iter().zip(&truth).enumerate() {
                assert_eq!(found, truth, "{} {} ray {i}: {:?}", kind.name(), level_name(level), queries[i]);
            }
            let any = trace(&built, level, scene, queries, true);
            let blocked = any.iter().zip(&truth).all(|(any, truth)| any.is_some() == truth.is_some());
            assert!(blocked, "{} {}: any hit differs", kind.name(), level_name(level));
        }
    }
}

#[test]
fn hard_rays_over_thousands_of_spheres() {
    let scene = spheres(5000, 2.0, 1);
    let queries = hard_rays(&scene, 24_000, 2);
    assert!(nearest(&scene, &queries).iter().flatten().count() > 12_000);
    check(&scene, &[], &queries);
}

#[test]
fn scenes_of_any_size_and_place() {
    let base = spheres(500, 2.0, 3);
    let base_rays = hard_rays(&base, 1500, 4);
    for (scale, shift) in
        [(1e-30, 0.0), (1e30, 0.0), (1.0, 1e6), (1e-3, -1e6), (1e100, 0.0), (1e-100, 0.0), (1.0, 1e12)]
    {
        let place = |point: Vec3| point * scale + Vec3::new(shift, -shift, 2.0 * shift);
        let place_sphere =
            |sphere: &Sphere| Sphere { center: place(sphere.center), radius: sphere.radius * scale };
        let scene = Scene(base.0.iter().map(place_sphere).collect());
        let move_query = |query: &Query| {
            let mut query = *query;
            query.ray.origin = place(query.ray.origin);
            (query.t_min, query.t_max) = (query.t_min * scale, query.t_max * scale);
            query
        };
        check(&scene, &[], &base_rays.iter().map(move_query).collect::<Vec<_>>());
    }
}

#[test]
fn ties_go_to_the_lower_number() {
    // Every sphere stands three times, far apart in the numbering.
    let once = spheres(300, 2.0, 5);
    let scene = Scene([&once.0[..], &once.0[..], &once.0[..]].concat());
    check(&scene, &[], &hard_rays(&scene, 2000, 6));
}

#[test]
fn one_item_and_none() {
    for count in [0, 1, 2, 8, 9] {
        let scene = spheres(count.max(1), 0.5, 7);
        let queries = hard_rays(&scene, 500, 8);
        check(&Scene(scene.0[..count].to_vec()), &[], &queries);
    }
}

#[test]
fn flat_boxes_and_points() {
    let mut random = Random::new(9);
    for flat in [[true, false, false], [true, true, false], [true, true, true]] {
        let item = |random: &mut Random| {
            let corner = (random.point() * 16.0).floor();
            let mut size = (random.point() * 3.0).floor();
            for axis in 0..3 {
                if flat[axis] {
                    size[axis] = 0.0;
                }
            }
            Aabb::new(corner, corner + size)
        };
        let scene = Scene((0..400).map(|_| item(&mut random)).collect());
        // Rays from grid point to grid point run in faces, edges and cell planes.
        let ray = |random: &mut Random| {
            let from = (random.point() * 40.0).floor() - 12.0;
            let to = (random.point() * 16.0).floor();
            query(from, if to == from { Vec3::X } else { to - from })
        };
        let axis_ray = |random: &mut Random| {
            let from = (random.point() * 32.0).floor() * 0.5 - 1.0;
            query(
                from,
                [Vec3::X, Vec3::NEG_X, Vec3::Y, Vec3::NEG_Y, Vec3::Z, Vec3::NEG_Z][random.below(6) as usize],
            )
        };
        let mut queries: Vec<_> = (0..1500).map(|_| ray(&mut random)).collect();
        queries.extend((0..1500).map(|_| axis_ray(&mut random)));
        check(&scene, &[], &queries);
    }
}

#[test]
fn the_truth_does_not_depend_on_groups() {
    let scene = spheres(2000, 2.0, 10);
    let queries = hard_rays(&scene, 3000, 11);
    let mut random = Random::new(12);
    let mut groups = Vec::new();
    let mut next = 0;
    while next < 2000 {
        groups.push(match random.below(6) {
            0 | 1 => GroupEvent::Open,
            2 | 3 => GroupEvent::Close,
            4 => GroupEvent::Items { first: next, count: 1 },
            _ => GroupEvent::Items { first: next, count: random.below(60) as u32 },
        });
        if let Some(GroupEvent::Items { count, .. }) = groups.last() {
            next += count;
        }
    }
    check(&scene, &groups, &queries);
    // Events that make no sense lose nothing either.
    let nonsense = [
        GroupEvent::Close,
        GroupEvent::Items { first: 1990, count: u32::MAX },
        GroupEvent::Open,
        GroupEvent::Items { first: 5, count: 10 },
        GroupEvent::Items { first: 0, count: 20 },
        GroupEvent::Items { first: 5000, count: 20 },
    ];
    check(&scene, &nonsense, &queries[..500]);
}

#[test]
fn deeply_nested_groups() {
    let depth = 100_000;
    // Nothing but nesting, then an item on every level.
    for items_between in [false, true] {
        let count = if items_between { depth } else { 100 };
        let scene = spheres(count as usize, 2.0, 13);
        let mut groups = Vec::new();
        for level in 0..depth {
            groups.push(GroupEvent::Open);
            if items_between {
                groups.push(GroupEvent::Items { first: level, count: 1 });
            }
        }
        groups.push(GroupEvent::Items { first: 0, count });
        groups.extend((0..depth).map(|_| GroupEvent::Close));
        let queries = hard_rays(&scene, 40, 14);
        let built = build(Kind::Boxes, &scene, &groups);
        let found = trace(&built, *available_levels().last().expect("one"), &scene, &queries, false);
        assert_eq!(found, nearest(&scene, &queries));
    }
}

#[test]
fn a_million_items_in_one_place() {
    let sphere = Sphere { center: Vec3::new(0.3, 0.4, 0.5), radius: 0.1 };
    let scene = Scene(vec![sphere; 1_000_000]);
    let queries = [query(Vec3::ZERO, sphere.center), query(Vec3::ZERO, Vec3::X)];
    for kind in [Kind::Bvh, Kind::Boxes, Kind::Octree, Kind::Bsp] {
        let built = build(kind, &scene, &[]);
        let found = trace(&built, dotray_accel::simd::level(), &scene, &queries, false);
        assert!(found[0].is_some_and(|(_, item)| item == 0) && found[1].is_none(), "{}", kind.name());
        assert!(built.accelerator.memory() < 100_000_000, "{}", built.accelerator.stats());
    }
}

#[test]
fn sizes_that_fool_every_cut() {
    // Each item is twice as far out and twice as large as the one before: bins part off one at a time.
    let item = |i: i32| {
        let size = power_of_two(i);
        Sphere { center: Vec3::new(size, size * 0.5, -size), radius: size * 0.1 }
    };
    let scene = Scene((-300..300).map(item).flat_map(|sphere| [sphere; 3]).collect());
    check(&scene, &[], &hard_rays(&scene, 500, 15));
}

/// Two to the power of `x`.
fn power_of_two(x: i32) -> f64 {
    f64::from_bits(((1023 + x) as u64) << 52)
}

#[test]
fn threads_leave_no_trace() {
    let scene = spheres(150_000, 2.0, 16);
    for quality in [Quality::Fast, Quality::Balanced, Quality::Best] {
        for kind in Kind::ALL {
            let build = |threads| {
                let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().expect("a pool");
                pool.install(|| Accelerator::build(kind, &scene, &[], &Settings { quality }))
            };
            let (one, many) = (build(1), build(5));
            assert_eq!(one.order, many.order);
            assert_eq!(one.accelerator.stats(), many.accelerator.stats());
            one.accelerator.validate(&scene, one.order.as_deref()).expect("well formed");
        }
    }
}

#[test]
fn a_refitted_tree_finds_items_that_have_moved() {
    let before = spheres(3000, 2.0, 21);
    let mut random = Random::new(22);
    let moved = |sphere: &Sphere| Sphere { center: sphere.center + random.direction() * 0.3, ..*sphere };
    let after = Scene(before.0.iter().map(moved).collect());
    let queries = hard_rays(&after, 500, 23);
    let expected = nearest(&after, &queries);
    for kind in [Kind::Brute, Kind::Boxes, Kind::Bvh] {
        let mut built = build(kind, &before, &[]);
        assert!(built.accelerator.refit(&after, built.order.as_deref()));
        built.accelerator.validate(&after, built.order.as_deref()).expect("well formed");
        assert_eq!(trace(&built, dotray_accel::simd::level(), &after, &queries, false), expected);
    }
    for kind in [Kind::Octree, Kind::Bsp] {
        assert!(!build(kind, &before, &[]).accelerator.refit(&after, None));
    }
}

#[test]
fn all_but_brute_force_save_ten_times_the_work() {
    let scene = spheres(10_000, 2.0, 17);
    let mut random = Random::new(18);
    let queries: Vec<_> = (0..500).map(|_| query(random.point(), random.direction())).collect();
    for kind in [Kind::Boxes, Kind::Octree, Kind::Bsp, Kind::Bvh] {
        let built = build(kind, &scene, &[]);
        let mut rays = Rays::new(&scene, built.order.as_deref(), &queries, false);
        walk(&built, dotray_accel::simd::level(), &mut rays, false);
        let work = rays.item_tests + rays.box_tests;
        println!("{}: {} items, {} boxes a ray", kind.name(), rays.item_tests / 500, rays.box_tests / 500);
        assert!(work * 10 < 10_000 * 500, "{}: {work}", kind.name());
    }
}

#[test]
fn a_mesh_is_far_sooner_than_a_cloud() {
    let count = 50_000;
    let cloud = spheres(count, 2.0, 22);
    // As many along a winding sheet, of which a ray meets little.
    let mut sheet = spheres(count, 0.05, 22);
    for sphere in &mut sheet.0 {
        sphere.center.z = 0.5 + 0.2 * (7.0 * sphere.center.x).sin();
    }
    let is_far = |scene: &Scene<Sphere>| build(Kind::Bvh, scene, &[]).accelerator.is_far();
    assert!(!is_far(&cloud));
    assert!(is_far(&sheet) || !dotray_accel::ahead::HELPS);
    sheet.0.truncate(count / 10);
    assert!(!is_far(&sheet), "a small one is at hand");
}

#[test]
fn rays_in_turn_do_what_each_does_alone() {
    let scene = spheres(500_000, 2.0, 19);
    let built = build(Kind::Bvh, &scene, &[]);
    assert!(built.accelerator.is_far() || !dotray_accel::ahead::HELPS);
    let mut random = Random::new(20);
    // Some miss the scene and never begin.
    let mut queries: Vec<_> =
        (0..1000).map(|_| query(random.point() * random.between(0.5, 3.0), random.direction())).collect();
    queries.extend(hard_rays(&scene, 500, 21));
    for level in available_levels() {
        for (any, count) in
            [(false, queries.len()), (true, queries.len()), (false, 6), (false, 5), (false, 3)]
        {
            let queries = &queries[..count];
            let mut turns = Rays::new(&scene, built.order.as_deref(), queries, any);
            walk(&built, level, &mut turns, false);
            let (mut best, mut tests) = (Vec::new(), (0, 0));
            for query in queries.chunks(1) {
                let mut alone = Rays::new(&scene, built.order.as_deref(), query, any);
                walk(&built, level, &mut alone, false);
                best.extend(alone.best);
                tests = (tests.0 + alone.item_tests, tests.1 + alone.box_tests);
            }
            assert_eq!(turns.best, best, "{}", level_name(level));
            assert_eq!((turns.item_tests, turns.box_tests), tests, "{}", level_name(level));
            assert_eq!(turns.finished, queries.len());
        }
    }
}

#[test]
fn cells_are_shown_level_by_level() {
    let scene = spheres(3_000, 2.0, 19);
    let within = |inner: &Aabb, outer: &Aabb| {
        let slack = 1e-5;
        inner.min.cmpge(outer.min - slack).all() && inner.max.cmple(outer.max + slack).all()
    };
    for kind in [Kind::Brute, Kind::Boxes, Kind::Octree, Kind::Bsp, Kind::Bvh] {
        let accelerator = build(kind, &scene, &[]).accelerator;
        let cells = accelerator.cells(usize::MAX);
        let stats = accelerator.stats();
        let name = kind.name();
        assert_eq!(cells.iter().filter(|cell| cell.is_leaf).count(), stats.leaves, "{name}");
        assert_eq!(cells.iter().map(|cell| cell.depth).max(), Some(stats.depth), "{name}");
        assert!(within(&accelerator.bounds(), &cells[0].bounds) && cells[0].depth == 0, "{name}");
        assert!(cells.is_sorted_by_key(|cell| cell.depth), "{name}");
        for cell in &cells[1..] {
            let above = cells.iter().filter(|above| !above.is_leaf && above.depth + 1 == cell.depth);
            assert!(above.into_iter().any(|above| within(&cell.bounds, &above.bounds)), "{name}: {cell:?}");
        }
        for sphere in &scene.0 {
            let bounds = Aabb::new(sphere.center, sphere.center);
            let mut leaves = cells.iter().filter(|cell| cell.is_leaf);
            assert!(leaves.any(|leaf| within(&bounds, &leaf.bounds)), "{name}: {sphere:?}");
        }
        let few = accelerator.cells(20);
        assert_eq!(few, cells[..20.min(cells.len())], "{name}");
    }
    assert!(build(Kind::Bvh, &spheres(0, 1.0, 1), &[]).accelerator.cells(9).is_empty());
}

proptest! {
    #![proptest_config(ProptestConfig { cases: 60, failure_persistence: None, ..ProptestConfig::default() })]

    #[test]
    fn any_boxes_and_any_rays(
        seed in any::<u64>(),
        count in 0_usize..200,
        size in -6_i32..3,
        grid in any::<bool>(),
    ) {
        let mut random = Random::new(seed);
        let snap = |point: Vec3| if grid { (point * 8.0).round() / 8.0 } else { point };
        let item = |random: &mut Random| {
            let corner = snap(random.point());
            Aabb::new(corner, corner + snap(random.point() * power_of_two(size)))
        };
        let scene = Scene((0..count).map(|_| item(&mut random)).collect());
        let ray = |random: &mut Random| {
            let (from, to) = (snap(random.point() * 3.0 - 1.0), snap(random.point()));
            query(from, if from == to { Vec3::NEG_Y } else { to - from })
        };
        let queries: Vec<_> = (0..100).map(|_| ray(&mut random)).collect();
        check(&scene, &[], &queries);
    }
}

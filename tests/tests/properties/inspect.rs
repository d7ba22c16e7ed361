//! What `inspect` tells of a pixel is what the renderer computed for it: the same colours, and terms that add up to
//! them, bit for bit. Layers are made of the same numbers.

use dotray_accel::Kind;
use dotray_accel::simd::level;
use dotray_geometry::Vec3;
use dotray_render::Layer;
use dotray_render::Options;
use dotray_render::Silent;
use dotray_render::World;
use dotray_render::camera::Camera;
use dotray_render::inspect::Branch;
use dotray_render::inspect::End;
use dotray_render::inspect::RayNode;
use dotray_render::inspect::Shadow;
use dotray_render::render_layers;
use dotray_render::trace::Tracer;
use dotray_scene::files::Disk;
use dotray_tests::pictures;
use std::path::Path;

/// Mirrors, glass, textures, all lights.
const SCENES: [&str; 5] = ["glasses", "mirrors", "desk", "lenses", "slides"];

fn options() -> Options {
    Options { width: 40, height: 30, recursion: 4, threshold: 0.01, light_samples: 3, ..Options::default() }
}

fn world(name: &str) -> World {
    let path = Path::new(env!("CARGO_MANIFEST_DIR")).join("../scenes").join(name).with_extension("ray");
    let scene = pictures::scene_of_file(&path, &Disk).unwrap_or_else(|error| panic!("{error}"));
    pictures::world(scene, Kind::Bvh).unwrap_or_else(|error| panic!("{error}"))
}

/// Every pixel's ray tree, the upper row first.
fn trees(world: &World) -> Vec<RayNode> {
    let options = options();
    let camera = Camera::new(world.camera(), options.width, options.height);
    let mut tracer = Tracer::new(world, &options, level());
    let pixels = (0..options.height).rev().flat_map(|j| (0..options.width).map(move |i| (i, j)));
    pixels
        .map(|(i, j)| tracer.inspect(camera.ray(f64::from(i) + 0.5, f64::from(j) + 0.5)).expect("a tree"))
        .collect()
}

/// What a walk over all trees came across, so that the test cannot pass by seeing nothing.
#[derive(Debug, Default)]
struct Seen {
    blocked: u32,
    crossed: u32,
    area: u32,
    reflected: u32,
    refracted: u32,
    limit: u32,
    threshold: u32,
}

fn check(node: &RayNode, seen: &mut Seen) {
    let Some(met) = &node.meeting else { return };
    assert_eq!(met.sum().to_array().map(f64::to_bits), node.color.to_array().map(f64::to_bits), "{node:?}");
    assert!((met.normal.length() - 1.0).abs() < 1e-12);
    for term in &met.lights {
        seen.area += u32::from(term.samples > 1);
        match &term.shadow {
            Shadow::NotAsked => {}
            Shadow::Blocked { .. } => {
                assert_eq!(term.filter, Vec3::ZERO);
                seen.blocked += 1;
            }
            Shadow::Crossed(crossings) => {
                let product = crossings.iter().fold(Vec3::ONE, |product, (_, through)| product * *through);
                assert_eq!(term.filter, product);
                seen.crossed += u32::from(!crossings.is_empty());
            }
        }
    }
    for branch in [&met.reflected, &met.refracted] {
        match branch {
            Branch::Ended(End::Limit) => seen.limit += 1,
            Branch::Ended(End::Threshold { largest }) => {
                assert!(*largest < options().threshold);
                seen.threshold += 1;
            }
            Branch::Traced(_) | Branch::Ended(End::NoWeight | End::TotalReflection) => {}
        }
    }
    if let Branch::Traced(node) = &met.reflected {
        seen.reflected += 1;
        check(node, seen);
    }
    if let Branch::Traced(node) = &met.refracted {
        seen.refracted += 1;
        check(node, seen);
    }
}

#[test]
fn the_terms_add_up_to_the_pixel() {
    let mut seen = Seen::default();
    for name in SCENES {
        let world = world(name);
        let picture = pictures::picture(&world, &options()).unwrap_or_else(|error| panic!("{error}"));
        let trees = trees(&world);
        let pixels = picture.samples().chunks_exact(3);
        for (index, (node, pixel)) in trees.iter().zip(pixels).enumerate() {
            assert_eq!(node.color.to_array().map(|x| x as f32), pixel, "{name}, pixel {index}");
            check(node, &mut seen);
        }
    }
    println!("{seen:?}");
    let Seen { blocked, crossed, area, reflected, refracted, limit, threshold } = seen;
    assert!([blocked, crossed, area, reflected, refracted, limit, threshold].iter().all(|&count| count > 10));
}

#[test]
fn layers_hold_what_the_trees_tell() {
    let world = world("glasses");
    let layers =
        render_layers(&world, &options(), &Layer::ALL, &Silent).expect("options are fine").expect("done");
    let trees = trees(&world);
    let of = |layer: Layer| &layers.iter().find(|picture| picture.layer == layer).expect("asked for").samples;
    for (index, node) in trees.iter().enumerate() {
        let depth = node.meeting.as_ref().map_or(f32::INFINITY, |met| met.nearest.hit.t as f32);
        assert_eq!(of(Layer::Depth)[index], depth);
        let number = node.meeting.as_ref().map_or(-1.0, |met| met.nearest.number as f32);
        assert_eq!(of(Layer::Shape)[index], number);
        // The three parts of the colour are the colour.
        let part = |layer: Layer, k: usize| of(layer)[3 * index + k];
        for k in 0..3 {
            let sum = part(Layer::Direct, k) + part(Layer::Reflected, k) + part(Layer::Transmitted, k);
            assert!((sum - node.color[k] as f32).abs() < 1e-5);
        }
        assert!(of(Layer::Rays)[index] >= 1.0);
    }
    assert!(of(Layer::BoxTests).iter().sum::<f32>() > of(Layer::Rays).iter().sum::<f32>());
    assert!(of(Layer::Shadow).iter().any(|&share| share < 1.0));
    assert!(of(Layer::Normal).iter().all(|x| x.abs() <= 1.0));
}

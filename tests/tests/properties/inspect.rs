//! What `inspect` tells of a pixel is what the renderer computed for it: the same colours, and terms that add up to
//! them, bit for bit. Layers are made of the same numbers.

use dotray_accel::Kind;
use dotray_accel::simd::level;
use dotray_geometry::Vec3;
use dotray_render::Crop;
use dotray_render::Layer;
use dotray_render::LayerPicture;
use dotray_render::Options;
use dotray_render::Silent;
use dotray_render::World;
use dotray_render::camera::Camera;
use dotray_render::inspect::Branch;
use dotray_render::inspect::End;
use dotray_render::inspect::Meeting;
use dotray_render::inspect::RayNode;
use dotray_render::inspect::Shadow;
use dotray_render::render_layers;
use dotray_render::trace::Tracer;
use dotray_scene::files::Disk;
use dotray_tests::pictures;
use std::collections::BTreeSet;
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

/// All rays that a ray led to, and what they were tested against: rays, boxes, shapes.
fn cost(node: &RayNode) -> [u64; 3] {
    let mut cost = [1, node.tests.boxes, node.tests.shapes];
    let mut add = |more: [u64; 3]| cost.iter_mut().zip(more).for_each(|(sum, more)| *sum += more);
    let Some(met) = &node.meeting else { return cost };
    for term in met.lights.iter().filter(|term| !matches!(term.shadow, Shadow::NotAsked)) {
        add([1, term.tests.boxes, term.tests.shapes]);
    }
    for branch in [&met.reflected, &met.refracted] {
        if let Branch::Traced(node) = branch {
            add(self::cost(node));
        }
    }
    cost
}

/// The mean of what comes through of the lights that face the point.
fn light_share(met: &Meeting) -> Vec3 {
    let facing: Vec<Vec3> =
        met.lights.iter().filter(|term| term.lit != Vec3::ZERO).map(|term| term.filter).collect();
    if facing.is_empty() { Vec3::ONE } else { facing.iter().sum::<Vec3>() / facing.len() as f64 }
}

/// What a layer must hold of a pixel, by its tree.
fn expected(layer: Layer, node: &RayNode) -> Vec<f32> {
    let met = node.meeting.as_ref();
    let single = |x: f64| vec![x as f32];
    let vector = |v: Vec3| v.to_array().map(|x| x as f32).to_vec();
    let of_point = |value: fn(&Meeting) -> Vec3| vector(met.map_or(Vec3::ZERO, value));
    match layer {
        Layer::Depth => single(met.map_or(f64::INFINITY, |met| met.nearest.hit.t)),
        Layer::Normal => of_point(|met| met.normal),
        Layer::Position => of_point(|met| met.surface.point),
        Layer::Shape => single(met.map_or(-1.0, |met| f64::from(met.nearest.number))),
        Layer::Material => single(met.map_or(-1.0, |met| f64::from(met.material))),
        Layer::St => {
            let st = met.map_or([0.0; 2], |met| met.surface.in_object.texcoord.get().to_array());
            st.map(|x| x as f32).to_vec()
        }
        Layer::Object => of_point(|met| met.surface.in_object.point),
        Layer::Shadow => vector(met.map_or(Vec3::ONE, light_share)),
        Layer::Direct => vector(met.map_or(node.color, Meeting::direct)),
        Layer::Reflected => of_point(|met| met.reflected.color()),
        Layer::Transmitted => of_point(|met| met.refracted.color()),
        Layer::Rays => single(cost(node)[0] as f64),
        Layer::BoxTests => single(cost(node)[1] as f64),
        Layer::ShapeTests => single(cost(node)[2] as f64),
    }
}

#[test]
fn layers_hold_what_the_trees_tell() {
    let mut uneven = BTreeSet::new();
    for name in SCENES {
        let world = world(name);
        let layers = |wanted: &[Layer]| {
            render_layers(&world, &options(), wanted, &Silent).expect("options are fine").expect("done")
        };
        let trees = trees(&world);
        let all = layers(&Layer::ALL);
        for LayerPicture { layer, samples, .. } in &all {
            let expected: Vec<f32> = trees.iter().flat_map(|node| expected(*layer, node)).collect();
            let differ = expected.iter().zip(samples).filter(|(a, b)| a.to_bits() != b.to_bits()).count();
            assert_eq!((samples.len(), differ), (expected.len(), 0), "{name}: {layer:?}");
            let first = &samples[..layer.channels().len()];
            if samples.chunks_exact(first.len()).any(|pixel| pixel != first) {
                uneven.insert(layer.name());
            }
        }
        // Without layers of cost rays travel together, and without any of light none of it is worked out.
        let lit = [Layer::Shadow, Layer::Direct, Layer::Reflected, Layer::Transmitted];
        assert_eq!(layers(&lit), all[7..11], "{name}");
        assert_eq!(layers(&Layer::ALL[..7]), all[..7], "{name}");
    }
    // Layers that are the same everywhere would show nothing.
    assert_eq!(uneven.len(), Layer::ALL.len(), "{uneven:?}");
}

#[test]
fn layers_of_a_window_are_a_window_of_the_layers() {
    let world = world("glasses");
    let layers = |crop| {
        let options = Options { crop, threads: Some(2), ..options() };
        render_layers(&world, &options, &Layer::ALL, &Silent).expect("options are fine").expect("done")
    };
    let (whole, part) = (layers(None), layers(Some(Crop { x: 7, y: 9, width: 18, height: 11 })));
    for (whole, part) in whole.iter().zip(&part) {
        let count = whole.layer.channels().len();
        assert_eq!((part.width, part.height), (18, 11));
        for row in 0..11 {
            let start = ((row + 9) * 40 + 7) * count;
            let expected = &whole.samples[start..start + 18 * count];
            assert_eq!(&part.samples[row * 18 * count..(row + 1) * 18 * count], expected, "{:?}", part.layer);
        }
    }
}

//! A scene looks the same at any size: written smaller or larger, or put into a group that scales.

use crate::same_bytes::small_corpus;
use dotray_accel::Kind;
use dotray_geometry::Cone;
use dotray_geometry::Cuboid;
use dotray_geometry::Cylinder;
use dotray_geometry::Mat4;
use dotray_geometry::Sphere;
use dotray_geometry::Triangle;
use dotray_geometry::Vec3;
use dotray_image::Image;
use dotray_image::compare::Class;
use dotray_image::compare::conformance;
use dotray_render::Options;
use dotray_scene::Scene;
use dotray_scene::model::Attenuation;
use dotray_scene::model::Item;
use dotray_scene::model::Light;
use dotray_scene::model::Placed;
use dotray_scene::model::SceneFile;
use dotray_scene::span::Span;
use dotray_tests::pictures;

/// Coincident planes that were written as different numbers round apart when they are scaled.
const NOT_SCALED: [&str; 1] = ["ties"];

fn scale_attenuation(attenuation: &mut Attenuation, s: f64) {
    attenuation.linear /= s;
    attenuation.quadratic /= s * s;
}

/// Camera and lights: what both ways of scaling have in common.
fn scale_surroundings(file: &mut SceneFile, s: f64) {
    if let Some(camera) = &mut file.camera {
        camera.value.position *= s;
    }
    for light in &mut file.lights {
        match &mut light.value {
            Light::Point { position, attenuation, .. } | Light::Spot { position, attenuation, .. } => {
                *position *= s;
                scale_attenuation(attenuation, s);
            }
            Light::Area { position, radius, attenuation, .. } => {
                *position *= s;
                *radius *= s;
                scale_attenuation(attenuation, s);
            }
            Light::Directional { .. } => {}
        }
    }
}

fn scale_triangle(triangle: &Triangle, s: f64) -> Triangle {
    let vertices = triangle.vertices().map(|vertex| vertex * s);
    Triangle::new(vertices, *triangle.normals(), *triangle.texcoords()).expect("still a triangle")
}

/// All lengths times `s`.
fn written_at_scale(scene: &Scene, s: f64) -> Scene {
    let mut scene = scene.clone();
    for file in &mut scene.files {
        scale_surroundings(file, s);
        for group in &mut file.groups {
            let shift = group.value.w_axis;
            group.value.w_axis = (shift.truncate() * s).extend(shift.w);
        }
        for sphere in &mut file.spheres.shapes {
            *sphere = Sphere::new(sphere.center() * s, sphere.radius() * s).expect("still a sphere");
        }
        for cuboid in &mut file.cuboids.shapes {
            *cuboid = Cuboid::new(cuboid.center() * s, cuboid.size() * s).expect("still a box");
        }
        for shape in &mut file.cylinders.shapes {
            *shape = Cylinder::new(shape.center() * s, shape.radius() * s, shape.height() * s)
                .expect("a cylinder");
        }
        for shape in &mut file.cones.shapes {
            *shape =
                Cone::truncated(shape.center() * s, shape.radius() * s, shape.top() * s, shape.height() * s)
                    .expect("still a cone");
        }
        for triangle in &mut file.triangles.shapes {
            *triangle = scale_triangle(triangle, s);
        }
        for vertex in &mut file.vertices {
            vertex.position *= s;
        }
    }
    scene
}

/// The whole scene in one group that scales.
fn grouped_at_scale(scene: &Scene, s: f64) -> Scene {
    let mut scene = scene.clone();
    let main = &mut scene.files[0];
    scale_surroundings(main, s);
    main.items.insert(0, Item::Open(main.groups.len() as u32));
    main.items.push(Item::Close);
    main.groups.push(Placed { value: Mat4::from_scale(Vec3::splat(s)), span: Span::default() });
    scene
}

/// What is wrong with a picture that should look like `expected`: more than 0.1 % of its pixels off by more than
/// 1/255, or a pixel far off where the picture is flat.
fn unlike(expected: &Image, actual: &Image) -> Option<String> {
    let (width, height) = (expected.width(), expected.height());
    let distance = |a: [f32; 4], b: [f32; 4]| (0..3).map(|c| (a[c] - b[c]).abs()).fold(0.0, f32::max);
    let at = |image: &Image, x: usize, y: usize| image.pixel(x, y).expect("inside");
    let mut off = Vec::new();
    for (x, y) in (0..height).flat_map(|y| (0..width).map(move |x| (x, y))) {
        let here = at(expected, x, y);
        let difference = distance(here, at(actual, x, y));
        if difference <= 1.0 / 255.0 {
            continue;
        }
        off.push((x, y));
        let around = (y.max(1) - 1..(y + 2).min(height))
            .flat_map(|j| (x.max(1) - 1..(x + 2).min(width)).map(move |i| (i, j)));
        let relief = around.map(|(i, j)| distance(here, at(expected, i, j))).fold(0.0, f32::max);
        if relief < 0.05 && difference > 0.1 {
            return Some(format!("pixel {x},{y} is off by {difference} where the picture is flat"));
        }
    }
    let allowed = (width * height).div_ceil(1000);
    (off.len() > allowed)
        .then(|| format!("{} of {} pixels differ, first {:?}", off.len(), width * height, off[0]))
}

/// Whether an area light shines: its grain is another one at every scale, so block means are compared.
fn has_grain(scene: &Scene) -> bool {
    scene.files.iter().flat_map(|file| &file.lights).any(|light| matches!(light.value, Light::Area { .. }))
}

/// As [`unlike`], of block means.
fn unlike_in_blocks(expected: &Image, actual: &Image) -> Option<String> {
    let figures = conformance(expected, actual, Class::Statistical, false);
    (!figures.passed()).then(|| figures.failures.join("; "))
}

/// Renders the corpus at every scale; `change` makes the scaled scene.
fn every_scale(wanted: impl Fn(&Scene) -> bool, change: impl Fn(&Scene, f64) -> Scene) {
    let mut faults = Vec::new();
    let mut compared = 0;
    for (name, scene, options) in small_corpus() {
        if NOT_SCALED.contains(&name.as_str()) || !wanted(&scene) {
            continue;
        }
        let options = Options { light_samples: 64, ..options };
        let render = |scene: Scene| {
            let world = pictures::world(scene, Kind::Bvh).unwrap_or_else(|error| panic!("{name}: {error}"));
            pictures::picture(&world, &options).unwrap_or_else(|error| panic!("{name}: {error}"))
        };
        let expected = render(scene.clone());
        for s in [1e-3, 1e4, 1e-6, 1024.0] {
            compared += 1;
            let actual = render(change(&scene, s));
            let fault = if has_grain(&scene) { unlike_in_blocks } else { unlike }(&expected, &actual);
            if let Some(fault) = fault {
                faults.push(format!("{name} at {s}: {fault}"));
            }
        }
    }
    assert!(compared > 100);
    assert!(faults.is_empty(), "{} pictures differ\n{}", faults.len(), faults.join("\n"));
}

#[test]
fn scenes_written_at_any_scale_look_alike() {
    // 3-D textures and bumps are functions of the coordinates as they are written.
    let plain = |scene: &Scene| {
        let materials = scene.files.iter().flat_map(|file| &file.materials);
        materials.into_iter().all(|material| !material.value.text.contains('='))
    };
    let solid = |scene: &Scene| plain(scene) && !has_bare_clause(scene);
    every_scale(solid, written_at_scale);
}

/// Clauses may stand without any `key=value`.
fn has_bare_clause(scene: &Scene) -> bool {
    let names = ["noise", "marble", "wood", "checker", "bump"];
    let mut texts = scene.files.iter().flat_map(|file| &file.materials).map(|material| &material.value.text);
    texts.any(|text| names.iter().any(|name| text.contains(name)))
}

#[test]
fn scenes_in_a_group_of_any_scale_look_alike() {
    every_scale(|_| true, grouped_at_scale);
}

#[test]
fn unlike_pictures_are_told_apart() {
    let grey = |value: f32| {
        Image::from_samples(40, 40, dotray_image::Channels::Rgb, vec![value; 4800]).expect("fits")
    };
    let expected = grey(0.5);
    assert_eq!(unlike(&expected, &grey(0.501)), None);
    assert!(unlike(&expected, &grey(0.51)).is_some());
    let mut speck = expected.clone();
    speck.set_pixel(20, 20, [0.9, 0.5, 0.5, 1.0]);
    assert!(unlike(&expected, &speck).is_some());
    // The same speck beside an edge is forgiven.
    let mut edge = expected.clone();
    edge.set_pixel(21, 20, [0.9, 0.5, 0.5, 1.0]);
    let mut moved = edge.clone();
    moved.set_pixel(20, 20, [0.9, 0.5, 0.5, 1.0]);
    assert_eq!(unlike(&edge, &moved), None);
}

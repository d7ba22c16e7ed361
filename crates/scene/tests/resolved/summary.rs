//! The scene in numbers.

use crate::build::Build;
use crate::build::scene;
use dotray_geometry::Aabb;
use dotray_geometry::Vec3;
use dotray_scene::resolve::resolve;
use dotray_scene::summary::ShapeCounts;
use dotray_scene::summary::Summary;
use dotray_scene::summary::summarize;
use std::path::PathBuf;

fn summary() -> Summary {
    let o = [0.0, 0.0, 0.0];
    let main = Build::file(0)
        .camera()
        .light()
        .texture("a b.bmp")
        .material(|_| {})
        .include(1)
        .cylinder(0, [0.0, -9.0, 0.0], 1.0, 2.0)
        .translate(0.0, 5.0, 0.0)
        .instance(0)
        .sphere(0, o, 2.0)
        .close()
        .instance(0);
    let part = Build::file(1)
        .material(|_| {})
        .vertex([0.0, 0.0, 0.0], [0.0, 0.0, 1.0], [0.0, 0.0])
        .vertex([8.0, 0.0, 0.0], [0.0, 0.0, 1.0], [0.0, 0.0])
        .vertex([0.0, 1.0, 0.0], [0.0, 0.0, 1.0], [0.0, 0.0])
        .translate(0.0, 0.0, -1.0)
        .indexed(0, [0, 1, 2])
        .cone(0, o, 1.0, 1.0)
        .close();
    summarize(&resolve(scene([main, part])).resolved.unwrap())
}

#[test]
fn everything_is_counted() {
    let summary = summary();
    let shapes =
        ShapeCounts { spheres: 1, cylinders: 1, cones: 2, indexed_triangles: 2, ..ShapeCounts::default() };
    assert_eq!(summary.shapes, shapes);
    assert_eq!(summary.shapes.total(), 6);
    assert_eq!((summary.groups, summary.instances, summary.max_depth), (3, 2, 3));
    assert_eq!((summary.lights.directional, summary.lights.total()), (1, 1));
    assert_eq!((summary.materials, summary.vertices), (2, 3));
    assert_eq!(summary.textures, ["a b.bmp"]);
    assert_eq!(summary.files, [PathBuf::from("scenes/0.ray"), PathBuf::from("scenes/1.ray")]);
    let [min, max] = [Vec3::new(-2.0, -10.0, -2.0), Vec3::new(8.0, 7.0, 2.0)];
    let Aabb { min: found_min, max: found_max } = summary.bounds;
    assert!(found_min.abs_diff_eq(min, 1e-12) && found_max.abs_diff_eq(max, 1e-12), "{:?}", summary.bounds);
    assert!(!summary.camera_is_default);
}

#[test]
fn the_text_says_it_all() {
    let expected = "\
file        scenes/0.ray
file        scenes/1.ray
shapes      6 (1 sphere, 1 cylinder, 2 cones, 2 indexed triangles)
vertices    3
groups      3 (instances 2, deepest 3)
lights      1 (1 directional)
materials   2
textures    1 (a b.bmp)
bounds      (-2, -10, -2) to (8, 7, 2)
camera      at (0, 0, 4) towards (0, 0, -1), up (0, 1, 0), half angle 0.523
background  (0, 0, 0)
ambient     (0, 0, 0)
";
    assert_eq!(summary().to_string(), expected);
    let empty = summarize(&resolve(scene([Build::file(0)])).resolved.unwrap()).to_string();
    assert!(empty.contains("shapes      0\n") && empty.contains("bounds      none\n"), "{empty}");
    assert!(empty.contains("half angle 0.4 (default)\n"), "{empty}");
}

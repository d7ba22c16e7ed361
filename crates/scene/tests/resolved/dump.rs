//! The tree as text.

use crate::build::Build;
use crate::build::scene;
use dotray_scene::dump::DumpOptions;
use dotray_scene::dump::dump;
use dotray_scene::model::Scene;

fn text(scene: &Scene, world: bool) -> String {
    let mut text = Vec::new();
    dump(&scene.files, DumpOptions { world }, &mut text).unwrap();
    String::from_utf8(text).unwrap()
}

const UNIT: [[f64; 4]; 4] =
    [[1.0, 0.0, 0.0, 0.0], [0.0, 1.0, 0.0, 0.0], [0.0, 0.0, 1.0, 0.0], [0.0, 0.0, 0.0, 1.0]];

/// The example that the slides print, its triangle included.
fn slides_example() -> Build {
    Build::file(0)
        .open(UNIT)
        .sphere(0, [0.0, 0.0, 0.0], 1.0)
        .translate(-3.0, 0.0, 0.0)
        .cuboid(1, [0.0, 0.0, 0.0], [1.0, 1.1, 1.2])
        .translate(0.0, 3.0, 0.0)
        .cylinder(2, [0.0, 0.0, 0.0], 1.0, 1.4)
        .cone(3, [0.0, -2.1, 0.0], 1.71, 0.62)
        .close()
        .translate(0.0, -3.0, 0.0)
        .cone(3, [0.0, 0.0, 0.0], 1.21, 1.32)
        .close()
        .close()
        .translate(-3.0, 0.0, 0.0)
        .triangle(
            4,
            [[0.0, -1.0, 0.0], [1.0, 1.0, -0.2], [-1.0, 0.85, 0.11]],
            [[0.0, 0.0, 1.0], [0.0, 0.0, 1.0], [0.0, 0.0, 1.0]],
            [[0.5, 0.0], [1.0, 1.0], [0.0, 1.0]],
        )
        .close()
        .close()
}

#[test]
fn slides_example_prints_its_tree() {
    let expected = "\
NODE: M(1, 0, 0, 0; 0, 1, 0, 0; 0, 0, 1, 0; 0, 0, 0, 1)
  NODE: M(1, 0, 0, 0; 0, 1, 0, 0; 0, 0, 1, 0; 0, 0, 0, 1)
    SPHERE: C(0, 0, 0) R=1
    NODE: M(1, 0, 0, -3; 0, 1, 0, 0; 0, 0, 1, 0; 0, 0, 0, 1)
      BOX: C(0, 0, 0) L(1, 1.1, 1.2)
      NODE: M(1, 0, 0, 0; 0, 1, 0, 3; 0, 0, 1, 0; 0, 0, 0, 1)
        CYLINDER: C(0, 0, 0) R=1 H=1.4
        CONE: C(0, -2.1, 0) R=1.71 H=0.62
      NODE: M(1, 0, 0, 0; 0, 1, 0, -3; 0, 0, 1, 0; 0, 0, 0, 1)
        CONE: C(0, 0, 0) R=1.21 H=1.32
    NODE: M(1, 0, 0, -3; 0, 1, 0, 0; 0, 0, 1, 0; 0, 0, 0, 1)
      TRIANGLE: V(0, -1, 0) V(1, 1, -0.2) V(-1, 0.85, 0.11) N(0, 0, 1) N(0, 0, 1) N(0, 0, 1) T(0.5, 0) T(1, 1) T(0, 1)
";
    assert_eq!(text(&scene([slides_example()]), false), expected);
}

#[test]
fn world_adds_the_cumulative_matrices() {
    let build =
        Build::file(0).translate(1.0, 2.0, 3.0).scale(2.0, 4.0, 0.5).sphere(-1, [1e-5, 1e6, 0.1], 0.5);
    let expected = "\
NODE: M(1, 0, 0, 0; 0, 1, 0, 0; 0, 0, 1, 0; 0, 0, 0, 1)
  objectToWorld: M(1, 0, 0, 0; 0, 1, 0, 0; 0, 0, 1, 0; 0, 0, 0, 1)
  worldToObject: M(1, 0, 0, 0; 0, 1, 0, 0; 0, 0, 1, 0; 0, 0, 0, 1)
  NODE: M(1, 0, 0, 1; 0, 1, 0, 2; 0, 0, 1, 3; 0, 0, 0, 1)
    objectToWorld: M(1, 0, 0, 1; 0, 1, 0, 2; 0, 0, 1, 3; 0, 0, 0, 1)
    worldToObject: M(1, 0, 0, -1; 0, 1, 0, -2; 0, 0, 1, -3; 0, 0, 0, 1)
    NODE: M(2, 0, 0, 0; 0, 4, 0, 0; 0, 0, 0.5, 0; 0, 0, 0, 1)
      objectToWorld: M(2, 0, 0, 1; 0, 4, 0, 2; 0, 0, 0.5, 3; 0, 0, 0, 1)
      worldToObject: M(0.5, 0, 0, -0.5; 0, 0.25, 0, -0.5; 0, 0, 2, -6; 0, 0, 0, 1)
      SPHERE: C(1e-05, 1e+06, 0.1) R=0.5
";
    assert_eq!(text(&scene([build.close().close()]), true), expected);
}

#[test]
fn instances_show_the_tree_they_place() {
    let vertices = |build: Build| {
        build
            .vertex([0.0, 0.0, 0.0], [0.0, 0.0, 1.0], [0.0, 0.0])
            .vertex([1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [1.0, 0.0])
            .vertex([0.0, 1.0, 0.0], [1.0, 0.0, 0.0], [0.0, 0.25])
    };
    let main = Build::file(0).include(1).instance(0).translate(0.0, 0.0, 7.0).instance(0).close();
    let part = vertices(Build::file(1)).indexed(0, [2, 0, 1]).sphere(0, [0.0, 0.0, 0.0], 2.0);
    let triangle = "TRIANGLE: V(0, 1, 0) V(0, 0, 0) V(1, 0, 0) N(1, 0, 0) N(0, 0, 1) N(0, 1, 0) \
                    T(0, 0.25) T(0, 0) T(1, 0)";
    let expected = format!(
        "\
NODE: M(1, 0, 0, 0; 0, 1, 0, 0; 0, 0, 1, 0; 0, 0, 0, 1)
  INSTANCE: 1.ray
    {triangle}
    SPHERE: C(0, 0, 0) R=2
  NODE: M(1, 0, 0, 0; 0, 1, 0, 0; 0, 0, 1, 7; 0, 0, 0, 1)
    INSTANCE: 1.ray
      {triangle}
      SPHERE: C(0, 0, 0) R=2
"
    );
    assert_eq!(text(&scene([main, part]), false), expected);
}

#[test]
fn singular_nodes_are_named() {
    let build = Build::file(0).scale(1.0, 0.0, 1.0).translate(1.0, 0.0, 0.0).close().close();
    let printed = text(&scene([build]), true);
    assert_eq!(printed.matches("objectToWorld: singular").count(), 2);
    assert_eq!(printed.matches("worldToObject:").count(), 1);
}

#[test]
fn deep_trees_print_in_linear_space() {
    let mut build = Build::file(0);
    for _ in 0..100_000 {
        build = build.translate(0.0, 0.0, 0.0);
    }
    let scene = scene([build.sphere(-1, [0.0, 0.0, 0.0], 1.0)]);
    // A dump that grows with the square of the depth fails here instead of filling the memory.
    let mut bytes = vec![0; 100_001 * 300];
    let mut rest = bytes.as_mut_slice();
    dump(&scene.files, DumpOptions::default(), &mut rest).unwrap();
    let unused = rest.len();
    bytes.truncate(bytes.len() - unused);
    let printed = String::from_utf8(bytes).unwrap();
    assert_eq!(printed.lines().count(), 100_002);
    let indent = " ".repeat(200);
    assert_eq!(printed.lines().last().unwrap(), format!("{indent}[100001] SPHERE: C(0, 0, 0) R=1"));
    assert!(printed.lines().nth(100).unwrap().starts_with(&format!("{indent}NODE: M(")));
}

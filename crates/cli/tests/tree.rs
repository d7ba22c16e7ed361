//! `dotray tree`: groups with their boxes, and the figures of accelerators.

mod common;

use common::Folder;
use common::root;
use serde_json::Value;

fn json(folder: &Folder, arguments: &str) -> Value {
    let ended = folder.run(&format!("tree {arguments} --format json")).expect(0);
    serde_json::from_slice(&ended.stdout).expect("one JSON object")
}

#[test]
fn boxes_hold_what_stands_in_groups() {
    let folder = Folder::new();
    let text = folder.run("tree balls.ray").expect(0).text();
    let expected = "\
scene   2 shapes  x -1.7 … 1.3, y -1 … 1, z -1 … 1.5
  group balls.ray:7:1  1 shapes  x -1.7 … 0.3, y -1 … 1, z -1 … 1
    matrix 1 0 0 -0.7; 0 1 0 0; 0 0 1 0; 0 0 0 1
    sphere 0 balls.ray:8:1  x -1.7 … 0.3, y -1 … 1, z -1 … 1
  sphere 1 balls.ray:10:1  x 0.3 … 1.3, y -0.5 … 0.5, z 0.5 … 1.5
";
    assert_eq!(text, expected);
    let world = folder.run("tree balls.ray --world").expect(0).text();
    assert!(world.contains("worldToObject 1 0 0 0.7; 0 1 0 0; 0 0 1 0; 0 0 0 1"), "{world}");

    let told = json(&folder, "balls.ray --world");
    let nodes = told["nodes"].as_array().expect("nodes");
    assert_eq!(nodes[1]["parent"], 0);
    assert_eq!(nodes[1]["object_to_world"][0], serde_json::json!([1.0, 0.0, 0.0, -0.7]));
    let bound =
        |node: &Value, side: &str, axis: usize| node["bounds"][side][axis].as_f64().expect("a number");
    for node in nodes.iter().filter(|node| !node["bounds"].is_null()) {
        let Some(parent) = node["parent"].as_u64() else { continue };
        let parent = &nodes[parent as usize];
        for axis in 0..3 {
            assert!(bound(parent, "min", axis) <= bound(node, "min", axis));
            assert!(bound(parent, "max", axis) >= bound(node, "max", axis));
        }
    }
}

#[test]
fn long_runs_are_cut_and_say_so() {
    let folder = Folder::new();
    let spheres = "#shape_sphere -1 0 0 0 1\n".repeat(30);
    folder.put("many.ray", format!("#camera 0 0 4 0 0 -1 0 1 0 .5\n{spheres}").as_bytes());
    let text = folder.run("tree many.ray --shapes 7").expect(0).text();
    assert_eq!(text.matches("sphere ").count(), 7, "{text}");
    assert!(text.contains("… and 23 more"), "{text}");
}

#[test]
fn accelerators_show_their_figures() {
    let folder = Folder::new();
    let scene = root().join("scenes/chess.ray");
    let told = json(&folder, &format!("{} --accel all", scene.display()));
    let all = told["accelerators"].as_array().expect("five");
    let kinds: Vec<&str> = all.iter().filter_map(|one| one["kind"].as_str()).collect();
    assert_eq!(kinds, ["brute", "boxes", "octree", "bsp", "bvh"]);
    let number = |one: &Value, name: &str| one[name].as_f64().expect("a number");
    let shapes = number(&all[0], "shapes");
    assert_eq!(number(&all[0], "sah_cost"), shapes);
    for one in &all[1..] {
        assert_eq!(number(one, "shapes"), shapes);
        assert!(number(one, "sah_cost") < shapes && number(one, "depth") >= 1.0, "{one}");
        let leaves: u64 =
            one["leaf_sizes"].as_array().expect("a list").iter().filter_map(Value::as_u64).sum();
        assert_eq!(Some(leaves), one["leaves"].as_u64());
    }
    let text = folder.run(&format!("tree {} --accel bvh", scene.display())).expect(0).text();
    assert!(text.starts_with("bvh: ") && text.contains("leaf sizes"), "{text}");
    folder.run("tree balls.ray --accel bvh --format svg").expect(2).says("no drawing");
    let svg = folder.run(&format!("tree {} --format svg", scene.display())).expect(0).text();
    assert!(svg.starts_with("<svg ") && svg.contains("from above") && !svg.contains("NaN"));
}

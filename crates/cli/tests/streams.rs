//! Standard input, output and error; statistics; the commands that print.

mod common;

use common::BALLS;
use common::Folder;
use serde_json::Value;

fn json(text: &str) -> Value {
    serde_json::from_str(text).unwrap_or_else(|error| panic!("{error} in: {text}"))
}

#[test]
fn a_scene_may_come_and_a_picture_go_by_pipe() {
    let folder = Folder::new();
    folder.run("render balls.ray a.png 16 12").expect(0);
    folder.run("render balls.ray a.qoi 16 12").expect(0);
    let piped = folder.run_with_input("render - - 16 12", BALLS.as_bytes()).expect(0);
    assert_eq!(piped.stdout, folder.get("a.png"));
    assert_eq!(piped.stderr, "");
    let piped = folder.run_with_input("render - --width 16 --format qoi", BALLS.as_bytes()).expect(0);
    assert_eq!(piped.stdout, folder.get("a.qoi"));
    let wrong = folder.run_with_input("render - -", common::WRONG.as_bytes()).expect(1).says("<stdin>:2:1");
    assert!(wrong.stdout.is_empty());
}

#[test]
fn names_in_a_piped_scene_are_relative_to_the_working_directory() {
    let folder = Folder::new();
    let input =
        b"#ray_file balls.ray #ray_file_instance 0 #light_dir 1 1 1 0 0 -1 #camera 0 0 9 0 0 -1 0 1 0 .3";
    folder.run_with_input("render - a.png 8 6", input).expect(0);
    folder.run_with_input("info -", input).expect(0);
}

#[test]
fn a_pipe_sees_no_progress_and_no_colour() {
    let folder = Folder::new();
    let ended = folder.run("render balls.ray a.png 300 200").expect(0);
    assert_eq!((ended.stderr.as_str(), ended.text().as_str()), ("", ""));
    let ended = folder.run("render wrong.ray a.png").expect(1);
    assert!(!ended.stderr.contains('\u{1b}'), "{}", ended.stderr);
    folder.run("render wrong.ray a.png --color always").expect(1).says("\u{1b}[");
}

#[test]
fn statistics_are_complete_json() {
    let folder = Folder::new();
    let ended = folder.run("render balls.ray a.png 16 12 --stats=json --threads 2 --accel octree").expect(0);
    assert_eq!(ended.stderr, "");
    let stats = json(&ended.text());
    assert_eq!(stats["rays"]["eye"], 16 * 12);
    assert_eq!((&stats["threads"], &stats["accelerator"]), (&Value::from(2), &Value::from("octree")));
    assert_eq!((&stats["width"], &stats["shapes"]), (&Value::from(16), &Value::from(2)));
    assert_eq!(stats["memory"]["text"], BALLS.len());
    assert_eq!(stats["memory"]["film"], 16 * 12 * 3 * 4);
    let kinds = ["eye", "shadow", "reflected", "refracted"].map(|kind| stats["rays"][kind].as_u64().unwrap());
    assert!(kinds.iter().all(|&count| count > 0), "{stats}");
    assert_eq!(stats["rays"]["total"], kinds.iter().sum::<u64>());
    for stage in
        ["read", "parse", "resolve", "textures", "build", "bake", "trace", "encode", "write", "total"]
    {
        assert!(stats["seconds"][stage].as_f64().is_some_and(|seconds| seconds >= 0.0), "{stage}: {stats}");
    }
    for part in ["shapes", "scene", "accelerator", "textures"] {
        assert!(stats["memory"][part].is_u64(), "{part}: {stats}");
    }
}

#[test]
fn every_key_of_the_statistics_is_documented() {
    let folder = Folder::new();
    let stats = json(&folder.run("render balls.ray a.png 8 6 --stats=json").expect(0).text());
    let page = folder.run("man --markdown").expect(0).text();
    let mut open = vec![&stats];
    while let Some(value) = open.pop() {
        for (key, inner) in value.as_object().into_iter().flatten() {
            assert!(page.contains(&format!("`{key}`")), "`{key}` is not documented");
            open.push(inner);
        }
    }
}

#[test]
fn statistics_keep_out_of_the_pictures_way() {
    let folder = Folder::new();
    let ended = folder.run("render balls.ray - 8 6 --stats=json").expect(0);
    assert!(ended.stdout.starts_with(b"\x89PNG"));
    json(&ended.stderr);
    let ended = folder.run("render balls.ray a.png 8 6 --stats --quiet").expect(0).says("eye rays");
    assert!(ended.stdout.is_empty());
    folder.run("render balls.ray a.png 8 6 --stats=xml").expect(2);
}

#[test]
fn a_reader_who_goes_is_no_fault() {
    let folder = Folder::new();
    let many = format!("{BALLS}{}", "#shape_sphere 0 0 0 0 1\n".repeat(20_000));
    folder.put("many.ray", many.as_bytes());
    // Each prints more than a pipe holds, but the last.
    for arguments in ["dump many.ray", "render balls.ray - --width 600 --format bmp", "man --markdown"] {
        let mut command = folder.command(arguments);
        command.stdout(std::process::Stdio::piped()).stderr(std::process::Stdio::piped());
        let mut child = command.spawn().unwrap();
        drop(child.stdout.take());
        let output = child.wait_with_output().unwrap();
        let stderr = String::from_utf8_lossy(&output.stderr);
        assert!(!stderr.contains("panicked"), "{arguments}: {stderr}");
        assert_eq!(output.status.code(), Some(0), "{arguments}: {stderr}");
    }
}

#[test]
fn dump_prints_the_tree() {
    let folder = Folder::new();
    let text = folder.run("dump balls.ray").expect(0).text();
    assert!(text.contains("\n    SPHERE: C(0, 0, 0) R=1\n"), "{text}");
    assert!(text.contains("\n  SPHERE: C(0.8, 0, 1) R=0.5\n"), "{text}");
    assert!(!text.contains("objectToWorld"));
    let text = folder.run("dump --world balls.ray").expect(0).text();
    assert!(text.contains("objectToWorld") && text.contains("worldToObject"), "{text}");
    folder.run("dump wrong.ray").expect(1).says("wrong.ray:2:1");
}

#[test]
fn dump_prints_the_tree_of_a_scene_that_cannot_be_rendered() {
    let folder = Folder::new();
    let tiny = "#group_begin 1e-200 0 0 0 0 1e-200 0 0 0 0 1e-200 0 0 0 0 1\n";
    let text = format!("{tiny}{tiny}#shape_sphere -1 0 0 0 1 #group_end #group_end");
    folder.put("flat.ray", text.as_bytes());
    let ended = folder.run("dump flat.ray").expect(1).says("flat.ray:2:1");
    assert!(ended.text().contains("SPHERE: C(0, 0, 0) R=1"), "{}", ended.text());
}

#[test]
fn info_counts() {
    let folder = Folder::new();
    let text = folder.run("info balls.ray").expect(0).text();
    assert!(text.contains("2 spheres"), "{text}");
    let info = json(&folder.run("info balls.ray --format json").expect(0).text());
    assert_eq!((&info["shapes"]["spheres"], &info["lights"]["point"]), (&Value::from(2), &Value::from(1)));
    assert_eq!((&info["materials"], &info["groups"]), (&Value::from(2), &Value::from(1)));
    assert_eq!(info["camera"]["position"], serde_json::json!([0.0, 0.0, 4.0]));
    assert_eq!(info["camera"]["is_default"], false);
    folder.run("info wrong.ray").expect(1);
}

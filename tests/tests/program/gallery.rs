//! Every scene of the gallery renders; the slides' example as printed is explained.

use dotray_tests::corpus;
use dotray_tests::program;

const AS_PRINTED: &str = "slides-as-printed.ray";

#[test]
fn every_scene_renders_without_a_message() {
    let folder = corpus::root().join("scenes");
    let scenes = corpus::scenes_in(&folder);
    assert!(scenes.len() >= 10, "the gallery has {} scenes", scenes.len());
    let out = tempfile::tempdir().expect("a folder for pictures");
    for scene in scenes {
        let name = scene.file_name().expect("a name").to_string_lossy().into_owned();
        if name == AS_PRINTED {
            continue;
        }
        let picture = out.path().join(format!("{name}.bmp"));
        let (scene, picture_name) = (scene.to_string_lossy(), picture.to_string_lossy());
        let output = program::run(out.path(), &["render", &scene, &picture_name, "40", "30"]);
        assert_eq!(output.status.code(), Some(0), "{name}: {}", program::shown(&output));
        assert!(output.stderr.is_empty(), "{name}: {}", program::shown(&output));
        let bytes = std::fs::read(&picture).expect("a picture");
        // A BMP's rows are full words: 40 pixels of 3 bytes are 120.
        assert_eq!((&bytes[..2], bytes.len()), (&b"BM"[..], 54 + 30 * 120), "{name}");
        assert!(bytes[54..].iter().any(|&byte| byte != bytes[54]), "{name}: the picture is empty");
    }
}

#[test]
fn the_example_as_printed_is_explained() {
    let folder = corpus::root().join("scenes");
    let out = tempfile::tempdir().expect("a folder for pictures");
    let scene = folder.join(AS_PRINTED);
    let output = program::run(out.path(), &["render", &scene.to_string_lossy(), "never.png", "40", "30"]);
    assert_eq!(output.status.code(), Some(1), "{}", program::shown(&output));
    assert!(!out.path().join("never.png").exists());
    let message = String::from_utf8_lossy(&output.stderr).into_owned();
    // The row at fault is shown, at its place, and the row that was meant, for both matrices.
    for (row, line) in message_lines(&scene) {
        assert!(message.contains(&format!("{AS_PRINTED}:{line}:")), "line {line} in {message}");
        assert!(message.contains(&row), "{row} in {message}");
    }
    assert_eq!(message.matches("group-matrix").count(), 2, "{message}");
    assert!(message.matches("0 0 1 0").count() >= 2, "the matrix meant in {message}");
}

/// The rows that have no inverse, with their lines.
fn message_lines(scene: &std::path::Path) -> Vec<(String, usize)> {
    let text = std::fs::read_to_string(scene).expect("the example");
    let lines = text.lines().enumerate().filter(|(_, line)| line.contains("meant: "));
    lines.map(|(i, line)| (line.split("//").next().unwrap_or("").trim().to_owned(), i + 1)).collect()
}

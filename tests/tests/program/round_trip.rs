//! `write(parse(text))` parses to the same scene and gives the same picture.

use dotray_accel::Kind;
use dotray_render::Options;
use dotray_scene::Files;
use dotray_scene::Scene;
use dotray_scene::files::Disk;
use dotray_scene::write::write;
use dotray_tests::corpus;
use dotray_tests::pictures;
use dotray_tests::targets::without_places;
use std::collections::HashMap;
use std::io;
use std::path::Path;
use std::path::PathBuf;

/// The disk, where the scene's own files have been written anew.
struct Rewritten(HashMap<PathBuf, String>);

impl Files for Rewritten {
    fn read(&self, path: &Path) -> io::Result<Vec<u8>> {
        match self.0.get(&self.identity(path)) {
            Some(text) => Ok(text.clone().into_bytes()),
            None => Disk.read(path),
        }
    }

    fn identity(&self, path: &Path) -> PathBuf {
        Disk.identity(path)
    }
}

/// Reads a scene, writes all its files, and reads those.
fn there_and_back(path: &Path) -> (Scene, Scene) {
    let scene = pictures::scene_of_file(path, &Disk).unwrap_or_else(|error| panic!("{error}"));
    let texts = scene.files.iter().map(|file| (Disk.identity(&file.path), write(file))).collect();
    let files = Rewritten(texts);
    let again = pictures::scene_of_file(path, &files).unwrap_or_else(|error| panic!("{error}"));
    (scene, again)
}

fn assert_same(path: &Path) {
    let (scene, again) = there_and_back(path);
    let name = path.display();
    let text = |scene: &Scene| scene.files.iter().map(write).collect::<String>();
    let (before, after) = (text(&scene), text(&again));
    if let Some((line, other)) = before.lines().zip(after.lines()).find(|(line, other)| line != other) {
        panic!("{name}: `{line}` comes back as `{other}`");
    }
    assert_eq!(before.len(), after.len(), "{name}");
    assert!(
        without_places(&scene) == without_places(&again),
        "{name}: the same text, but not the same scene"
    );
    let options = Options { width: 32, height: 24, ..Options::default() };
    let picture = |scene: Scene| {
        let world = pictures::world(scene, Kind::Bvh).unwrap_or_else(|error| panic!("{name}: {error}"));
        pictures::picture(&world, &options).unwrap_or_else(|error| panic!("{name}: {error}"))
    };
    assert_eq!(pictures::difference(&picture(scene), &picture(again)), None, "{name}");
}

#[test]
fn conformance_scenes_come_back() {
    let scenes = corpus::scenes_in(&corpus::root().join("tests/conformance"));
    assert_eq!(scenes.len(), 47);
    scenes.iter().for_each(|path| assert_same(path));
}

#[test]
fn the_gallery_comes_back() {
    let scenes = corpus::scenes_in(&corpus::root().join("scenes"));
    assert!(scenes.len() >= 10);
    for path in scenes.iter().filter(|path| !path.ends_with("slides-as-printed.ray")) {
        assert_same(path);
    }
}

#[test]
fn another_scene_is_told_apart() {
    let folder = corpus::root().join("tests/conformance");
    let read = |name: &str| pictures::scene_of_file(&folder.join(name), &Disk).expect("a scene");
    let (mut small, other) =
        (without_places(&read("shape_box.ray")), without_places(&read("shape_cone.ray")));
    assert_ne!(small, other);
    let before = small.clone();
    small.files[0].cuboids.materials[0] += 1;
    assert_ne!(small, before);
}

//! The pictures that come with the conformance suite and the real scenes are read, where they are there.

#![allow(clippy::unwrap_used)]

use std::fs;
use std::path::Path;
use std::path::PathBuf;

use dotray_image::Format;
use dotray_image::Limits;
use dotray_image::compare::Class;
use dotray_image::compare::conformance;
use dotray_image::decode;

fn pictures_below(folder: &Path, found: &mut Vec<PathBuf>) {
    let mut entries: Vec<PathBuf> =
        fs::read_dir(folder).unwrap().map(|entry| entry.unwrap().path()).collect();
    entries.sort();
    for path in entries {
        if path.is_dir() {
            pictures_below(&path, found);
        } else if Format::from_path(&path).is_ok_and(Format::is_built) {
            found.push(path);
        }
    }
}

#[test]
fn shared_pictures_are_read() {
    let shared = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../../shared");
    if !shared.is_dir() {
        println!("skipped, no ../shared");
        return;
    }
    let mut pictures = Vec::new();
    for folder in ["conformance", "real-scenes"] {
        pictures_below(&shared.join(folder), &mut pictures);
    }
    assert!(pictures.iter().filter(|path| path.extension().is_some_and(|e| e == "bmp")).count() >= 5);
    for path in &pictures {
        let bytes = fs::read(path).unwrap();
        let image = decode(&bytes, Format::from_path(path).ok(), &Limits::default());
        let image = image.unwrap_or_else(|error| panic!("{}: {error}", path.display()));
        assert!(conformance(&image, &image, Class::Exact, false).passed(), "{}", path.display());
    }
    println!("{} pictures read", pictures.len());
}

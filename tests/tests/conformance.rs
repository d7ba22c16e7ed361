//! The conformance scenes: one named test for each scene and accelerator.
//!
//! Each picture must agree with its reference, and the picture of each accelerator must be that of brute force, bit
//! for bit. What fails is written to `target/conformance/SCENE-ACCELERATOR.png`: expected, difference, actual.

use dotray_accel::Kind;
use dotray_image::Format;
use dotray_image::Image;
use dotray_image::compare::Class;
use dotray_image::compare::conformance;
use dotray_image::compare::difference_picture;
use dotray_scene::files::Disk;
use dotray_tests::corpus;
use dotray_tests::corpus::Case;
use dotray_tests::pictures;
use libtest_mimic::Arguments;
use libtest_mimic::Failed;
use libtest_mimic::Trial;
use std::sync::Arc;
use std::sync::OnceLock;

/// A scene with the picture of brute force, which is made once.
struct Entry {
    case: Case,
    brute: OnceLock<Result<Image, String>>,
}

fn main() {
    let entries =
        corpus::conformance().into_iter().map(|case| Arc::new(Entry { case, brute: OnceLock::new() }));
    let trials = entries.flat_map(|entry| {
        Kind::ALL.map(|kind| {
            let (entry, name) = (Arc::clone(&entry), format!("{}::{}", entry.case.name, kind.name()));
            Trial::test(name, move || test(&entry, kind))
        })
    });
    libtest_mimic::run(&Arguments::from_args(), trials.collect()).exit();
}

fn test(entry: &Entry, kind: Kind) -> Result<(), Failed> {
    let brute = entry.brute.get_or_init(|| render(&entry.case, Kind::Brute)).as_ref()?;
    let other;
    let actual = if kind == Kind::Brute {
        brute
    } else {
        other = render(&entry.case, kind)?;
        &other
    };
    let expected = reference(&entry.case)?;
    let class = if entry.case.statistical { Class::Statistical } else { Class::Exact };
    let figures = conformance(&expected, actual, class, false);
    if !figures.passed() {
        let faults = figures.failures.join("; ");
        return Err(explain(entry, kind, &expected, actual, &faults));
    }
    match pictures::difference(brute, actual) {
        None => Ok(()),
        Some(difference) => {
            Err(explain(entry, kind, brute, actual, &format!("unlike brute force: {difference}")))
        }
    }
}

fn render(case: &Case, kind: Kind) -> Result<Image, String> {
    let scene = pictures::scene_of_file(&case.scene, &Disk)?;
    pictures::picture(&pictures::world(scene, kind)?, &case.options)
}

fn reference(case: &Case) -> Result<Image, String> {
    let bytes = std::fs::read(&case.reference).map_err(|error| error.to_string())?;
    dotray_image::decode(&bytes, Some(Format::Exr), &dotray_image::Limits::default())
        .map_err(|error| error.to_string())
}

/// Stores the three-part picture and says what is wrong.
fn explain(entry: &Entry, kind: Kind, expected: &Image, actual: &Image, faults: &str) -> Failed {
    let folder = corpus::root().join("target/conformance");
    let path = folder.join(format!("{}-{}.png", entry.case.name, kind.name()));
    let stored = std::fs::create_dir_all(&folder).map_err(|error| error.to_string()).and_then(|()| {
        let parts = difference_picture(expected, actual).map_err(|error| error.to_string())?;
        let bytes = dotray_image::encode(&parts, Format::Png, &dotray_image::EncodeOptions::default());
        let bytes = bytes.map_err(|error| error.to_string())?;
        dotray_image::write_file(&path, &bytes).map_err(|error| error.to_string())
    });
    let where_to_look = match stored {
        Ok(()) => format!("expected, difference, actual: {}", path.display()),
        Err(error) => format!("the difference could not be stored: {error}"),
    };
    format!("{faults}\n{where_to_look}").into()
}

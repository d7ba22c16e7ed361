//! Each dialect means what the slides' own words beside it mean, and what is converted looks the same.

use dotray_accel::Kind;
use dotray_image::Image;
use dotray_render::Options;
use dotray_scene::Dialect;
use dotray_scene::Scene;
use dotray_scene::convert::Converted;
use dotray_scene::convert::convert;
use dotray_scene::files::Disk;
use dotray_scene::load::LoadOptions;
use dotray_scene::load::load;
use dotray_scene::load::load_text;
use dotray_scene::write::write;
use dotray_tests::corpus;
use dotray_tests::pictures;
use std::collections::BTreeMap;
use std::path::Path;
use std::path::PathBuf;

fn folder() -> PathBuf {
    corpus::root().join("scenes/dialects")
}

fn picture(scene: Scene) -> Image {
    let world = pictures::world(scene, Kind::Bvh).expect("the scene is sound");
    pictures::picture(&world, &Options { width: 80, height: 60, ..Options::default() }).expect("a picture")
}

/// A scene of our own; lines that begin with one of `without` are left out.
fn read(name: &str, expected: Dialect, without: &[&str]) -> Scene {
    let text = std::fs::read_to_string(folder().join(name)).expect("the scene");
    let kept = text.lines().filter(|line| !without.iter().any(|start| line.starts_with(start)));
    let kept = kept.collect::<Vec<_>>().join("\n");
    let loaded = load_text(name, kept, &Disk, &LoadOptions::default());
    assert_eq!(loaded.dialect, expected, "{name}");
    loaded.scene.unwrap_or_else(|| panic!("{name}: {:?}", loaded.diagnostics))
}

/// The share of samples that differ by more than rounding.
fn difference(a: &Image, b: &Image) -> f64 {
    let far = a.samples().iter().zip(b.samples()).filter(|(a, b)| (*a - *b).abs() > 1e-5).count();
    far as f64 / a.samples().len() as f64
}

#[test]
fn dialects_mean_what_their_twins_mean() {
    let twins = [
        ("table-uva.ray", Dialect::Uva, "table-slides.ray", &[][..]),
        ("table-jhu.ray", Dialect::Jhu, "table-slides.ray", &[][..]),
        ("pipes-hmc.ray", Dialect::Hmc, "pipes-twin.ray", &["#cylinder -n open", "#torus"][..]),
        ("blocks-unisa.scene", Dialect::Unisa, "blocks-twin.ray", &[][..]),
    ];
    for (name, dialect, twin, without) in twins {
        let ours = picture(read(name, dialect, without));
        let theirs = picture(read(twin, Dialect::Slides, &[]));
        let share = difference(&ours, &theirs);
        assert!(share <= 0.001, "{name}: {share} of the samples differ from {twin}");
        assert!(ours.samples().iter().any(|sample| *sample > 0.3), "{name} is dark");
    }
}

#[test]
fn shapes_that_the_slides_lack_are_seen() {
    let whole = picture(read("pipes-hmc.ray", Dialect::Hmc, &[]));
    for shape in ["#torus", "#cylinder -n open"] {
        let without = picture(read("pipes-hmc.ray", Dialect::Hmc, &[shape]));
        assert!(difference(&whole, &without) > 0.01, "{shape}");
    }
    let ring = picture(read("ring-jhu.ray", Dialect::Jhu, &[]));
    assert!(difference(&ring, &picture(read("ring-jhu.ray", Dialect::Jhu, &["#shape_torus"]))) > 0.01);
}

fn converted(scene: &Scene, to: Dialect) -> Converted {
    let absolute = |file: &dotray_scene::model::SceneFile, name: &str| {
        let folder = file.path.parent().unwrap_or(Path::new(""));
        folder.join(name).display().to_string()
    };
    convert(scene, to, &absolute).expect("it can be written")
}

fn read_as(text: &str, dialect: Dialect) -> Scene {
    let options = LoadOptions { dialect: Some(dialect), ..LoadOptions::default() };
    let loaded = load_text("converted.ray", text, &Disk, &options);
    loaded.scene.unwrap_or_else(|| panic!("{:?}\n{text}", loaded.diagnostics))
}

#[test]
fn what_is_carried_over_and_back_looks_the_same() {
    let mut scenes = corpus::scenes_in(&corpus::root().join("tests/conformance"));
    scenes.extend(corpus::scenes_in(&folder()));
    let mut carried = BTreeMap::new();
    for path in scenes {
        let Some(scene) = load(&path, &Disk, &LoadOptions::default()).scene else { continue };
        for to in [Dialect::Uva, Dialect::Jhu, Dialect::Hmc, Dialect::Unisa] {
            let there = converted(&scene, to);
            let foreign = read_as(&there.text, to);
            let back = converted(&foreign, Dialect::Slides);
            let again = read_as(&back.text, Dialect::Slides);
            if !there.lost.is_empty() || !back.lost.is_empty() {
                continue;
            }
            *carried.entry(to.name()).or_insert(0) += 1;
            let original = picture(scene.clone());
            for (step, scene) in [("there", foreign), ("back", again)] {
                let share = difference(&original, &picture(scene));
                assert!(share <= 0.002, "{} to {to}, {step}: {share} differ", path.display());
            }
        }
    }
    println!("carried there and back: {carried:?}");
    let least = [("uva", 5), ("jhu", 5), ("hmc", 2), ("unisa", 40)];
    let enough = |(name, least): &(&str, u32)| carried.get(name).is_some_and(|count| count >= least);
    assert!(least.iter().all(enough), "{carried:?}");
}

/// Every shape, in groups and out of them, with a texture and a spot: all of it can be said in each dialect.
#[test]
fn every_shape_is_carried_everywhere() {
    let card = corpus::root().join("grading/card.bmp");
    let text = format!(
        "#camera 0 1 12  0 -.1 -1  0 1 0  .22  #background 0 0 0  #ambient .2 .2 .2
         #light_point .7 .7 .7  3 6 8  1 0 0  #light_spot .8 .7 .6  -4 5 6  .4 -.5 -.6  1 0 0  .5 .03
         #texture \"{}\"
         #material .3 .2 .1  .7 .5 .3  .4 .4 .4  0 0 0  1 0 1  -1 !!
         #material .4 .4 .4  .8 .8 .8  0 0 0  0 0 0  .3 0 1  0 !!
         #shape_cylinder 0  -3 .5 0  .7 1.5  #shape_cone 1  -1 .5 0  .8 1.6  #shape_sphere 1  1 .4 0  .8
         #group_begin .8 -.6 .1 3  .6 .8 0 -.2  0 .2 1 .3  0 0 0 1
           #shape_box 1  0 0 0  1 1.2 .9  #shape_cone -1  0 1.5 0  .5 1  #shape_cylinder 1  0 -1.5 .2  .4 1
           #shape_triangle 1  -1 0 1  1 0 1  0 1 1  0 0 1  0 0 1  0 0 1  0 1  1 1  .5 0
         #group_end",
        card.display()
    );
    let original = read_as(&text, Dialect::Slides);
    let truth = picture(original.clone());
    for to in Dialect::ALL {
        let there = converted(&original, to);
        let losses: Vec<_> = there.lost.iter().map(|lost| &lost.message).collect();
        assert!(losses.is_empty(), "{to}: {losses:?}");
        let foreign = read_as(&there.text, to);
        assert!(difference(&truth, &picture(foreign.clone())) <= 0.001, "{to}:\n{}", there.text);
        let back = converted(&foreign, Dialect::Slides);
        assert!(difference(&truth, &picture(read_as(&back.text, Dialect::Slides))) <= 0.001, "{to}, back");
    }
    assert!(truth.samples().iter().filter(|sample| **sample > 0.4).count() > 300);
}

/// A file of each dialect, written as it was read, is the same to its reader.
#[test]
fn what_is_written_in_a_dialect_is_read_alike() {
    for (name, dialect) in [("pipes-hmc.ray", Dialect::Hmc), ("blocks-unisa.scene", Dialect::Unisa)] {
        let scene = read(name, dialect, &[]);
        let text = write(&scene.files[0]);
        let again = read_as(&text, dialect);
        assert_eq!(write(&again.files[0]), text, "{name}");
        assert_eq!(
            load_text("a.ray", text.clone(), &Disk, &LoadOptions::default()).dialect,
            dialect,
            "{text}"
        );
        let share = difference(&picture(scene), &picture(again));
        assert!(share <= 0.001, "{name}: {share}");
    }
}

#[test]
fn what_is_lost_is_told() {
    let scene = read_as(
        "#background 1 1 1 #light_area 1 1 1 0 5 0 0 -1 0 .5 1 0 0
         #material 1 1 1 1 1 1 1 1 1 0 0 0 .5 0 1 -1 !two words! #shape_sphere 0 0 0 0 1",
        Dialect::Slides,
    );
    let codes = |to: Dialect| -> Vec<String> {
        converted(&scene, to).lost.into_iter().map(|lost| lost.message).collect()
    };
    assert!(codes(Dialect::Slides).is_empty());
    let lost = codes(Dialect::Jhu).join("\n");
    for part in ["no longer show the background", "no area light", "the mirror's weight", "one word"] {
        assert!(lost.contains(part), "{part} is not in\n{lost}");
    }
    let lost = codes(Dialect::Hmc).join("\n");
    for part in
        ["no area light", "the mirror's weight becomes that of the highlight", "`!two words!` is left out"]
    {
        assert!(lost.contains(part), "{part} is not in\n{lost}");
    }
    assert_eq!(codes(Dialect::Unisa).len(), 1, "the area light alone");
    let blunt = read_as("#shape_cone -1 0 0 0 1 2 .5  #light_dir 1 1 1 0 0 -1", Dialect::Slides);
    for to in [Dialect::Uva, Dialect::Jhu, Dialect::Hmc, Dialect::Unisa] {
        let told = converted(&blunt, to).lost.iter().any(|lost| lost.message.contains("no truncated cone"));
        assert!(told, "{to}");
    }
    assert!(converted(&blunt, Dialect::Slides).lost.is_empty());
    let hollow = read_as(
        "#shape_side -1 0 0 0 1 2  #shape_side -1 0 0 0 1 2 .5  #light_dir 1 1 1 0 0 -1",
        Dialect::Slides,
    );
    for to in Dialect::ALL {
        let lost: Vec<String> = converted(&hollow, to).lost.into_iter().map(|lost| lost.message).collect();
        let told = |part: &str| lost.iter().filter(|message| message.contains(part)).count();
        let expected = match to {
            Dialect::Slides => (0, 0),
            Dialect::Hmc => (0, 1),
            Dialect::Uva | Dialect::Jhu | Dialect::Unisa => (2, 1),
        };
        assert_eq!((told("closed by discs"), told("no truncated cone")), expected, "{to}: {lost:?}");
    }
    let curved = read_as(
        "#shape_triangle -1  0 0 0  1 0 0  0 1 0  0 0 1  0 1 1  1 0 1  0 0  1 0  0 1  #light_dir 1 1 1 0 0 -1",
        Dialect::Slides,
    );
    let lost = converted(&curved, Dialect::Hmc).lost;
    assert!(lost.iter().any(|lost| lost.message.contains("1 of them lose the normals")), "{lost:?}");
    let ring = read("ring-jhu.ray", Dialect::Jhu, &[]);
    let lost: Vec<String> =
        converted(&ring, Dialect::Slides).lost.into_iter().map(|lost| lost.message).collect();
    let lost = lost.join("\n");
    for part in ["no torus", "ambient colour", "that of the highlights", "ks = 0.3125"] {
        assert!(lost.contains(part), "{part} is not in\n{lost}");
    }
}

//! Writing back changes numbers and nothing else.

use dotray_geometry::Vec3;
use dotray_scene::Dialect;
use dotray_scene::files::Disk;
use dotray_scene::model::Light;
use rayview::document::Document;
use rayview::document::open;
use rayview::edit::camera_line;
use rayview::edit::rounded_camera;
use rayview::edit::with_camera;
use std::path::PathBuf;

const TEXT: &str = "// a comment\r\n#camera 0 0 4  0 0 -1  0 1 0  .523 // looks along z
#background .2  .30 .5\t/* sky */
#ambient 1 1 1
#light_num 2
#light_point 1 1 1   1.50 2 3
     1 0 0   // fades not
#light_spot 1 1 1 0 5 0 0 -1 0 1 0 0 .5 .01
#material_num 1
#material .1 .1 .1   .8 .20 .2
          1 1 1      0 0 0      .5 0 1.0 -1 !my own text!
#shape_sphere 0 0 0 0 1
";

fn opened(text: &str) -> (tempfile::TempDir, PathBuf, Document) {
    let folder = tempfile::tempdir().expect("a folder");
    let path = folder.path().join("scene.ray");
    std::fs::write(&path, text).expect("written");
    let document = open(&path, &Disk).expect("a scene").document;
    (folder, path, document)
}

fn written(document: &Document) -> String {
    let texts = document.edited_texts().expect("texts");
    assert_eq!(texts.len(), 1);
    String::from_utf8(texts[0].1.clone()).expect("text")
}

#[test]
fn only_the_numbers_that_differ_are_written() {
    let (_folder, _, mut document) = opened(TEXT);
    assert!(!document.is_edited() && document.edited_texts().expect("none").is_empty());
    let mut material = document.files()[0].materials[0].value.clone();
    material.diffuse.y = 0.35;
    document.set_material(0, 0, material).expect("fine");
    let Light::Point { color, mut position, mut attenuation } = document.files()[0].lights[0].value else {
        panic!("a point light")
    };
    (position.z, attenuation.linear) = (-7.25, 0.125);
    document.set_light(0, Light::Point { color, position, attenuation }).expect("fine");
    document.set_background(Vec3::new(0.2, 0.3, 1e-7)).expect("fine");
    assert!(document.is_edited());
    let expected = TEXT
        .replace(".8 .20 .2", ".8 0.35 .2")
        .replace("1.50 2 3\n     1 0 0 ", "1.50 2 -7.25\n     1 0.125 0 ")
        .replace(".2  .30 .5\t", ".2  .30 1e-7\t");
    assert_eq!(written(&document), expected);
}

#[test]
fn the_camera_is_written_in_place_or_before_everything() {
    let (_folder, _, document) = opened(TEXT);
    let mut camera = document.camera;
    camera.position = Vec3::new(1.0 / 3.0, 0.0, 4.0);
    let camera = rounded_camera(&camera);
    let text = with_camera(TEXT.as_bytes(), document.camera_span(), &camera).expect("text");
    let expected = TEXT.replace("#camera 0 0 4", "#camera 0.3333333 0 4");
    assert_eq!(String::from_utf8(text).expect("text"), expected);
    let (_folder, _, without) = opened("\u{feff}#light_dir 1 1 1 0 0 -1 #shape_sphere -1 0 0 0 1");
    let source = without.sources.bytes(dotray_scene::span::FileId(0));
    let text = with_camera(source, without.camera_span(), &camera).expect("text");
    let expected = "\u{feff}#camera 0.3333333 0 4  0 0 -1  0 1 0  0.523\n#light_dir";
    assert!(String::from_utf8(text).expect("text").starts_with(expected));
    assert_eq!(camera_line(&camera), "#camera 0.3333333 0 4  0 0 -1  0 1 0  0.523");
}

#[test]
fn what_the_scene_does_not_allow_is_not_taken() {
    let (_folder, _, mut document) = opened(TEXT);
    let before = document.files()[0].materials[0].value.clone();
    let mut material = before.clone();
    (material.k_transmission, material.index_of_refraction) = (0.5, 0.0);
    let fault = document.set_material(0, 0, material).expect_err("no index of refraction");
    assert!(fault.contains("index of refraction"), "{fault}");
    assert_eq!(document.files()[0].materials[0].value, before);
    assert!(!document.is_edited());
}

#[test]
fn other_dialects_are_shown_and_not_edited() {
    let path = std::path::Path::new(env!("CARGO_MANIFEST_DIR")).join("../../scenes/dialects");
    let mut seen = 0;
    for entry in std::fs::read_dir(path).expect("dialects").flatten() {
        if entry.path().extension().is_some_and(|extension| extension == "ray") {
            let document = open(&entry.path(), &Disk).expect("a scene").document;
            assert_eq!(document.can_edit(), document.dialect == Dialect::Slides, "{:?}", entry.path());
            seen += usize::from(document.dialect != Dialect::Slides);
        }
    }
    assert!(seen > 0);
}

#[test]
fn all_faults_of_a_file_are_told_with_their_places() {
    let folder = tempfile::tempdir().expect("a folder");
    let path = folder.path().join("broken.ray");
    std::fs::write(&path, "#shape_spere 0 0 0 0 1\n#material 1 2 x\n").expect("written");
    let messages = open(&path, &Disk).expect_err("faults");
    assert!(messages.iter().filter(|message| message.error).count() >= 2);
    assert!(messages[0].text.contains("broken.ray:1:1") && messages[0].text.contains("#shape_sphere"));
}

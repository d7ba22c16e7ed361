//! `dotray compare`: figures, pictures, profiles, exit codes.

mod common;

use common::Folder;
use dotray::image::Channels;
use dotray::image::EncodeOptions;
use dotray::image::Format;
use dotray::image::Image;
use dotray::image::Limits;
use dotray::image::decode;
use dotray::image::encode;
use serde_json::Value;

/// A picture of 40 x 30 pixels, one of its pixels red.
fn picture(red: f32, size: (usize, usize)) -> Image {
    let mut image = Image::new(size.0, size.1, Channels::Rgb).expect("a small picture");
    for (place, sample) in image.samples_mut().iter_mut().enumerate() {
        *sample = (place / 3 % 16) as f32 / 255.0;
    }
    image.set_pixel(7, 5, [red, 0.0, 0.0, 1.0]);
    image
}

fn put(folder: &Folder, name: &str, image: &Image) {
    let format = Format::from_path(name.as_ref()).expect("a known extension");
    folder.put(name, &encode(image, format, &EncodeOptions::default()).expect("a file"));
}

fn folder() -> Folder {
    let folder = Folder::new();
    put(&folder, "a.png", &picture(0.0, (40, 30)));
    for name in ["b.bmp", "b.png", "b.ppm", "b.qoi", "b.tif", "b.exr", "b.pfm"] {
        put(&folder, name, &picture(0.8, (40, 30)));
    }
    folder
}

#[test]
fn every_format_is_compared_with_every_other() {
    let folder = folder();
    for name in ["b.bmp", "b.ppm", "b.qoi", "b.tif", "b.exr", "b.pfm"] {
        let text = folder.run(&format!("compare b.png {name} --profile exact")).expect(0).text();
        assert!(text.contains("within       exact"), "{text}");
        folder.run(&format!("compare a.png {name} --profile exact")).expect(3);
    }
    // A pixel is forgiven by those who forgive pixels.
    folder.run("compare a.png b.png").expect(0);
    folder.run("compare a.png b.png --profile lenient").expect(0);
}

#[test]
fn figures_are_those_of_one_pixel() {
    let folder = folder();
    let text = folder.run("compare a.png b.png --profile exact").expect(3).text();
    for part in [
        "size         40 x 30",
        "max          0.800000     204.000/255 at 7,5",
        "pixels over  1 of 1200 (0.083 %) by more than 0.500/255",
        "difference            red       green        blue",
        "0/255                1199        1200        1200",
        "129-/255                1           0           0",
        "over exact   99.92 % of the pixels agree within 0.500/255, 100 % are wanted",
    ] {
        assert!(text.contains(part), "no `{part}` in: {text}");
    }
    let json = folder.run("compare a.png b.png --format json").expect(0).text();
    let json: Value = serde_json::from_str(&json).expect("one JSON object");
    let close = |key: &str, expected: f64| {
        let found = json[key].as_f64().expect("a number");
        assert!((found - expected).abs() < 1e-6, "{key}: {found}");
    };
    close("mean", 0.8 / 3600.0);
    close("rmse", (0.64_f64 / 3600.0).sqrt());
    close("psnr", 37.501_225_267_834);
    assert_eq!(json["max_at"], serde_json::json!([7, 5]));
    assert_eq!(json["pixels_over"], 1);
    assert_eq!(json["within"], true);
    assert_eq!(json["histogram"].as_array().map(Vec::len), Some(10));
    assert!(json["ssim"].as_f64() > Some(0.5) && json["ssim"].as_f64() < Some(1.0), "{json}");
    assert!(json["flip"]["mean"].as_f64() > Some(0.0) && json["flip"]["max"].as_f64() > Some(0.3), "{json}");
    let equal = folder.run("compare b.bmp b.png --format json").expect(0).text();
    let equal: Value = serde_json::from_str(&equal).expect("one JSON object");
    assert_eq!((&equal["psnr"], &equal["ssim"]), (&Value::Null, &serde_json::json!(1.0)));
}

#[test]
fn tolerances_replace_the_profiles() {
    let folder = folder();
    folder.run("compare a.png b.png --profile exact --tolerance 0.9").expect(3).says("");
    let text = folder.run("compare a.png b.png --tolerance 0.9").expect(0).text();
    assert!(text.contains("0 of 1200 (0.000 %) by more than 229.500/255"), "{text}");
    let text = folder.run("compare a.png b.png --tolerance 0").expect(0).text();
    assert!(text.contains("1 of 1200"), "{text}");
}

#[test]
fn pictures_are_written_on_request() {
    let folder = folder();
    folder.run("compare a.png b.png --profile exact --picture parts.png --flip-picture seen.bmp").expect(3);
    let image = |name: &str| decode(&folder.get(name), None, &Limits::default()).expect("a picture");
    let (parts, seen) = (image("parts.png"), image("seen.bmp"));
    assert_eq!((parts.width(), parts.height()), (120, 30));
    assert_eq!(parts.pixel(40 + 7, 5), Some([1.0, 0.0, 0.0, 1.0]));
    assert_eq!(parts.pixel(40 + 20, 20), Some([0.0, 0.0, 0.0, 1.0]));
    assert_eq!((seen.width(), seen.height()), (40, 30));
    assert!(seen.pixel(7, 5) > Some([0.3; 4]) && seen.pixel(39, 29) == Some([0.0, 0.0, 0.0, 1.0]));
}

#[test]
fn floats_are_clamped_only_beside_whole_numbers() {
    let folder = folder();
    put(&folder, "bright.exr", &picture(7.0, (40, 30)));
    put(&folder, "bright.png", &picture(7.0, (40, 30)));
    put(&folder, "white.exr", &picture(1.0, (40, 30)));
    folder.run("compare bright.exr bright.png --profile exact").expect(0);
    let text = folder.run("compare bright.exr white.exr --profile exact").expect(3).text();
    assert!(text.contains("max          6.000000"), "{text}");
}

#[test]
fn faults_are_told() {
    let folder = folder();
    put(&folder, "small.png", &picture(0.0, (40, 29)));
    folder.put("text.png", b"not a picture");
    folder.run("compare a.png small.png").expect(1).says("40 x 30 and 40 x 29");
    folder.run("compare a.png none.png").expect(1).says("cannot read `none.png`");
    folder.run("compare a.png text.png").expect(1).says("cannot read `text.png`");
    folder.run("compare a.png").expect(2).says("<B>");
    folder.run("compare a.png b.png --profile loose").expect(2).says("lenient");
    folder.run("compare a.png b.png --tolerance nan").expect(2).says("0 or more");
    folder.run("compare a.png b.png --picture a").expect(2).says("no extension");
    folder.run("compare a.png b.png --picture no/a.png").expect(1).says("no folder");
}

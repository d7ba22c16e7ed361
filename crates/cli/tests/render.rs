//! `dotray render` as people and scripts use it.

mod common;

use common::Folder;
use dotray::image::Image;
use dotray::image::Limits;
use dotray::image::decode;

fn picture(bytes: &[u8]) -> Image {
    decode(bytes, None, &Limits::default()).expect("a picture")
}

#[test]
fn the_six_values_in_their_places_are_those_of_the_options() {
    let folder = Folder::new();
    folder.run("render balls.ray a.bmp 40 30 1 0.5").expect(0);
    folder.run("render balls.ray -o b.bmp --width 40 --height 30 --recursion 1 --cutoff 0.5").expect(0);
    folder.run("render --in balls.ray --out c.bmp --width 40 --height 30 --rLimit 1 --cLimit 0.5").expect(0);
    folder.run("render balls.ray d.bmp 40 30 5 0").expect(0);
    let first = folder.get("a.bmp");
    assert_eq!(first, folder.get("b.bmp"));
    assert_eq!(first, folder.get("c.bmp"));
    assert_ne!(first, folder.get("d.bmp"), "limit and threshold have no effect");
}

#[test]
fn a_bmp_has_the_header_of_the_slides() {
    let folder = Folder::new();
    folder.run("render balls.ray a.bmp 10 7").expect(0);
    let bytes = folder.get("a.bmp");
    let number =
        |at: usize| bytes[at..at + 4].iter().rev().fold(0_u32, |sum, &byte| sum << 8 | u32::from(byte));
    assert_eq!(&bytes[..2], b"BM");
    assert_eq!((number(2) as usize, number(10), number(14)), (bytes.len(), 54, 40));
    assert_eq!((number(18), number(22), bytes[28], number(30)), (10, 7, 24, 0));
    assert_eq!(bytes.len(), 54 + 7 * 32);
}

#[test]
fn without_a_name_the_picture_stands_in_the_working_directory() {
    let folder = Folder::new();
    std::fs::create_dir(folder.path("sub")).unwrap();
    std::fs::rename(folder.path("balls.ray"), folder.path("sub/my.balls.ray")).unwrap();
    folder.run("render sub/my.balls.ray --width 8").expect(0).says("my.balls.png (8x6");
    let image = picture(&folder.get("my.balls.png"));
    assert_eq!((image.width(), image.height()), (8, 6));
}

#[test]
fn every_format_can_be_written_and_read() {
    let folder = Folder::new();
    folder.run("render balls.ray exact.pfm 16 12").expect(0);
    let exact = picture(&folder.get("exact.pfm"));
    for name in ["a.bmp", "a.png", "a.jpg", "a.ppm", "a.qoi", "a.tif", "a.exr", "a.hdr"] {
        folder.run(&format!("render balls.ray {name} 16 12")).expect(0);
        let image = picture(&folder.get(name));
        assert_eq!((image.width(), image.height()), (16, 12), "{name}");
        let lossy = if name == "a.jpg" { 0.3 } else { 0.01 };
        let difference = |(a, b): (&f32, &f32)| (a.clamp(0.0, 1.0) - b.clamp(0.0, 1.0)).abs();
        let worst = exact.samples().iter().zip(image.samples()).map(difference).fold(0.0, f32::max);
        assert!(worst < lossy, "{name}: {worst}");
    }
    folder.run("render balls.ray deep.png 16 12 --depth 16").expect(0);
    assert_eq!(folder.get("deep.png")[24], 16, "bits a channel");
    folder.run("render balls.ray named.dat 16 12 --format qoi").expect(0);
    assert_eq!(folder.get("named.dat"), folder.get("a.qoi"));
    folder.run("render balls.ray srgb.png 16 12 --srgb").expect(0);
    assert_ne!(folder.get("srgb.png"), folder.get("a.png"));
}

#[test]
fn a_crop_is_the_part_of_the_whole() {
    let folder = Folder::new();
    for how in ["none", "grid=2", "adaptive"] {
        folder.run(&format!("render balls.ray whole.pfm 50 40 --aa {how}")).expect(0);
        folder.run(&format!("render balls.ray part.pfm 50 40 --aa {how} --crop 13,4,20,30")).expect(0);
        let whole = picture(&folder.get("whole.pfm"));
        assert_eq!(whole.crop(13, 4, 20, 30), Some(picture(&folder.get("part.pfm"))), "{how}");
    }
    folder
        .run("render balls.ray part.pfm 50 40 --crop 13,4,20,37")
        .expect(2)
        .says("inside the picture of 50x40");
}

#[test]
fn what_does_not_matter_does_not_matter() {
    let folder = Folder::new();
    folder.run("render balls.ray a.pfm 50 40").expect(0);
    let expected = folder.get("a.pfm");
    let words =
        ["--accel brute", "--accel boxes", "--accel octree", "--accel bsp", "--build fast", "--build best"];
    for same in words.into_iter().chain(["--threads 1", "--threads 3", "--tile-size 8", "--quiet"]) {
        folder.run(&format!("render balls.ray b.pfm 50 40 {same}")).expect(0);
        assert!(folder.get("b.pfm") == expected, "{same} changes the picture");
    }
    for other in ["--aa grid=2", "--aa adaptive", "--recursion 0", "--cutoff 0.9", "--shadows off"] {
        folder.run(&format!("render balls.ray b.pfm 50 40 {other}")).expect(0);
        assert!(folder.get("b.pfm") != expected, "{other} changes nothing");
    }
}

#[test]
fn warnings_are_shown_and_the_picture_is_made() {
    let folder = Folder::new();
    folder.run("render warning.ray a.png 8 6").expect(0).says("warning").says("warning.ray:2:1");
    assert!(folder.names().contains(&"a.png".to_owned()));
    assert_eq!(folder.run("render warning.ray a.png 8 6 --quiet").expect(0).stderr, "");
}

#[test]
fn a_wrong_scene_leaves_an_old_picture_as_it_was() {
    let folder = Folder::new();
    folder.put("a.png", b"an old picture");
    let before = folder.names();
    folder.run("render wrong.ray a.png").expect(1).says("wrong.ray:2:1").says("#shape_sphere");
    folder.run("render missing.ray a.png").expect(1).says("missing.ray");
    assert_eq!(folder.get("a.png"), b"an old picture");
    assert_eq!(folder.names(), before);
}

#[test]
fn a_missing_texture_leaves_nothing() {
    let folder = Folder::new();
    let text = format!("{}#texture no.png\n#material 0 0 0 1 1 1 0 0 0 0 0 0 0 0 1 0 !!\n", common::BALLS);
    folder.put("textured.ray", text.as_bytes());
    folder.run("render textured.ray a.png 8 6").expect(1).says("no.png").says("textured.ray:11");
    assert!(!folder.names().contains(&"a.png".to_owned()));
}

#[test]
fn places_that_cannot_be_written_are_told_before_the_work() {
    let folder = Folder::new();
    std::fs::create_dir(folder.path("folder.png")).unwrap();
    let before = folder.names();
    // The scene is missing too, but the picture's place is looked at first.
    folder.run("render missing.ray no/where/a.png").expect(1).says("there is no folder `no/where`");
    folder.run("render missing.ray folder.png").expect(1).says("it is a folder");
    folder.run("render missing.ray balls.ray/a.png").expect(1).says("balls.ray/a.png");
    folder.run("render balls.ray balls.ray --format png").expect(2).says("overwrite the scene");
    let mut permissions = std::fs::metadata(folder.path("wrong.ray")).unwrap().permissions();
    permissions.set_readonly(true);
    std::fs::set_permissions(folder.path("wrong.ray"), permissions).unwrap();
    folder.run("render balls.ray wrong.ray --format png").expect(1).says("write-protected");
    assert_eq!(folder.names(), before);
}

#[cfg(target_os = "linux")]
#[test]
fn a_device_stays_a_device() {
    let folder = Folder::new();
    folder.run("render balls.ray /dev/null 8 6 --format bmp").expect(0);
    folder.run("render balls.ray /dev/full 8 6 --format bmp").expect(1).says("/dev/full");
}

#[cfg(unix)]
#[test]
fn ctrl_c_stops_and_leaves_nothing() {
    use std::time::Duration;
    let folder = Folder::new();
    let before = folder.names();
    let mut command = folder.command("render balls.ray a.png --size 4000x4000 --aa grid=16 --threads 1");
    let mut child = command.stderr(std::process::Stdio::piped()).spawn().unwrap();
    std::thread::sleep(Duration::from_millis(500));
    let sent = std::process::Command::new("kill").args(["-INT", &child.id().to_string()]).status();
    if !sent.is_ok_and(|status| status.success()) {
        child.kill().and_then(|()| child.wait()).unwrap();
        println!("skipped, no program `kill`");
        return;
    }
    let output = child.wait_with_output().unwrap();
    assert_eq!(output.status.code(), Some(130));
    assert_eq!(String::from_utf8_lossy(&output.stderr), "interrupted; nothing was written\n");
    assert_eq!(folder.names(), before);
}

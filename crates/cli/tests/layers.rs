//! `dotray render` with layers, backgrounds and overlays.

mod common;

use common::Folder;
use common::root;
use dotray::image::Channels;
use dotray::image::Image;
use dotray::image::Limits;
use dotray::image::decode;

const LAYERS: [&str; 14] = [
    "depth",
    "normal",
    "position",
    "shape",
    "material",
    "st",
    "object",
    "shadow",
    "direct",
    "reflected",
    "transmitted",
    "rays",
    "boxtests",
    "shapetests",
];

fn picture(folder: &Folder, name: &str) -> Image {
    decode(&folder.get(name), None, &Limits::default()).unwrap_or_else(|error| panic!("{name}: {error}"))
}

/// Whether a file holds a channel of this name.
fn has_channel(file: &[u8], name: &str) -> bool {
    let entry = [b"\0", name.as_bytes(), b"\0"].concat();
    file.windows(entry.len()).any(|window| window == entry)
}

#[test]
fn one_exr_holds_all_layers_and_still_the_picture() {
    let folder = Folder::new();
    folder.run("render balls.ray plain.exr 40 30").expect(0);
    folder.run("render balls.ray all.exr 40 30 --layers all").expect(0);
    let names = folder.names();
    assert!(!names.iter().any(|name| name.ends_with(".png")), "{names:?}");
    assert_eq!(picture(&folder, "all.exr"), picture(&folder, "plain.exr"));
    let bytes = folder.get("all.exr");
    for channel in ["depth.Z", "normal.X", "position.Y", "shape.id", "st.T", "direct.R", "rays.count"] {
        assert!(has_channel(&bytes, channel), "{channel}");
        assert!(!has_channel(&folder.get("plain.exr"), channel));
    }
}

#[test]
fn other_formats_get_a_picture_a_layer() {
    let folder = Folder::new();
    folder.run("render balls.ray all.png 200 150 --layers all").expect(0);
    folder.run("render balls.ray plain.png 200 150").expect(0);
    assert_eq!(folder.get("all.png"), folder.get("plain.png"));
    for layer in LAYERS {
        let image = picture(&folder, &format!("all.{layer}.png"));
        let legend = if ["depth", "rays", "boxtests", "shapetests"].contains(&layer) { 28 } else { 0 };
        assert_eq!((image.width(), image.height()), (200, 150 + legend), "{layer}");
        assert!(layer == "st" || image.samples().iter().any(|&x| x > 0.0), "{layer} is black");
    }
    // What is met nearest has the dark end of the map, what is not met is black.
    let depth = picture(&folder, "all.depth.png");
    assert_eq!(depth.pixel(0, 0), Some([0.0, 0.0, 0.0, 1.0]));
    // The legend runs from viridis's purple to its yellow.
    let [left, right] = [0, 199].map(|x| depth.pixel(x, 155).expect("the legend"));
    assert!(left[2] > left[1] && right[0] > 0.9 && right[1] > 0.9 && right[2] < 0.3, "{left:?} {right:?}");
    folder.run("render balls.ray some.jpg 20 15 --layers depth,normal").expect(0);
    let made: Vec<_> = folder.names().into_iter().filter(|name| name.starts_with("some")).collect();
    assert_eq!(made, ["some.depth.png", "some.jpg", "some.normal.png"]);
    folder.run("render balls.ray x.png 20 15 --layers hight").expect(2).says("no layer is named `hight`");
    folder.run("render balls.ray - 20 15 --layers depth").expect(2).says("--format exr");
}

#[cfg(unix)]
#[test]
fn a_picture_and_its_layers_are_stored_together_or_not_at_all() {
    let folder = Folder::new();
    folder.run("render balls.ray a.png 20 15 --layers depth,normal").expect(0);
    let before = ["a.png", "a.depth.png", "a.normal.png"].map(|name| folder.get(name));
    // The last layer goes to a device that is always full: nothing of the set changes.
    std::fs::remove_file(folder.path("a.normal.png")).expect("it was there");
    std::os::unix::fs::symlink("/dev/full", folder.path("a.normal.png")).expect("a link in its place");
    let names = folder.names();
    folder.run("render balls.ray a.png 24 18 --layers depth,normal").expect(1).says("a.normal.png");
    assert_eq!([folder.get("a.png"), folder.get("a.depth.png")], before[..2]);
    assert_eq!(folder.names(), names);
}

#[test]
fn transparent_pictures_have_coverage_for_alpha() {
    let folder = Folder::new();
    folder.run("render balls.ray a.png 40 30 --background transparent").expect(0);
    folder.run("render balls.ray plain.png 40 30").expect(0);
    let (clear, plain) = (picture(&folder, "a.png"), picture(&folder, "plain.png"));
    assert_eq!(clear.channels(), Channels::Rgba);
    assert_eq!(clear.pixel(0, 0), Some([0.0; 4]));
    // Where something is met, the colours are as ever, reflections of the background included.
    let solid: Vec<_> = (0..40 * 30)
        .map(|i| (i % 40, i / 40))
        .filter(|&(x, y)| clear.pixel(x, y).unwrap()[3] == 1.0)
        .collect();
    assert!(solid.len() > 100 && solid.len() < 1100, "{}", solid.len());
    assert!(solid.iter().all(|&(x, y)| clear.pixel(x, y) == plain.pixel(x, y)));

    folder.run("render balls.ray grid.exr 40 30 --aa grid=4 --background transparent").expect(0);
    let grid = picture(&folder, "grid.exr");
    let partial: Vec<f32> =
        grid.samples().chunks_exact(4).map(|p| p[3]).filter(|a| *a > 0.0 && *a < 1.0).collect();
    assert!(partial.len() > 20 && partial.iter().all(|a| (a * 16.0).fract() == 0.0), "{partial:?}");
    // Over the scene's own background the transparent picture is the usual one.
    folder.run("render balls.ray usual.exr 40 30 --aa grid=4").expect(0);
    let usual = picture(&folder, "usual.exr");
    for (clear, usual) in grid.samples().chunks_exact(4).zip(usual.samples().chunks_exact(3)) {
        for ((c, u), b) in clear.iter().zip(usual).zip([0.1, 0.2, 0.3]) {
            assert!((c * clear[3] + b * (1.0 - clear[3]) - u).abs() < 1e-5, "{clear:?} {usual:?}");
        }
    }
    for name in ["a.bmp", "a.jpg", "a.ppm", "a.hdr", "a.pfm"] {
        let ended = folder.run(&format!("render balls.ray {name} 40 30 --background transparent"));
        ended.expect(2).says("needs an alpha channel");
    }
}

#[test]
fn adaptive_alpha_does_not_depend_on_tiles_and_threads() {
    let folder = Folder::new();
    let line = |name: &str, more: &str| {
        format!("render balls.ray {name} 60 45 --aa adaptive --background transparent {more}")
    };
    folder.run(&line("a.exr", "--tile-size 8 --threads 3")).expect(0);
    folder.run(&line("b.exr", "--tile-size 64 --threads 1")).expect(0);
    assert_eq!(folder.get("a.exr"), folder.get("b.exr"));
    let alphas: Vec<f32> = picture(&folder, "a.exr").samples().chunks_exact(4).map(|p| p[3]).collect();
    assert!(alphas.iter().any(|&a| a > 0.0 && a < 1.0));
}

#[test]
fn pictures_and_colours_lie_behind() {
    let folder = Folder::new();
    folder.run("render balls.ray red.ppm 40 30 --background 1,0,0").expect(0);
    assert_eq!(picture(&folder, "red.ppm").pixel(0, 0), Some([1.0, 0.0, 0.0, 1.0]));
    folder.put("back.ppm", b"P3 2 1 255  255 0 0  0 0 255");
    folder.run("render balls.ray on.ppm 40 30 --background image:back.ppm").expect(0);
    let on = picture(&folder, "on.ppm");
    assert_eq!((on.pixel(0, 0), on.pixel(39, 0)), (Some([1.0, 0.0, 0.0, 1.0]), Some([0.0, 0.0, 1.0, 1.0])));
    // At a silhouette both show: a picture of the scene's own background changes nothing.
    let flat: Vec<u8> = [0.1_f32, 0.2, 0.3].iter().flat_map(|x| x.to_le_bytes()).collect();
    folder.put("flat.pfm", &[b"PF\n1 1\n-1.0\n", flat.as_slice()].concat());
    folder.run("render balls.ray own.pfm 40 30 --aa grid=4").expect(0);
    folder.run("render balls.ray flat-behind.pfm 40 30 --aa grid=4 --background image:flat.pfm").expect(0);
    let [own, behind] = ["own.pfm", "flat-behind.pfm"].map(|name| picture(&folder, name));
    assert!(own.samples().iter().zip(behind.samples()).all(|(a, b)| (a - b).abs() < 1e-5));
    // A colour is seen in mirrors, too.
    let mirror = "#camera 0 0 4 0 0 -1 0 1 0 .5  #light_dir 1 1 1 0 0 -1  #background 0 0 0
        #material 0 0 0 0 0 0 1 1 1 0 0 0 1 0 1 -1 !!  #shape_box 0 0 0 0 9 9 1";
    folder.put("mirror.ray", mirror.as_bytes());
    folder.run("render mirror.ray seen.ppm 4 4 --background 0,1,0 --shadows off").expect(0);
    let seen = picture(&folder, "seen.ppm").pixel(0, 0).expect("a pixel");
    assert!(seen[1] == 1.0 && seen[0] < 1.0, "{seen:?}");
    // A part of it has the same part of the background.
    folder.run("render balls.ray part.ppm 40 30 --background image:back.ppm --crop 10,0,25,9").expect(0);
    assert_eq!(picture(&folder, "part.ppm"), on.crop(10, 0, 25, 9).expect("inside"));
    folder.run("render balls.ray x.ppm 4 3 --background image:none.png").expect(1).says("none.png");
    folder.run("render balls.ray x.ppm 4 3 --background red").expect(2).says("transparent, or image:FILE");
}

#[test]
fn boxes_are_drawn_over_the_picture() {
    let folder = Folder::new();
    let scene = root().join("scenes/slides.ray");
    for overlay in ["", "--overlay bounds"] {
        let name = if overlay.is_empty() { "plain.ppm" } else { "boxes.ppm" };
        folder.run(&format!("render {} {name} 120 90 {overlay}", scene.display())).expect(0);
    }
    let (plain, boxes) = (picture(&folder, "plain.ppm"), picture(&folder, "boxes.ppm"));
    let changed =
        (0..120 * 90).filter(|i| plain.pixel(i % 120, i / 120) != boxes.pixel(i % 120, i / 120)).count();
    assert!(changed > 100 && changed < 3000, "{changed}");
    // The outermost level is the scene's own box; the accelerators' boxes lie within it, and are fewer a level.
    let count_of = |more: &str| {
        let scene = root().join("scenes/caffeine.ray");
        for (name, overlay) in [("plain", ""), ("accel", "--overlay accel")] {
            let more = if overlay.is_empty() { "" } else { more };
            folder
                .run(&format!("render {} {name}.ppm 120 90 --shadows off {overlay} {more}", scene.display()))
                .expect(0);
        }
        let [plain, boxes] = ["plain.ppm", "accel.ppm"].map(|name| picture(&folder, name));
        (0..120 * 90).filter(|i| plain.pixel(i % 120, i / 120) != boxes.pixel(i % 120, i / 120)).count()
    };
    let outermost = count_of("--overlay-levels 1");
    for kind in ["bvh", "boxes", "octree", "bsp"] {
        let all = count_of(&format!("--accel {kind}"));
        assert!(all > outermost + 20 && all < 8000, "{kind}: {outermost} {all}");
    }
    assert_eq!(count_of("--accel brute"), outermost);
    assert_eq!(count_of("--overlay-levels 0"), 0);
    folder.run("render balls.ray a.ppm 40 30 --overlay-levels 1").expect(2).says("--overlay");
    // The left ball's box: its front face, of z = 1, spans x -1.7 to .3, seen from z = 4 with a half angle of .5.
    folder.run("render balls.ray a.ppm 40 30 --overlay bounds").expect(0);
    let a = picture(&folder, "a.ppm");
    let column = |x: f64| (20.0 + x / 3.0 * 15.0 / 0.546_302_5) as usize;
    assert_eq!(a.pixel(column(-1.7), 15), Some([1.0, 153.0 / 255.0, 26.0 / 255.0, 1.0]));
}

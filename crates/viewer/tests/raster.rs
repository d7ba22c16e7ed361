//! The preview against the renderer's picture without shadows and further rays, without a window, with whatever driver
//! there is (a software one in CI). Without any it says so and passes, unless `RAYVIEW_SCREEN=required`.

mod offscreen;

use dotray_image::EncodeOptions;
use dotray_image::Format;
use dotray_image::Image;
use dotray_image::encode;
use dotray_render::Options;
use dotray_render::PrepareOptions;
use dotray_render::Shadows;
use dotray_render::Silent;
use dotray_render::World;
use dotray_scene::files::Disk;
use rayview::document::Opened;
use rayview::document::open;
use rayview::gpu::Raster;
use rayview::hidden::Hidden;
use std::path::Path;

const WIDTH: u32 = 480;
const HEIGHT: u32 = 320;

fn raster() -> Option<Raster> {
    let device = offscreen::device();
    if device.is_none() {
        let required = std::env::var("RAYVIEW_SCREEN").is_ok_and(|value| value == "required");
        assert!(!required, "no driver draws here");
        println!("skipped, no driver");
    }
    device.map(|device| Raster::new(&device))
}

fn opened(path: &Path) -> Opened {
    open(path, &Disk).unwrap_or_else(|messages| panic!("{}: {messages:?}", path.display()))
}

fn load(raster: &mut Raster, opened: &Opened) {
    let document = &opened.document;
    raster.load(&document.packed, document.draft.as_ref(), &document.pictures, &document.style);
}

/// What the rasteriser draws, red, green and blue.
fn drawn(raster: &mut Raster, opened: &Opened) -> Vec<u8> {
    raster.draw(&opened.document.camera, [WIDTH, HEIGHT], false).expect("a picture");
    while raster.is_unfinished() {
        raster.go_on();
    }
    let ([width, height], pixels) = raster.pixels().expect("pixels");
    assert_eq!((width, height), (WIDTH, HEIGHT));
    pixels.chunks_exact(4).flat_map(|pixel| pixel.iter().take(3).copied()).collect()
}

fn rendered(opened: Opened) -> Vec<u8> {
    let world = World::prepare(opened.resolved, &Disk, &PrepareOptions::default()).expect("a world");
    let options =
        Options { width: WIDTH, height: HEIGHT, recursion: 0, shadows: Shadows::Off, ..Options::default() };
    dotray_render::render(&world, &options, &Silent).expect("a picture").image.to_rgb8(false)
}

/// The share of the pixels that differ by more than 6 of 255 in a channel; both pictures are kept where
/// `RAYVIEW_SHOTS` says.
fn unlike(name: &str, a: &[u8], b: &[u8]) -> f64 {
    if let Some(folder) = std::env::var_os("RAYVIEW_SHOTS") {
        let both = a.chunks_exact(3 * WIDTH as usize).zip(b.chunks_exact(3 * WIDTH as usize));
        let samples =
            both.flat_map(|(a, b)| a.iter().chain(b)).map(|byte| f32::from(*byte) / 255.0).collect();
        let channels = dotray_image::Channels::Rgb;
        let image =
            Image::from_samples(2 * WIDTH as usize, HEIGHT as usize, channels, samples).expect("an image");
        let file = encode(&image, Format::Png, &EncodeOptions::default()).expect("a file");
        std::fs::write(Path::new(&folder).join(format!("raster-{name}.png")), file).expect("written");
    }
    let pixels = a.chunks_exact(3).zip(b.chunks_exact(3));
    let off = pixels.filter(|(a, b)| a.iter().zip(*b).any(|(a, b)| a.abs_diff(*b) > 6)).count();
    off as f64 / (a.len() / 3) as f64
}

/// Draws a scene and traces it: less than `most` of the pixels may be off. Returns what was drawn.
fn drawn_as_traced(raster: &mut Raster, name: &str, opened: Opened, most: f64) -> Vec<u8> {
    load(raster, &opened);
    let picture = drawn(raster, &opened);
    let share = unlike(name, &picture, &rendered(opened));
    println!("{name}: {share:.4}");
    assert!(share < most, "{name}: {share} of the pixels are off");
    picture
}

const HEAD: &str = "#camera 0 3 11  0 -.22 -1  0 1 0  .36
#background .2 .3 .5
#ambient .6 .6 .6
#light_point .4 .4 .3  2 6 4  1 0 .01
#light_spot .6 .2 .2  -3 5 3  .5 -1 -.5  1 0 0  .6 .05
#light_dir .3 .3 .2  -1 -1 -1
#light_area .3 .3 .5  4 3 3  -1 -.6 -.8  .1  1 .05 0
#texture_num 1
#texture cells.png
#material_num 4
#material .2 .2 .2  .7 .7 .7  .3 .3 .3  0 0 0  .2 0 1  0 !textured!
#material .2 .1 .1  .8 .3 .2  .6 .6 .6  .05 0 0  .3 0 1  -1 !plain!
#material .1 .2 .1  .3 .7 .4  .4 .4 .4  .1 .1 0  .1 0 1  -1 !green!
#material .2 .2 .2  .8 .8 .8  .4 .4 .4  0 0 0  0 0 1  0 !*shiny 90!
";

/// One of each shape, with the material of a number, side by side.
fn each(material: u32) -> String {
    let m = material;
    format!(
        "#shape_sphere {m} -4 0 0 .5\n#shape_box {m} -2.7 0 0 .9 .8 .7\n#shape_cylinder {m} -1.4 0 0 .45 1
         #shape_cone {m} -.1 0 0 .5 1.1\n#shape_cone {m} 1.2 0 0 .5 1 .25\n#shape_cone {m} 2.5 0 0 .2 .9 .5
         #shape_box {m} 3.6 .1 0 .8 .8 0
         #shape_triangle {m} 4.2 -.4 0 5.2 -.4 0 4.7 .6 0  0 0 1 0 0 1 .3 .3 1  0 1 1 1 .5 0\n"
    )
}

/// Every shape as it is, squeezed and sheared in a group, and mirrored, turned over and enlarged in two.
fn every_shape() -> String {
    let mut text = HEAD.to_owned();
    text += &format!("#group_begin 1 0 0 0 0 1 0 2.2 0 0 1 0 0 0 0 1\n{}#group_end\n", each(1));
    text += "#group_begin 1 0 0 0 0 1 0 -2.6 0 0 1 1.2 0 0 0 1
        #group_begin .96 .28 0 0 -.28 .96 0 0 0 0 1 0 0 0 0 1\n";
    text += &format!("#group_begin .8 .3 0 .3 0 1.3 0 2.4 0 .3 .7 -1 0 0 0 1\n{}#group_end\n", each(0));
    text += "#group_end\n#group_end\n";
    text += &format!(
        "#group_begin 1 0 0 0 0 -.95 .3 -1.6 0 .3 .95 .5 0 0 0 1\n#group_begin -1 0 0 .3 0 1 0 0 0 0 1 0 0 0 0 1\n{}",
        each(3)
    );
    text += "#group_end\n#group_end\n#shape_box 2 0 -3 0 14 .2 9\n";
    text
}

fn cells() -> Vec<u8> {
    let pixel = |at: usize| match (at % 8 + at / 8) % 3 {
        0 => [0.9, 0.8, 0.2],
        1 => [0.2, 0.4, 0.8],
        _ => [0.8, 0.3, 0.3],
    };
    png(8, 8, (0..64).flat_map(pixel).collect())
}

fn png(width: usize, height: usize, samples: Vec<f32>) -> Vec<u8> {
    let image = Image::from_samples(width, height, dotray_image::Channels::Rgb, samples).expect("an image");
    encode(&image, Format::Png, &EncodeOptions::default()).expect("a file")
}

#[test]
fn every_shape_is_drawn_as_it_is_traced() {
    let Some(mut raster) = raster() else { return };
    let folder = tempfile::tempdir().expect("a folder");
    let path = folder.path().join("every.ray");
    std::fs::write(&path, every_shape()).expect("written");
    std::fs::write(folder.path().join("cells.png"), cells()).expect("written");
    // From outside, from above, from within shapes, from near.
    let cameras = [
        ("front", "0 3 11  0 -.22 -1  0 1 0  .36"),
        ("above", "1 11 2  -.05 -1 -.2  0 0 -1  .4"),
        ("below", "-2 -2.4 5  .3 .5 -1  .1 1 0  .5"),
        ("within", "-1.4 2.2 .1  1 .1 -.3  0 1 0  .6"),
        ("near", "2.4 2.9 .9  -.3 -.6 -.9  0 1 0  .7"),
    ];
    for (name, camera) in cameras {
        std::fs::write(&path, every_shape().replace("0 3 11  0 -.22 -1  0 1 0  .36", camera))
            .expect("written");
        drawn_as_traced(&mut raster, name, opened(&path), 0.01);
    }
}

#[test]
fn scenes_of_other_dialects_are_drawn_as_they_are_traced() {
    let Some(mut raster) = raster() else { return };
    let scenes = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../scenes");
    // A torus is made of triangles, which its shading hides and its outline does not.
    for (name, most) in [
        ("dialects/pipes-hmc", 0.005),
        ("dialects/ring-jhu", 0.01),
        ("dialects/table-uva", 0.005),
        ("dialects/blocks-unisa", 0.005),
        ("virus", 0.005),
        ("slides", 0.005),
    ] {
        let extension = if name.ends_with("unisa") { "scene" } else { "ray" };
        let opened = opened(&scenes.join(name).with_extension(extension));
        drawn_as_traced(&mut raster, &name.replace('/', "-"), opened, most);
    }
}

/// One of each shape in marble, wood, a chequer, noise and bumps, as it is and in frames of all sorts: which pixels are
/// off says what of them is not drawn as it is traced.
#[test]
fn textures_in_space_and_bumps_are_drawn_as_they_are_traced() {
    let Some(mut raster) = raster() else { return };
    let folder = tempfile::tempdir().expect("a folder");
    let path = folder.path().join("carved.ray");
    let clauses = [
        ("marble", "marble scale=1.6 octaves=5 color=1,.99,.96 color2=.34,.3,.26"),
        ("wood", "wood scale=3 octaves=4 color=1,1,1 color2=.46,.38,.32"),
        ("noise", "noise scale=2.5 octaves=5 color=1,.9,.3 color2=.1,.2,.6"),
        ("checker", "checker scale=2 color=.95,.92,.86 color2=.3,.2,.16; marble scale=.8 color2=.3,.7,.6"),
        ("bump", "bump scale=6 octaves=2 height=.02"),
    ];
    for (name, clause) in clauses {
        // The materials 0, 1 and 3 stand on the shapes in rows; the second one has a texture besides.
        let text = every_shape().replace("!textured!", &format!("!{clause}!"));
        let text = text
            .replace("!plain!", &format!("!{clause}!"))
            .replace("shiny 90", &format!("shiny 90; {clause}"));
        std::fs::write(&path, &text).expect("written");
        std::fs::write(folder.path().join("cells.png"), cells()).expect("written");
        let picture = drawn_as_traced(&mut raster, &format!("carved-{name}"), opened(&path), 0.005);
        // The same without the clause is another picture.
        std::fs::write(&path, text.replace(clause, "")).expect("written");
        let bare = unlike(&format!("bare-{name}"), &picture, &rendered(opened(&path)));
        println!("{name} without: {bare:.4}");
        assert!(bare > 0.05, "{name}: {bare}");
    }
    for (scene, most) in [("chess", 0.005), ("desk", 0.02)] {
        let scenes = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../scenes");
        drawn_as_traced(&mut raster, scene, opened(&scenes.join(scene).with_extension("ray")), most);
    }
}

/// An image of hills of no special size.
fn hills() -> Vec<u8> {
    let height = |x: usize, y: usize| {
        0.5 + 0.25 * (x as f32 * 6.0 * std::f32::consts::TAU / 52.0).sin()
            + 0.25 * (y as f32 * std::f32::consts::TAU / 9.0).cos()
    };
    png(52, 9, (0..9 * 52).flat_map(|at| [height(at % 52, at / 52); 3]).collect())
}

/// An image that leans the normals of one of each shape, as they are and in frames of all sorts.
#[test]
fn images_that_lean_normals_are_drawn_as_they_are_traced() {
    let Some(mut raster) = raster() else { return };
    let folder = tempfile::tempdir().expect("a folder");
    let path = folder.path().join("leaning.ray");
    std::fs::write(folder.path().join("hills.png"), hills()).expect("written");
    let row = "#sphere -m rock -u SCALE -- -4 0 0 .6  #box -m rock -u SCALE -- -2.6 0 0 1 1.1 .9
        #cylinder -m rock -u SCALE -c -- -1.2 0 -.5 .5 1.1  #cylinder -m rock -u SCALE -- .2 0 -.5 .5 1.1
        #cone -m rock -u SCALE -c -- 1.5 0 -.5 .6 1.2  #cone -m rock -u SCALE -- 2.8 0 -.5 .5 1
        #torus -m rock -u SCALE -- 4.1 0 0 .5 .2
        #triangle -m rock -u SCALE -- 4.7 -.5 0  5.9 -.5 .2  5.2 .6 0  0 0  1.5 .2  .4 1\n";
    let text = format!(
        "#version HMCCS155FALL2005 #background .2 .3 .5 #ambient .5 .5 .5 #camera 0 0 11 0 0 -1 0 1 0 22
        #light_point -n lamp -- .5 .5 .4 3 5 7 1 0 0 #light_dir -n sun -- .4 .4 .5 1 -.6 -1
        #material -n rock -u hills.png -- .3 .2 .2 .8 .6 .4 .4 .4 .4 0 0 0 .15 0 1
        #group_begin -n up -- #translate 0 2.6 0 #rotate 35 1 0 0\n{row}#group_end
        #group_begin -n within -- #rotate -30 1 .4 0 #scale 1 1.6 .8\n{row}#group_end
        #group_begin -n down -- #translate 0 -2.6 0 #rotate 50 1 0 0 #scale -1 1 1\n{row}#group_end\n#rayfile_end"
    );
    for (name, scale) in [("hills", "2.5"), ("pits", "-1")] {
        std::fs::write(&path, text.replace("SCALE", scale)).expect("written");
        let picture = drawn_as_traced(&mut raster, name, opened(&path), 0.01);
        std::fs::write(&path, text.replace("SCALE", "0")).expect("written");
        let smooth = unlike(&format!("{name}-smooth"), &picture, &rendered(opened(&path)));
        assert!(smooth > 0.05, "{name}: {smooth}");
    }
}

/// Triangles whose corners have colours of their own, some with a texture in space besides.
#[test]
fn colours_of_vertices_are_drawn_as_they_are_traced() {
    let Some(mut raster) = raster() else { return };
    let folder = tempfile::tempdir().expect("a folder");
    let path = folder.path().join("colours.scene");
    let mut text = "#camera 0 2 9 0 -.2 -1 0 1 0 24\n#background .1 .1 .2\n#ambient .4 .4 .4
        #shader \"V.vert\" \"VertexColour\"
        #light_num 1
        #light_point .8 .8 .7 3 5 6 1 0 0\n#material_num 2
        #material .2 .2 .2 .7 .7 .7 .3 .3 .3 0 0 0 .2 0 1 -1 !!
        #material 0 0 0 0 0 0 .2 .2 .2 0 0 0 .2 0 1 -1 !marble scale=2!\n"
        .to_owned();
    let (columns, rows) = (12, 8);
    text += &format!("#vertex_num {}\n", columns * rows);
    for at in 0..columns * rows {
        let (x, y) = (f64::from(at % columns), f64::from(at / columns));
        let z = (x * 0.7).sin() * 0.5 + (y * 0.9).cos() * 0.4;
        let color = [x / 11.0, y / 7.0, 0.5 + 0.5 * (x * y * 0.1).sin()];
        text += &format!(
            "#vertex {} {} {z} 0 0 1 0 0 {} {} {}\n",
            x * 0.6 - 3.3,
            y * 0.6 - 2.0,
            color[0],
            color[1],
            color[2]
        );
    }
    for group in ["1 0 0 0 0 1 0 0 0 0 1 0 0 0 0 1", "-.4 0 0 1 0 .4 .1 1.5 0 0 .4 2 0 0 0 1"] {
        text += &format!("#group_begin {group}\n");
        for at in (0..columns * (rows - 1)).filter(|at| at % columns != columns - 1) {
            let material = at % 3 % 2;
            text += &format!("#shape_triangle {material}\n{} {} {}\n", at, at + 1, at + columns + 1);
            text += &format!("#shape_triangle {material}\n{} {} {}\n", at, at + columns + 1, at + columns);
        }
        text += "#group_end\n";
    }
    std::fs::write(&path, &text).expect("written");
    let all = opened(&path);
    assert!(!all.document.packed.colors.is_empty());
    drawn_as_traced(&mut raster, "vertices", all, 0.005);
}

/// What is off the screen is not drawn, and nothing is missing for that.
#[test]
fn what_is_off_the_screen_is_left_out() {
    let Some(mut raster) = raster() else { return };
    let folder = tempfile::tempdir().expect("a folder");
    let path = folder.path().join("rows.ray");
    let mut text = "#background .2 .3 .5 #light_dir 1 1 1 -1 -1 -1 #ambient .4 .4 .4
        #material .4 .2 .1 .8 .6 .4 0 0 0 0 0 0 0 0 1 -1 !m!\n"
        .to_owned();
    // Groups in a row, each of a thousand shapes of three kinds.
    for group in 0..24 {
        text += &format!("#group_begin 1 0 0 {} 0 1 0 0 0 0 1 0 0 0 0 1\n", group * 4);
        for k in 0..1020 {
            let (x, y, z) =
                (f64::from(k % 10) * 0.3, f64::from(k / 10 % 10) * 0.3, f64::from(k / 100) * -0.3);
            text += &match k % 3 {
                0 => format!("#shape_sphere 0 {x} {y} {z} .1\n"),
                1 => format!("#shape_box 0 {x} {y} {z} .2 .1 .1\n"),
                _ => format!("#shape_cylinder 0 {x} {y} {z} .1 .2\n"),
            };
        }
        text += "#group_end\n";
    }
    // All of it, a part from near, from the midst, along the row, and away from it.
    let views = [
        ("all", "46 2 90 0 0 -1 0 1 0 .45", 1.0..=1.0),
        ("near", "30 1.5 5 0 0 -1 0 1 0 .4", 0.05..=0.4),
        ("midst", "46 1 -1 .2 .1 -1 0 1 0 .5", 0.0..=0.4),
        ("along", "-3 2 2 1 0 -.05 0 1 0 .3", 0.8..=1.0),
        ("away", "46 1 9 0 0 1 0 1 0 .5", 0.0..=0.0),
    ];
    for (name, camera, wanted) in views {
        std::fs::write(&path, format!("#camera {camera}\n{text}")).expect("written");
        let opened = opened(&path);
        let count = f64::from(opened.document.shape_count);
        drawn_as_traced(&mut raster, &format!("sight-{name}"), opened, 0.01);
        let part = raster.things_in_sight() as f64 / count;
        println!("{name}: {part:.3} of the shapes");
        assert!(wanted.contains(&part), "{name}: {part} of the shapes");
    }
}

/// Where pictures of a move come slowly, a driver in software draws them coarsely.
#[test]
fn slow_moves_are_drawn_coarsely_and_the_whole_comes_after_them() {
    let Some(mut raster) = raster() else { return };
    let opened = opened(&Path::new(env!("CARGO_MANIFEST_DIR")).join("../../scenes/slides.ray"));
    load(&mut raster, &opened);
    let whole = drawn(&mut raster, &opened);
    let mut elsewhere = opened.document.camera;
    elsewhere.position.y += 0.5;
    for camera in [elsewhere, elsewhere, opened.document.camera] {
        std::thread::sleep(std::time::Duration::from_millis(150));
        raster.draw(&camera, [WIDTH, HEIGHT], false).expect("a picture");
    }
    assert_eq!(raster.is_unfinished(), raster.is_software());
    while raster.is_unfinished() {
        raster.go_on();
    }
    let (_, pixels) = raster.pixels().expect("pixels");
    assert!(pixels.chunks_exact(4).flat_map(|pixel| pixel.iter().take(3).copied()).eq(whole));
}

/// A scene of so many shapes that a driver in software begins with a draft.
#[test]
fn a_draft_looks_alike_and_the_whole_comes_after_it() {
    let Some(mut raster) = raster() else { return };
    let folder = tempfile::tempdir().expect("a folder");
    let path = folder.path().join("many.ray");
    let mut text = "#camera 0 0 3 0 0 -1 0 1 0 .4 #background .2 .3 .5 #light_dir 1 1 1 -1 -1 -1
        #material .1 .1 .1 .8 .6 .4 0 0 0 0 0 0 0 0 1 -1 !m!\n"
        .to_owned();
    for (x, y) in (0..320).flat_map(|x| (0..320).map(move |y| (x, y))) {
        let at = |k: i32| f64::from(k) / 160.0 - 1.0;
        text += &format!("#shape_sphere 0 {} {} {} .004\n", at(x), at(y), at((x * 7 + y * 13) % 320));
    }
    text += "#shape_box 0 0 -.9 0 2 .1 2\n";
    std::fs::write(&path, text).expect("written");
    let opened = opened(&path);
    load(&mut raster, &opened);
    raster.draw(&opened.document.camera, [WIDTH, HEIGHT], false).expect("a picture");
    let is_draft = raster.is_unfinished();
    let drawn = drawn(&mut raster, &opened);
    let count = opened.document.shape_count;
    // Hidden shapes are in neither.
    let mut hidden = Hidden::default();
    hidden.hide(0..count - 1);
    raster.hide(&hidden);
    let alone = self::drawn(&mut raster, &opened);
    assert!(unlike("alone", &drawn, &alone) > 0.1);
    let share = unlike("many", &drawn, &rendered(opened));
    println!("draft: {is_draft}, {share:.4}");
    assert!(share < 0.01, "{share} of the pixels are off");
}

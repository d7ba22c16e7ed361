//! The panels, driven by real input events as in `window.rs`. Places on the screen are those of the window's layout,
//! whose panels and fonts have fixed sizes.

#[allow(dead_code, reason = "another test file uses the rest")]
mod desk;

use desk::Desk;
use desk::Part;
use desk::Window;
use dotray_image::EncodeOptions;
use dotray_image::Format;
use dotray_image::encode;
use dotray_render::Crop;
use dotray_render::Options;
use dotray_render::PrepareOptions;
use dotray_render::Shadows;
use dotray_render::Silent;
use dotray_render::World;
use dotray_scene::files::Disk;
use std::path::Path;
use std::path::PathBuf;
use std::time::Duration;

const SCENE: &str = "// A scene with remarks, and numbers as a hand writes them.
#camera  1 2.5 9   -.1 -.2 -1   0 1 0   .42
#background .20 .30 .50   /* the sky */
#ambient .6 .6 .6
#light_num 2
#light_point .5 .5 .4  2 6 4  1 0 .01   // the lamp
#light_dir   .20 .30 .20
             -1 -1 -1
#material_num 2
#material .2 .1 .1   .80 .3 .2   .6 .6 .6   .05 0 0   .3 0 1   -1 !red, as it was!
#material .1 .2 .1   .3 .7 .4   .4 .4 .4   0 0 0   .1 0 1   -1 !green!
#shape_sphere 0  -1.6 .8 0  .8  // the ball
#group_begin 1 0 0 1.5  0 1 0 .8  0 0 1 0  0 0 0 1
  #shape_box 1  0 0 0  1.2 1.2 1.2
  #shape_cone 0  0 1.2 0  .5 1.2 .2
#group_end
#shape_box 1  0 -.2 0  9 .4 7
";

const WINDOW: [&str; 2] = ["--window", "1100x700"];

// Where things are in a window of that size.
const MATERIALS_TAB: (i32, i32) = (100, 41);
const LIGHTS_TAB: (i32, i32) = (170, 41);
const SEARCH: (i32, i32) = (100, 73);
const FIRST_FOUND: (i32, i32) = (60, 128);
const WRITE_BACK: (i32, i32) = (46, 73);
const DIFFUSE_GREEN: (i32, i32) = (212, 152);
const SECOND_LIGHT_RED: (i32, i32) = (158, 312);
const WRITE_CAMERA: (i32, i32) = (515, 12);
const THEME: (i32, i32) = (630, 12);
/// Below what stands in the left panel, where nothing listens.
const ASIDE: (i32, i32) = (150, 620);

struct Stage<'a> {
    window: Window<'a>,
    path: PathBuf,
    saved: PathBuf,
    /// Where the view is on the screen.
    view: Part,
    options: Options,
}

fn rendered(text: &str, path: &Path, options: &Options) -> dotray_image::Image {
    let path = path.with_file_name("expected.ray");
    std::fs::write(&path, text).expect("written");
    let opened = rayview::document::open(&path, &Disk).expect("a scene");
    let world = World::prepare(opened.resolved, &Disk, &PrepareOptions::default()).expect("a world");
    dotray_render::render(&world, options, &Silent).expect("a picture").image
}

/// The share of the pixels that differ by more than `tolerance` of 255 in a channel.
fn unlike(a: &[u8], b: &[u8], tolerance: u8) -> f64 {
    assert_eq!(a.len(), b.len());
    let pixels = a.chunks_exact(3).zip(b.chunks_exact(3));
    let off = pixels.filter(|(a, b)| a.iter().zip(*b).any(|(a, b)| a.abs_diff(*b) > tolerance)).count();
    off as f64 / (a.len() / 3) as f64
}

impl<'a> Stage<'a> {
    /// Opens the scene, and finds the view by the traced picture that stands in it.
    fn new(desk: &'a Desk, folder: &Path, variables: &[(&str, &str)]) -> Self {
        let path = folder.join("scene.ray");
        std::fs::write(&path, SCENE).expect("written");
        let window = desk.open_by(variables, &path, &WINDOW, "1");
        let saved = path.with_extension("png");
        let mut stage = Self { window, path, saved, view: [0; 4], options: Options::default() };
        stage.window.pointer(ASIDE.0, ASIDE.1);
        stage.window.key("t");
        let picture = stage.save(desk);
        let (width, height) = (picture.width() as u32, picture.height() as u32);
        stage.options = Options { width, height, ..Options::default() };
        let expected = rendered(SCENE, &stage.path, &stage.options);
        assert!(picture.to_rgb8(false) == expected.to_rgb8(false));
        desk.until("the traced picture stands on the screen", || {
            let found = desk.find(&expected.to_rgb8(false), width, height);
            stage.view = found.unwrap_or_default();
            found.is_some()
        });
        stage
    }

    /// The traced picture, saved anew by Ctrl + S.
    fn save(&self, desk: &Desk) -> dotray_image::Image {
        let _ = std::fs::remove_file(&self.saved);
        desk.until("the traced picture can be saved", || {
            self.window.key("ctrl+s");
            self.saved.exists()
        });
        let file = std::fs::read(&self.saved).expect("saved");
        dotray_image::decode(&file, None, &dotray_image::Limits::default()).expect("a picture")
    }

    fn click(&self, (x, y): (i32, i32)) {
        self.window.click(1, x, y);
    }

    /// Clicks what brings another list: again where frames are so slow that the click was lost.
    fn turn_to(&self, desk: &Desk, place: (i32, i32)) {
        let list = || desk.part([8, 92, 284, 300]);
        let before = list();
        desk.until("another list is shown", || {
            self.click(place);
            list() != before
        });
    }

    /// Clicks a number and, once it can be edited, types another.
    fn set(&self, desk: &Desk, (x, y): (i32, i32), number: &str) {
        self.window.pointer(x, y);
        std::thread::sleep(Duration::from_secs(2));
        let field = || desk.part([x as usize - 24, y as usize - 9, 48, 18]);
        let before = field();
        self.click((x, y));
        desk.until("the number can be edited", || field() != before);
        self.window.write(number);
        self.window.key("Return");
    }

    /// Waits until the view shows what the preview of a text is.
    fn until_preview(&self, desk: &Desk, what: &str, text: &str) {
        self.window.pointer(ASIDE.0, ASIDE.1);
        let plain = Options { recursion: 0, shadows: Shadows::Off, ..self.options.clone() };
        let plain = rendered(text, &self.path, &plain).to_rgb8(false);
        desk.until(what, || unlike(&desk.part(self.view), &plain, 6) < 0.01);
    }

    fn text(&self) -> String {
        std::fs::read_to_string(&self.path).expect("a text")
    }
}

#[test]
fn numbers_that_are_typed_are_written_back_and_nothing_else() {
    let Some(desk) = Desk::new() else { return };
    let folder = tempfile::tempdir().expect("a folder");
    let stage = Stage::new(&desk, folder.path(), &[]);
    stage.window.key("t");
    let edited = SCENE.replace(".80 .3 .2", ".80 0.75 .2").replace("#light_dir   .20", "#light_dir   0.9");
    stage.turn_to(&desk, MATERIALS_TAB);
    stage.set(&desk, DIFFUSE_GREEN, ".75");
    stage.turn_to(&desk, LIGHTS_TAB);
    stage.set(&desk, SECOND_LIGHT_RED, ".9");
    stage.until_preview(&desk, "both are shown at once", &edited);
    desk.keep("edited");
    assert_eq!(stage.text(), SCENE, "nothing is written unasked");
    stage.click(WRITE_BACK);
    desk.until("both are written", || stage.text() == edited);

    // Flown ahead, the camera alone is written, and is what the clipboard gets.
    stage.window.pointer(ASIDE.0, ASIDE.1);
    stage.window.hold("w", Duration::from_millis(1500));
    stage.click(WRITE_CAMERA);
    desk.until("the camera is written", || stage.text() != edited);
    let text = stage.text();
    let (old, new): (Vec<&str>, Vec<&str>) = (edited.lines().collect(), text.lines().collect());
    assert_eq!((&old[..1], &old[2..]), (&new[..1], &new[2..]), "the camera's line alone");
    // It went straight ahead: direction, up and angle stand as they stood, letter by letter.
    let rest = "   -.1 -.2 -1   0 1 0   .42";
    assert!(new[1].starts_with("#camera  ") && new[1].ends_with(rest) && new[1] != old[1], "{}", new[1]);
    stage.window.pointer(ASIDE.0, ASIDE.1);
    stage.window.key("c");
    let numbers = |line: &str| line.split_whitespace().skip(1).flat_map(str::parse).collect::<Vec<f64>>();
    desk.until("the camera is on the clipboard", || {
        desk.clipboard().is_none_or(|line| numbers(&line) == numbers(new[1]))
    });
}

#[test]
fn shapes_are_found_hidden_and_shown_alone() {
    let Some(desk) = Desk::new() else { return };
    let folder = tempfile::tempdir().expect("a folder");
    let stage = Stage::new(&desk, folder.path(), &[]);
    stage.window.key("t");
    stage.until_preview(&desk, "the preview is shown", SCENE);
    stage.click(SEARCH);
    stage.window.write("cone");
    stage.click(FIRST_FOUND);
    stage.window.pointer(ASIDE.0, ASIDE.1);
    desk.keep("found");
    stage.window.key("h");
    stage.window.key("Escape");
    let without = SCENE.replace("  #shape_cone 0  0 1.2 0  .5 1.2 .2\n", "");
    stage.until_preview(&desk, "the cone is hidden", &without);
    // What is hidden is not traced either: no shadow, no mirror image is left of it.
    stage.window.key("t");
    let traced = rendered(&without, &stage.path, &stage.options).to_rgb8(false);
    desk.until("the cone is not traced", || stage.save(&desk).to_rgb8(false) == traced);
    desk.keep("hidden");
    stage.window.key("t");
    stage.window.key("shift+h");
    stage.until_preview(&desk, "everything is shown", SCENE);
    stage.click(FIRST_FOUND);
    stage.window.pointer(ASIDE.0, ASIDE.1);
    stage.window.key("i");
    stage.window.key("Escape");
    let kept = |line: &&str| !line.contains("#shape_box") && !line.contains("#shape_sphere");
    let alone: String = SCENE.lines().filter(kept).map(|line| format!("{line}\n")).collect();
    stage.until_preview(&desk, "the cone stands alone", &alone);

    // Without the panels the view is as wide as the window; the list of keys comes and goes.
    stage.window.key("shift+h");
    let [left, top, ..] = stage.view;
    let beside = [left / 2, top + 200, 4, 4];
    let panel = desk.part(beside);
    stage.window.key("v");
    desk.until("the panels go", || unlike(&desk.part(beside), &panel, 20) == 1.0);
    desk.keep("alone");
    stage.window.key("v");
    desk.until("the panels come back", || desk.part(beside) == panel);
    let before = desk.part(stage.view);
    stage.window.key("F1");
    desk.until("the keys are listed", || unlike(&desk.part(stage.view), &before, 8) > 0.2);
    desk.keep("keys");
    stage.window.key("F1");
    desk.until("the list goes", || unlike(&desk.part(stage.view), &before, 8) < 0.01);

    // System, dark, light.
    assert!(panel.iter().all(|byte| *byte < 60), "{panel:?}");
    stage.click(THEME);
    stage.click(THEME);
    desk.until("the panels are light", || desk.part(beside).iter().all(|byte| *byte > 200));
    desk.keep("light");
}

#[test]
fn a_region_is_traced_and_a_faulty_file_leaves_the_last_good_scene() {
    let Some(desk) = Desk::new() else { return };
    let folder = tempfile::tempdir().expect("a folder");
    let stage = Stage::new(&desk, folder.path(), &[]);
    let [left, top, ..] = stage.view.map(|edge| edge as i32);
    let (from, to) = ((left + 40, top + 120), (left + 300, top + 400));
    stage.window.key("g");
    stage.window.drag(from, to);
    stage.window.pointer(ASIDE.0, ASIDE.1);
    let crop = Crop { x: 40, y: 120, width: 260, height: 280 };
    let whole = rendered(SCENE, &stage.path, &stage.options);
    let part = rendered(SCENE, &stage.path, &Options { crop: Some(crop), ..stage.options.clone() });
    let part = part.to_rgb8(false);
    desk.until("the region alone is saved", || stage.save(&desk).to_rgb8(false) == part);
    let plain = Options { recursion: 0, shadows: Shadows::Off, ..stage.options.clone() };
    let mut expected = rendered(SCENE, &stage.path, &plain).to_rgb8(false);
    for row in crop.y..crop.y + crop.height {
        let start = ((row * stage.options.width + crop.x) * 3) as usize;
        let span = start..start + (crop.width * 3) as usize;
        expected[span.clone()].copy_from_slice(&whole.to_rgb8(false)[span]);
    }
    desk.until("the region is traced, the rest is the preview", || {
        unlike(&desk.part(stage.view), &expected, 6) < 0.02
    });
    desk.keep("region");

    // While the file is faulty, the last good scene is traced from wherever one looks.
    std::fs::write(&stage.path, SCENE.replace("#shape_cone", "#shape_cnoe")).expect("written");
    desk.until("a message comes", || unlike(&desk.part(stage.view), &expected, 6) > 0.04);
    desk.keep("faulty");
    stage.window.drag((left + 100, top + 60), (left + 160, top + 70));
    stage.window.pointer(ASIDE.0, ASIDE.1);
    desk.until("another view is traced", || stage.save(&desk).to_rgb8(false) != part);
    stage.window.key("r");
    desk.until("the file's view is traced", || stage.save(&desk).to_rgb8(false) == part);
    // Mended, it is the file's.
    let mended = SCENE.replace(".20 .30 .50", ".60 .30 .10");
    std::fs::write(&stage.path, &mended).expect("written");
    let part = rendered(&mended, &stage.path, &Options { crop: Some(crop), ..stage.options.clone() });
    desk.until("the mended file is traced", || stage.save(&desk).to_rgb8(false) == part.to_rgb8(false));
    let file = std::fs::read(&stage.saved).expect("saved");
    assert!(file == encode(&part, Format::Png, &EncodeOptions::default()).expect("a file"));
}

#[test]
fn open_gl_draws_the_same() {
    let Some(desk) = Desk::new() else { return };
    let folder = tempfile::tempdir().expect("a folder");
    let stage = Stage::new(&desk, folder.path(), &[("WGPU_BACKEND", "gl")]);
    stage.window.key("t");
    stage.until_preview(&desk, "the preview is shown", SCENE);
    desk.keep("gl");
}

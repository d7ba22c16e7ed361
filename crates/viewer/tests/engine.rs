//! The tracer behind the screen gives the renderer's own bytes, and lets go at once.

use dotray_accel::Kind;
use dotray_image::EncodeOptions;
use dotray_image::Format;
use dotray_image::Image;
use dotray_image::encode;
use dotray_render::Antialias;
use dotray_render::Crop;
use dotray_render::Options;
use dotray_render::PrepareOptions;
use dotray_render::Silent;
use dotray_render::World;
use dotray_render::inspect::RayKind;
use dotray_scene::Resolved;
use dotray_scene::files::Disk;
use rayview::document::open;
use rayview::engine::Command;
use rayview::engine::Engine;
use rayview::engine::Reply;
use rayview::engine::Request;
use rayview::hidden::Hidden;
use rayview::hidden::without_shapes;
use std::path::Path;
use std::path::PathBuf;
use std::sync::Arc;
use std::sync::atomic::AtomicBool;
use std::sync::atomic::Ordering;
use std::time::Duration;

fn scene(name: &str) -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("../../scenes").join(name)
}

fn world(name: &str) -> Box<World> {
    let opened = open(&scene(name), &Disk).expect("a scene");
    Box::new(World::prepare(opened.resolved, &Disk, &PrepareOptions::default()).expect("a world"))
}

fn request(world: &World, serial: u64, options: Options) -> Box<Request> {
    Box::new(Request { serial, camera: *world.camera(), options })
}

/// Runs the engine to the picture's end; answers with the picture and how many replies came.
fn finish(engine: &mut Engine, serial: u64) -> (Arc<Image>, usize) {
    let mut replies = 0;
    loop {
        if let Some(Reply::Picture { serial: of, image, progress, .. }) = engine.advance() {
            assert_eq!(of, serial);
            replies += 1;
            if let Some(image) = image {
                assert!(progress.percent() == 100 && !engine.is_busy());
                assert!(progress.pixels_per_second > 0.0 && progress.seconds_left == Some(0.0));
                return (image, replies);
            }
            assert!(progress.percent() < 100);
        }
    }
}

#[test]
fn the_finished_picture_is_the_renderers_byte_for_byte() {
    for name in ["slides.ray", "glasses.ray"] {
        let mut engine = Engine::default();
        engine.handle(Command::World(Some(world(name))));
        let reference = world(name);
        let crop = Some(Crop { x: 13, y: 5, width: 30, height: 41 });
        let adaptive = Antialias::Adaptive { threshold: 0.1, depth: 2 };
        for (serial, (antialias, crop)) in
            [(Antialias::None, None), (Antialias::Grid(2), crop), (adaptive, None), (adaptive, crop)]
                .into_iter()
                .enumerate()
        {
            let options = Options { width: 67, height: 47, antialias, crop, ..Options::default() };
            let expected = dotray_render::render(&reference, &options, &Silent).expect("a picture").image;
            let serial = serial as u64;
            assert!(engine.handle(Command::Draw(request(&reference, serial, options))).is_empty());
            let (image, _) = finish(&mut engine, serial);
            assert_eq!(image.samples(), expected.samples(), "{name} {antialias:?} {crop:?}");
            let png = |image: &Image| encode(image, Format::Png, &EncodeOptions::default()).expect("a file");
            assert!(png(&image) == png(&expected));
        }
    }
}

#[test]
fn interrupted_portions_are_made_up_for() {
    let reference = world("slides.ray");
    for antialias in [Antialias::None, Antialias::Grid(2)] {
        let options = Options { width: 80, height: 60, antialias, ..Options::default() };
        let expected = dotray_render::render(&reference, &options, &Silent).expect("a picture").image;
        let mut engine = Engine::default();
        engine.handle(Command::World(Some(world("slides.ray"))));
        engine.handle(Command::Draw(request(&reference, 3, options)));
        let interrupt = engine.interrupt();
        let stop = Arc::new(AtomicBool::new(false));
        let other = std::thread::spawn({
            let stop = stop.clone();
            let mut pause = Duration::from_micros(300);
            move || {
                while !stop.load(Ordering::Relaxed) {
                    interrupt.store(true, Ordering::Relaxed);
                    std::thread::yield_now();
                    interrupt.store(false, Ordering::Relaxed);
                    std::thread::sleep(pause);
                    // Ever longer, lest a slow machine never finishes a tile.
                    pause = pause.mul_f64(1.2).min(Duration::from_millis(60));
                }
            }
        });
        let (image, _) = finish(&mut engine, 3);
        stop.store(true, Ordering::Relaxed);
        other.join().expect("it ended");
        assert!(image.samples() == expected.samples(), "{antialias:?}");
    }
}

#[test]
fn coarse_pictures_come_first_and_cover_the_window() {
    let world = world("glasses.ray");
    let options = Options { width: 160, height: 100, ..Options::default() };
    let request = request(&world, 7, options);
    let mut engine = Engine::default();
    engine.handle(Command::World(Some(world)));
    engine.handle(Command::Draw(request));
    let Some(Reply::Picture { pixels, size, .. }) = engine.advance() else {
        panic!("the first portion is shown")
    };
    assert_eq!((size, pixels.len()), ([160, 100], 160 * 100 * 4));
    let known = pixels.chunks_exact(4).filter(|pixel| pixel[3] == 255).count();
    assert!(known >= 4 * 16, "{known}");
    let (_, replies) = finish(&mut engine, 7);
    assert!(replies >= 1);
}

#[test]
fn a_pixel_tells_its_shape_and_its_rays() {
    let opened = open(&scene("glasses.ray"), &Disk).expect("a scene");
    let document = opened.document;
    let world =
        Box::new(World::prepare(opened.resolved, &Disk, &PrepareOptions::default()).expect("a world"));
    let request = request(&world, 0, Options { width: 64, height: 48, ..Options::default() });
    let mut engine = Engine::default();
    engine.handle(Command::World(Some(world)));
    let mut deepest = 0;
    for (x, y) in
        (0..64).step_by(5).flat_map(|x| (0..48).step_by(5).map(move |y| (f64::from(x), f64::from(y))))
    {
        let seen = match engine.handle(Command::Look(request.clone(), x, y)).as_slice() {
            [Reply::Seen(seen)] => *seen,
            other => panic!("{other:?}"),
        };
        let rows = match engine.handle(Command::Inspect(request.clone(), x, y)).as_slice() {
            [Reply::Rays(rows)] => rows.clone(),
            other => panic!("{other:?}"),
        };
        let eye = rows.first().expect("an eye ray");
        assert_eq!((eye.kind, eye.met), (RayKind::Eye, seen.map(|seen| (seen.number, seen.material))));
        if let Some(seen) = seen {
            assert!(document.shape(seen.number).is_some() && seen.number < document.shape_count);
            assert!((eye.to - seen.point).length() < 1e-9);
        }
        deepest = deepest.max(rows.iter().map(|row| row.depth).max().unwrap_or(0));
        assert!(!rayview::rays::lines(&rows, None, 0.1).is_empty());
    }
    assert!(deepest >= 2, "glass must send rays on");
}

#[test]
fn edited_materials_and_lights_are_traced_without_building_anything_anew() {
    let folder = tempfile::tempdir().expect("a folder");
    let path = folder.path().join("one.ray");
    let text = "#camera 0 0 4 0 0 -1 0 1 0 .5 #background .1 .2 .3 #light_dir 1 1 1 0 -1 -1
        #material .1 .1 .1 .5 .5 .5 .2 .2 .2 0 0 0 .3 0 1 -1 !m! #shape_sphere 0 0 0 0 1";
    std::fs::write(&path, text).expect("written");
    let opened = open(&path, &Disk).expect("a scene");
    let mut document = opened.document;
    let world =
        Box::new(World::prepare(opened.resolved, &Disk, &PrepareOptions::default()).expect("a world"));
    let request = request(&world, 0, Options { width: 60, height: 40, ..Options::default() });
    let mut engine = Engine::default();
    engine.handle(Command::World(Some(world)));
    let mut material = document.files()[0].materials[0].value.clone();
    material.diffuse = dotray_geometry::Vec3::new(0.9, 0.1, 0.2);
    document.set_material(0, 0, material).expect("fine");
    let background = dotray_geometry::Vec3::new(0.0, 0.3, 0.0);
    document.set_background(background).expect("fine");
    engine.handle(Command::Style(Box::new(document.style.clone())));
    engine.handle(Command::Draw(request.clone()));
    let (image, _) = finish(&mut engine, 0);

    // The same, written into the file and read again.
    let texts = document.edited_texts().expect("texts");
    std::fs::write(&path, &texts[0].1).expect("written");
    let again = open(&path, &Disk).expect("a scene");
    let world = World::prepare(again.resolved, &Disk, &PrepareOptions::default()).expect("a world");
    let expected = dotray_render::render(&world, &request.options, &Silent).expect("a picture").image;
    assert_eq!(image.samples(), expected.samples());
}

/// What is hidden is not traced: the picture is that of a file without those shapes, clicks name the others by their
/// own numbers, and lights that were edited stay so.
#[test]
fn hidden_shapes_are_left_out() {
    let head = "#camera 0 0 6 0 0 -1 0 1 0 .5 #background .1 .2 .3 #light_dir 1 1 1 0 -1 -1
        #material .1 .1 .1 .5 .5 .5 .2 .2 .2 0 0 0 .6 0 1 -1 !m!\n";
    // The first and the last shape are the scene's bounds, so that what counts as close stays the same.
    let shapes = [
        "#shape_sphere 0 -3 -3 -1 .5",
        "#group_begin 1 0 0 0 0 1 0 .5 0 0 1 0 0 0 0 1",
        "#shape_sphere 0 -1 0 0 1",
        "#shape_sphere 0 1 0 0 .8",
        "#group_end",
        "#shape_box 0 0 -1.5 0 3 .5 2",
        "#shape_sphere 0 3 3 1 .5",
    ];
    let text = |left_out: &[usize]| {
        let kept = shapes.iter().enumerate().filter(|(at, _)| !left_out.contains(at));
        head.to_owned() + &kept.map(|(_, line)| *line).collect::<Vec<_>>().join("\n")
    };
    let folder = tempfile::tempdir().expect("a folder");
    let read = |name: &str, text: &str| {
        let path = folder.path().join(name);
        std::fs::write(&path, text).expect("written");
        open(&path, &Disk).expect("a scene")
    };
    let prepared =
        |resolved| Box::new(World::prepare(resolved, &Disk, &PrepareOptions::default()).expect("a world"));
    let whole = read("whole.ray", &text(&[])).resolved;
    let rest = Box::new(without_shapes(&whole));
    let world = prepared(whole);
    let request = |serial| request(&world, serial, Options { width: 90, height: 60, ..Options::default() });
    let requests: Vec<_> = (0..6).map(request).collect();
    let mut engine = Engine::default();
    engine.handle(Command::World(Some(world)));
    engine.handle(Command::Rest(rest, PrepareOptions::default()));
    let rendered = |text: &str, style: Option<&Resolved>| {
        let mut world = prepared(read("part.ray", text).resolved);
        style.inspect(|style| world.restyle(style));
        dotray_render::render(&world, &requests[0].options, &Silent).expect("a picture").image
    };
    // Shapes 1 and 3: a sphere in the group, and the box.
    let mut hidden = Hidden::default();
    hidden.hide(1..2);
    hidden.hide(3..4);
    engine.handle(Command::Hide(hidden.clone()));
    engine.handle(Command::Draw(requests[0].clone()));
    let (image, _) = finish(&mut engine, 0);
    assert_eq!(image.samples(), rendered(&text(&[2, 5]), None).samples());
    assert_ne!(image.samples(), rendered(&text(&[]), None).samples());
    // The sphere that is left is still number 2.
    match engine.handle(Command::Inspect(requests[1].clone(), 56.0, 34.0)).as_slice() {
        [Reply::Rays(rows)] => assert_eq!(rows[0].met.map(|(number, _)| number), Some(2)),
        other => panic!("{other:?}"),
    }
    match engine.handle(Command::Look(requests[1].clone(), 56.0, 34.0)).as_slice() {
        [Reply::Seen(Some(seen))] => assert_eq!(seen.number, 2),
        other => panic!("{other:?}"),
    }
    // Other lights, and then all shapes again.
    let mut style = read("style.ray", &text(&[])).document.style;
    style.background = dotray_geometry::Vec3::new(0.4, 0.0, 0.0);
    engine.handle(Command::Style(Box::new(style.clone())));
    engine.handle(Command::Draw(requests[2].clone()));
    assert_eq!(finish(&mut engine, 2).0.samples(), rendered(&text(&[2, 5]), Some(&style)).samples());
    engine.handle(Command::Hide(Hidden::default()));
    engine.handle(Command::Draw(requests[3].clone()));
    assert_eq!(finish(&mut engine, 3).0.samples(), rendered(&text(&[]), Some(&style)).samples());
    // Nothing at all is the background.
    hidden.hide(0..5);
    engine.handle(Command::Hide(hidden));
    engine.handle(Command::Draw(requests[4].clone()));
    let (image, _) = finish(&mut engine, 4);
    assert!(image.samples().chunks_exact(3).all(|pixel| *pixel == [0.4, 0.0, 0.0]));
}

#[test]
fn options_that_make_no_sense_are_refused() {
    let world = world("slides.ray");
    let request = request(&world, 0, Options { width: 0, ..Options::default() });
    let mut engine = Engine::default();
    engine.handle(Command::World(Some(world)));
    assert!(
        matches!(engine.handle(Command::Draw(request)).as_slice(), [Reply::Refused(why)] if why.contains("width"))
    );
    assert!(!engine.is_busy());
}

/// Shapes are kept once: a world that is taken apart gives back the very lists that it was built of.
#[test]
fn a_scene_taken_apart_is_as_it_was_read() {
    let folders = [scene("."), scene("dialects")];
    let entries = folders.iter().flat_map(|folder| std::fs::read_dir(folder).expect("a folder"));
    let mut paths: Vec<PathBuf> = entries.map(|entry| entry.expect("an entry").path()).collect();
    paths.retain(|path| path.extension().is_some_and(|ending| ending == "ray" || ending == "scene"));
    let mut count = 0;
    for path in paths {
        // One is on purpose as somebody once printed it.
        let Ok(opened) = open(&path, &Disk) else { continue };
        let read = opened.resolved;
        count += 1;
        for kind in [Kind::Bvh, Kind::Octree] {
            let prepare = PrepareOptions { accel: kind, ..PrepareOptions::default() };
            let world = World::prepare(read.clone(), &Disk, &prepare).expect("a world");
            let (whole, _) = world.take_apart(without_shapes(&read));
            assert_eq!(
                (whole.shape_count, &whole.runs),
                (read.shape_count, &read.runs),
                "{}",
                path.display()
            );
            assert_eq!(whole.frames, read.frames, "{}", path.display());
            assert_eq!((&whole.tree, &whole.materials), (&read.tree, &read.materials));
            for (file, mut before) in whole.files.into_iter().zip(read.files.clone()) {
                (before.items, before.groups) = (Vec::new(), Vec::new());
                assert!(file == before, "{}: {} is another file", path.display(), before.path.display());
            }
        }
    }
    assert!(count > 20, "{count} scenes");
}

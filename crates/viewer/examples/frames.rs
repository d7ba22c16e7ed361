//! What opening a scene and drawing a frame of its preview take on this machine, without a window.
//!
//!     cargo run --release -p rayview --features screen --example frames -- scene.ray

#[path = "../tests/offscreen/mod.rs"]
mod offscreen;

use dotray_scene::files::Disk;
use rayview::document::open;
use rayview::gpu::Raster;
use rayview::navigate::Navigator;
use std::path::Path;
use std::time::Instant;

/// The size of the pictures.
const SIZE: [u32; 2] = [1280, 800];

/// As many frames go by before a move is drawn as coarsely as it has to be.
const MOVES: usize = 3;

/// So many frames are timed.
const FRAMES: usize = 9;

fn main() {
    let Some(path) = std::env::args().nth(1) else {
        eprintln!("frames: expected a scene");
        return;
    };
    let Some(device) = offscreen::device() else {
        eprintln!("frames: no device draws here");
        return;
    };
    let mut raster = Raster::new(&device);
    println!("{}", raster.device_name());
    let start = Instant::now();
    let Ok(opened) = open(Path::new(&path), &Disk) else {
        eprintln!("frames: `{path}` cannot be read");
        return;
    };
    println!("read and laid down: {:.2} s", start.elapsed().as_secs_f64());
    let document = opened.document;
    let start = Instant::now();
    raster.load(&document.packed, document.draft.as_ref(), &document.pictures, &document.style);
    let mut navigator = Navigator::new(document.camera, &document.packed.bounds);
    raster.draw(&navigator.camera(), SIZE, false);
    raster.pixels();
    println!("first picture: {:.3} s", start.elapsed().as_secs_f64());
    let mut times = Vec::new();
    for _ in 0..MOVES + FRAMES {
        navigator.orbit(0.05, 0.01);
        let start = Instant::now();
        raster.draw(&navigator.camera(), SIZE, false);
        raster.finish();
        times.push(start.elapsed().as_secs_f64());
    }
    let (start, mut portions) = (Instant::now(), 0);
    while raster.is_unfinished() {
        raster.go_on();
        raster.finish();
        portions += 1;
    }
    let rest = start.elapsed().as_secs_f64();
    println!("the first frame of a move: {:.3} s", times[0]);
    let times = &mut times[MOVES..];
    times.sort_by(f64::total_cmp);
    println!("a frame while moving: {:.3} s, the quickest {:.3} s", times[FRAMES / 2], times[0]);
    println!("the whole at rest: {rest:.3} s in {portions} portions");
    if let Some(file) = std::env::args().nth(2) {
        let Some((size, pixels)) = raster.pixels() else { return };
        let samples = pixels.chunks_exact(4).flat_map(|p| p.iter().take(3).map(|c| f32::from(*c) / 255.0));
        let [width, height] = size.map(|edge| edge as usize);
        let image =
            dotray_image::Image::from_samples(width, height, dotray_image::Channels::Rgb, samples.collect());
        let bytes = image.ok().and_then(|image| {
            dotray_image::encode(&image, dotray_image::Format::Png, &dotray_image::EncodeOptions::default())
                .ok()
        });
        if let Some(Err(error)) = bytes.map(|bytes| dotray_image::write_file(Path::new(&file), &bytes)) {
            eprintln!("frames: {error}");
        }
    }
}

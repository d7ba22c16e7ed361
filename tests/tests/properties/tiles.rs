//! A tile alone has the pixels that it has in the whole picture, whatever was computed before it.

use crate::same_bytes::small_corpus;
use dotray_accel::Kind;
use dotray_render::Antialias;
use dotray_render::Crop;
use dotray_render::Observer;
use dotray_render::Options;
use dotray_render::Order;
use dotray_render::Picture;
use dotray_render::Progress;
use dotray_render::Silent;
use dotray_render::TilePixels;
use dotray_render::World;
use dotray_render::render;
use dotray_render::render_missing;
use dotray_tests::pictures;
use std::sync::Mutex;
use std::sync::atomic::AtomicBool;
use std::sync::atomic::AtomicU64;
use std::sync::atomic::Ordering;
use std::time::Duration;
use std::time::Instant;

/// Some scenes with some options of every kind.
fn cases() -> Vec<(String, World, Options)> {
    let vary = |(i, (name, scene, options)): (usize, (String, _, Options))| {
        let world = pictures::world(scene, Kind::Bvh).unwrap_or_else(|error| panic!("{name}: {error}"));
        let antialias = [options.antialias, Antialias::ADAPTIVE, Antialias::Grid(2)][i % 3];
        let (w, h) = (options.width, options.height);
        let crop = (i % 4 == 1).then(|| Crop { x: w / 5, y: h / 7, width: w / 2, height: h / 2 + 1 });
        let tile_size = [8, 17, 32][i % 3];
        (name, world, Options { antialias, crop, tile_size, transparent: i % 5 == 2, ..options })
    };
    small_corpus().into_iter().enumerate().map(vary).collect()
}

#[test]
fn tiles_that_were_computed_apart_make_the_picture() {
    for (name, world, options) in cases() {
        let whole = pictures::picture(&world, &options).unwrap_or_else(|error| panic!("{name}: {error}"));
        let picture = Picture::new(&world, &options).expect("options are fine");
        let mut film = picture.film().expect("small");
        // Backwards, each tile from a picture that knows of no other: as if every tile came from another machine.
        for tile in picture.tiles().iter().rev() {
            let alone = Picture::new(&world, &options).expect("options are fine");
            let bytes = alone.tile(tile, &Silent).expect("not cancelled").to_bytes();
            let pixels = TilePixels::from_bytes(&bytes).expect("as it was");
            assert!(film.store(&pixels), "{name}: {tile:?}");
            assert!(!film.store(&pixels), "{name}: {tile:?} a second time");
        }
        assert!(film.is_complete());
        assert_eq!(pictures::difference(&whole, film.image()), None, "{name}");
    }
}

#[test]
fn coarse_looks_leave_no_trace() {
    struct Collects(Mutex<Vec<TilePixels>>, AtomicU64);
    impl Observer for Collects {
        fn tile_previewed(&self, pixels: &TilePixels) {
            assert!(self.0.lock().expect("whole").is_empty(), "coarse looks come first");
            self.1.fetch_add(pixels.tile.pixels(), Ordering::Relaxed);
        }

        fn tile_traced(&self, pixels: &TilePixels) {
            self.0.lock().expect("whole").push(pixels.clone());
        }
    }
    for (name, world, options) in cases() {
        let whole = render(&world, &options, &Silent).expect("options are fine");
        let options = Options { order: Order::CoarseToFine, ..options };
        let collects = Collects(Mutex::default(), AtomicU64::new(0));
        let rendering = render(&world, &options, &collects).expect("options are fine");
        assert_eq!(pictures::difference(&whole.image, &rendering.image), None, "{name}");
        assert_eq!(whole.stats.rays(), rendering.stats.rays(), "{name}: looks are not counted");
        let window = u64::from(options.window().width) * u64::from(options.window().height);
        assert_eq!(collects.1.into_inner(), 2 * window, "{name}: two looks at everything");
        // The tiles that an observer sees are the picture.
        let picture = Picture::new(&world, &options).expect("options are fine");
        let mut film = picture.film().expect("small");
        for pixels in collects.0.into_inner().expect("whole") {
            assert!(film.store(&pixels), "{name}");
        }
        assert!(film.is_complete());
        assert_eq!(pictures::difference(&whole.image, film.image()), None, "{name}");
    }
}

#[test]
fn cancelled_work_goes_on_where_it_stopped() {
    struct StopsAfter(AtomicU64);
    impl Observer for StopsAfter {
        fn tile_finished(&self, _: &Progress) {
            self.0.fetch_sub(1, Ordering::Relaxed);
        }

        fn cancelled(&self) -> bool {
            self.0.load(Ordering::Relaxed) == 0
        }
    }
    for (name, world, options) in cases().into_iter().take(8) {
        let options = Options { threads: Some(1), tile_size: 8, ..options };
        let whole = pictures::picture(&world, &options).expect("complete");
        let picture = Picture::new(&world, &options).expect("options are fine");
        let mut film = picture.film().expect("small");
        let mut rounds = 0;
        loop {
            let stops = StopsAfter(AtomicU64::new(5));
            let mut traced = film.clone();
            let collects = Collecting(&stops, Mutex::default());
            let rendering = render_missing(&picture, film, &collects).expect("threads");
            for pixels in collects.1.into_inner().expect("whole") {
                assert!(traced.store(&pixels));
            }
            film = traced;
            rounds += 1;
            if rendering.complete {
                assert_eq!(pictures::difference(&whole, &rendering.image), None, "{name}");
                break;
            }
        }
        assert_eq!(rounds, picture.tiles().len().div_ceil(5), "{name}");
    }
}

/// Passes everything on and keeps the tiles.
struct Collecting<'a>(&'a dyn Observer, Mutex<Vec<TilePixels>>);

impl Observer for Collecting<'_> {
    fn tile_traced(&self, pixels: &TilePixels) {
        self.1.lock().expect("whole").push(pixels.clone());
    }

    fn tile_finished(&self, progress: &Progress) {
        self.0.tile_finished(progress);
    }

    fn cancelled(&self) -> bool {
        self.0.cancelled()
    }
}

/// Glass and mirrors, area lights and a fine grid: one tile takes many seconds.
const SLOW: &str = "#camera 0 0 3 0 0 -1 0 1 0 .5
#light_area 1 1 1 2 4 4 -1 -2 -2 .5 1 0 0
#light_area 1 1 1 -2 4 4 1 -2 -2 .5 1 0 0
#material 0 0 0 .5 .5 .5 .9 .9 .9 0 0 0 .9 .9 1.5 -1 !!
#shape_sphere 0 0 0 0 1  #shape_sphere 0 1 0 -1 1  #shape_sphere 0 -1 0 -1 1  #shape_box 0 0 -2 0 9 .5 9";

#[test]
fn a_slow_tile_stops_within_fifty_milliseconds() {
    struct Switch(AtomicBool);
    impl Observer for Switch {
        fn cancelled(&self) -> bool {
            self.0.load(Ordering::Relaxed)
        }
    }
    let scene = pictures::scene_of_text("slow.ray", SLOW).expect("a scene");
    let world = pictures::world(scene, Kind::Bvh).expect("a world");
    for antialias in [Antialias::Grid(16), Antialias::Adaptive { threshold: 0.0, depth: 8 }] {
        let slow = Options {
            width: 64,
            height: 64,
            tile_size: 64,
            light_samples: 4096,
            recursion: 12,
            ..Options::default()
        };
        let options = Options { antialias, threshold: 0.0, ..slow };
        let picture = Picture::new(&world, &options).expect("options are fine");
        let switch = Switch(AtomicBool::new(false));
        let took = std::thread::scope(|scope| {
            let tile = scope.spawn(|| (picture.tile(&picture.tiles()[0], &switch), Instant::now()));
            std::thread::sleep(Duration::from_millis(300));
            assert!(!tile.is_finished(), "{antialias:?} is not slow");
            let pressed = Instant::now();
            switch.0.store(true, Ordering::Relaxed);
            let (pixels, ended) = tile.join().expect("no panic");
            assert_eq!(pixels, None);
            ended.duration_since(pressed)
        });
        // Ten times what it takes on a machine of its own, for machines that are busy.
        assert!(took < Duration::from_millis(500), "{antialias:?}: {took:?}");
        println!("{antialias:?}: stopped after {took:?}");
    }
}

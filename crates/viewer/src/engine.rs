//! The tracer behind the screen: one picture at a time, from coarse to fine, in short portions. Whatever comes in
//! between (a newer camera, a question about a pixel) interrupts a portion and is answered at once.
//!
//! It is a state machine without threads of its own: a window lets it run on a thread, a page in slices of time.

use crate::rays::RayRow;
use crate::rays::rows;
use dotray_accel::Queries;
use dotray_accel::simd::level;
use dotray_geometry::Ray;
use dotray_geometry::Vec3;
use dotray_image::Image;
use dotray_render::Antialias;
use dotray_render::Crop;
use dotray_render::Film;
use dotray_render::Observer;
use dotray_render::Options;
use dotray_render::Parts;
use dotray_render::Picture;
use dotray_render::RenderError;
use dotray_render::Tile;
use dotray_render::TilePixels;
use dotray_render::World;
use dotray_render::camera::Camera;
use dotray_render::tiles::COARSE_STEPS;
use dotray_render::trace::Tracer;
use dotray_scene::Resolved;
use dotray_scene::model;
use rayon::prelude::*;
use serde::Deserialize;
use serde::Serialize;
use std::collections::BTreeSet;
use std::sync::Arc;
use std::sync::atomic::AtomicBool;
use std::sync::atomic::AtomicUsize;
use std::sync::atomic::Ordering;
use std::time::Duration;
use web_time::Instant;

/// What is to be traced.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Request {
    /// Told apart from other requests by this number, which rises.
    pub serial: u64,
    /// From where.
    pub camera: model::Camera,
    /// The size, the part and the quality.
    pub options: Options,
}

/// What the engine is told.
#[derive(Debug)]
pub enum Command {
    /// Another scene; the picture under way is dropped.
    World(Option<Box<World>>),
    /// Other lights, materials and background of the same scene.
    Style(Box<Resolved>),
    /// Traces a picture; the one under way is dropped.
    Draw(Box<Request>),
    /// Drops the picture under way.
    Stop,
    /// What lies under a place of the picture: pixels from the lower left.
    Look(Box<Request>, f64, f64),
    /// All rays of a place of the picture.
    Inspect(Box<Request>, f64, f64),
}

/// What the engine tells.
#[derive(Clone, Debug)]
pub enum Reply {
    /// The window's pixels as far as they are known: red, green, blue, alpha, upper row first.
    Picture {
        /// Whose.
        serial: u64,
        /// Columns and rows of the window.
        size: [usize; 2],
        /// The pixels; alpha 0 where nothing is known yet.
        pixels: Arc<Vec<u8>>,
        /// The part of the work that is done, 1 at the end.
        done: f32,
        /// Seconds since the request came.
        seconds: f64,
        /// The finished picture.
        image: Option<Arc<Image>>,
    },
    /// What lies under a place.
    Seen(Option<Seen>),
    /// The rays of a place, the eye ray first.
    Rays(Arc<Vec<RayRow>>),
    /// The request makes no sense; the sentence says why.
    Refused(String),
}

/// What lies under a place of the picture.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct Seen {
    /// The shape.
    pub number: u32,
    /// Its material's number in the resolved scene.
    pub material: u32,
    /// The point.
    pub point: Vec3,
    /// How far it is.
    pub distance: f64,
}

/// For how long a portion of work begins new tiles.
pub const PORTION: Duration = Duration::from_millis(30);

/// How often a picture under way is shown.
const SHOWN_EVERY: Duration = Duration::from_millis(40);

/// The edge of a tile: small, so that a portion that nobody can interrupt ends soon after its time.
const TILE: u32 = 16;

/// The edge of a tile whose pixels have many samples each.
const OVERSAMPLED_TILE: u32 = 8;

/// A picture under way.
#[derive(Debug)]
struct Job {
    request: Request,
    /// Taken out while a portion is traced.
    parts: Option<Parts>,
    film: Film,
    /// How many of the coarse looks are done.
    looks: usize,
    /// What this look, or the picture itself, still lacks, in order.
    left: Vec<Tile>,
    shown: Vec<u8>,
    began: Instant,
    last_shown: Option<Instant>,
}

/// Stops the tracer in the midst of a tile.
struct Interrupt<'a>(&'a AtomicBool);

impl Observer for Interrupt<'_> {
    fn cancelled(&self) -> bool {
        self.0.load(Ordering::Relaxed)
    }
}

/// See the module.
#[derive(Debug, Default)]
pub struct Engine {
    world: Option<Box<World>>,
    job: Option<Box<Job>>,
    interrupt: Arc<AtomicBool>,
}

impl Engine {
    /// Whether there is more to trace.
    pub fn is_busy(&self) -> bool {
        self.job.is_some()
    }

    /// As long as this is set, tracing stops between two bounces of a ray; a tile that was not finished comes again.
    pub fn interrupt(&self) -> Arc<AtomicBool> {
        self.interrupt.clone()
    }

    /// Takes a command.
    pub fn handle(&mut self, command: Command) -> Vec<Reply> {
        match command {
            Command::World(world) => {
                (self.world, self.job) = (world, None);
                Vec::new()
            }
            Command::Style(resolved) => {
                self.job = None;
                if let Some(world) = &mut self.world {
                    world.restyle(&resolved);
                }
                Vec::new()
            }
            Command::Draw(request) => self.draw(*request).into_iter().collect(),
            Command::Stop => {
                self.job = None;
                Vec::new()
            }
            Command::Look(request, x, y) => vec![Reply::Seen(self.look(&request, x, y))],
            Command::Inspect(request, x, y) => self.inspect(&request, x, y).into_iter().collect(),
        }
    }

    fn draw(&mut self, request: Request) -> Option<Reply> {
        self.job = None;
        let world = self.world.as_deref_mut()?;
        world.set_camera(request.camera);
        match Job::new(world, request) {
            Ok(job) => {
                self.job = Some(Box::new(job));
                None
            }
            Err(error) => Some(Reply::Refused(error.to_string())),
        }
    }

    /// Traces one portion; answers where there is something new to show.
    pub fn advance(&mut self) -> Option<Reply> {
        let (world, job) = self.world.as_deref().zip(self.job.as_deref_mut())?;
        let any = job.portion(world, &self.interrupt);
        let now = Instant::now();
        let due = job.last_shown.is_none_or(|last| now.duration_since(last) >= SHOWN_EVERY);
        let complete = job.film.is_complete();
        let reply = (complete || any && due).then(|| job.reply(now));
        if complete {
            self.job = None;
        }
        reply
    }

    fn look(&self, request: &Request, x: f64, y: f64) -> Option<Seen> {
        let world = self.world.as_deref()?;
        let ray = camera_of(request).ray(x, y);
        let nearest = nearest(world, ray)?;
        let surface = world.caster().surface(&ray, &nearest);
        // The tracer itself knows which material a shape has.
        let options = Options { recursion: 0, ..request.options.clone() };
        let node = Tracer::new(world, &options, level()).inspect(ray)?;
        let material = node.meeting.map(|met| met.material)?;
        Some(Seen { number: nearest.number, material, point: surface.point, distance: nearest.hit.t })
    }

    fn inspect(&self, request: &Request, x: f64, y: f64) -> Option<Reply> {
        let world = self.world.as_deref()?;
        let root = Tracer::new(world, &request.options, level()).inspect(camera_of(request).ray(x, y))?;
        let size = world.bounds().size().length();
        Some(Reply::Rays(Arc::new(rows(&root, if size > 0.0 { 2.0 * size } else { 1.0 }))))
    }
}

fn camera_of(request: &Request) -> Camera {
    Camera::new(&request.camera, request.options.width, request.options.height)
}

fn nearest(world: &World, ray: Ray) -> Option<dotray_render::Nearest> {
    let queries = Queries { rays: &[ray], t_min: &[world.ray_eps()], t_max: dotray_accel::ENDLESS };
    world.caster().nearest(&queries, false).first().copied().flatten()
}

impl Job {
    fn new(world: &World, mut request: Request) -> Result<Self, RenderError> {
        let oversampled = request.options.antialias != Antialias::None;
        request.options.tile_size = if oversampled { OVERSAMPLED_TILE } else { TILE };
        request.options.transparent = false;
        let picture = Picture::new(world, &request.options)?;
        let film = picture.film()?;
        let left = middle_first(picture.tiles(), request.options.window());
        let shown = vec![0; film.image().width() * film.image().height() * 4];
        let parts = Some(picture.into_parts());
        Ok(Self { request, parts, film, looks: 0, left, shown, began: Instant::now(), last_shown: None })
    }

    /// Traces tiles for about [`PORTION`]; answers whether any was finished.
    fn portion(&mut self, world: &World, interrupt: &AtomicBool) -> bool {
        let Some(parts) = self.parts.take() else { return false };
        let picture = Picture::of(world, &self.request.options, parts);
        let step = COARSE_STEPS.get(self.looks).copied();
        let traced = trace(&picture, &self.left, step, &Interrupt(interrupt));
        self.parts = Some(picture.into_parts());
        for pixels in &traced {
            if step.is_some() {
                self.film.show(pixels)
            } else {
                self.film.store(pixels)
            };
            show(&mut self.shown, self.request.options.window(), pixels);
        }
        let done: BTreeSet<u32> = traced.iter().map(|pixels| pixels.tile.number).collect();
        self.left.retain(|tile| !done.contains(&tile.number));
        if self.left.is_empty() {
            self.looks += 1;
            self.left = middle_first(self.film.missing(), self.request.options.window());
        }
        !traced.is_empty()
    }

    fn reply(&mut self, now: Instant) -> Reply {
        self.last_shown = Some(now);
        let complete = self.film.is_complete();
        let progress = self.film.progress();
        let part = progress.finished_pixels as f32 / progress.total_pixels.max(1) as f32;
        let image = self.film.image();
        Reply::Picture {
            serial: self.request.serial,
            size: [image.width(), image.height()],
            pixels: Arc::new(self.shown.clone()),
            done: if complete { 1.0 } else { part.min(0.999) },
            seconds: now.duration_since(self.began).as_secs_f64(),
            image: complete.then(|| Arc::new(image.clone())),
        }
    }
}

/// Computes tiles, or looks at them in squares of `step` pixels, for about [`PORTION`]; at least one, unless it is
/// interrupted.
fn trace(
    picture: &Picture<'_>,
    tiles: &[Tile],
    step: Option<u32>,
    interrupt: &Interrupt<'_>,
) -> Vec<TilePixels> {
    let start = Instant::now();
    let next = AtomicUsize::new(0);
    // Each thread takes the next tile, so that they come in order.
    let work = |_| {
        let mut traced = Vec::new();
        while !interrupt.cancelled() && (traced.is_empty() || start.elapsed() < PORTION) {
            let Some(tile) = tiles.get(next.fetch_add(1, Ordering::Relaxed)) else { break };
            traced.extend(match step {
                Some(step) => picture.preview(tile, step, interrupt),
                None => picture.tile(tile, interrupt),
            });
        }
        traced
    };
    (0..rayon::current_num_threads().max(1)).into_par_iter().with_max_len(1).flat_map_iter(work).collect()
}

/// The tiles in the middle of the window before those at its edges: there people look.
fn middle_first(tiles: impl AsRef<[Tile]>, window: Crop) -> Vec<Tile> {
    let off =
        |at: u32, edge: u32, first: u32, size: u32| i64::from(2 * (at - first) + edge) - i64::from(size);
    let mut tiles = tiles.as_ref().to_vec();
    tiles.sort_by_key(|tile| {
        let across = off(tile.x, tile.width, window.x, window.width);
        across.pow(2) + off(tile.y, tile.height, window.y, window.height).pow(2)
    });
    tiles
}

/// Shows a tile in the window's pixels: red, green, blue, alpha.
fn show(shown: &mut [u8], window: Crop, pixels: &TilePixels) {
    let tile = pixels.tile;
    // In double precision, as files have it: where the product is rounded twice, a level may be off.
    let level = |channel: &f32| (f64::from(*channel).clamp(0.0, 1.0) * 255.0).round() as u8;
    for (row, samples) in pixels.samples.chunks_exact(3 * tile.width as usize).enumerate() {
        let row = (tile.y - window.y) as usize + row;
        let start = (row * window.width as usize + (tile.x - window.x) as usize) * 4;
        let line = shown.get_mut(start..start + 4 * tile.width as usize).unwrap_or_default();
        for (pixel, sample) in line.chunks_exact_mut(4).zip(samples.chunks_exact(3)) {
            if let [r, g, b] = sample {
                pixel.copy_from_slice(&[level(r), level(g), level(b), 255]);
            }
        }
    }
}

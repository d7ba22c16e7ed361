//! The tracer behind the screen: one picture at a time, from coarse to fine, in short portions. Whatever comes in
//! between (a newer camera, a question about a pixel) interrupts a portion and is answered at once.
//!
//! It is a state machine without threads of its own: a window lets it run on a thread, a page in slices of time.

use crate::passes::Passes;
use crate::passes::Spot;
use crate::rays::RayRow;
use crate::rays::rows;
use dotray_accel::Queries;
use dotray_accel::simd::level;
use dotray_geometry::Ray;
use dotray_geometry::Vec3;
use dotray_image::Channels;
use dotray_image::Image;
use dotray_render::Antialias;
use dotray_render::Crop;
use dotray_render::Options;
use dotray_render::World;
use dotray_render::camera::Camera;
use dotray_render::sampler;
use dotray_render::sampler::Block;
use dotray_render::sampler::LatticePoint;
use dotray_render::trace::Tracer;
use dotray_scene::Resolved;
use dotray_scene::model;
use rayon::prelude::*;
use std::sync::Arc;
use std::sync::atomic::AtomicBool;
use std::sync::atomic::Ordering;
use std::time::Duration;
use web_time::Instant;

/// What is to be traced.
#[derive(Clone, Debug, PartialEq)]
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
#[derive(Clone, Copy, Debug, PartialEq)]
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

/// How long a portion of work may take: long enough to keep threads and packets of rays full.
pub const PORTION: Duration = Duration::from_millis(30);

/// How often a picture under way is shown.
const SHOWN_EVERY: Duration = Duration::from_millis(40);

/// What a ray is thought to take before any was timed.
const FIRST_GUESS: f64 = 1e-4;

/// The edge of the blocks in which oversampled pixels are traced.
const BLOCK: u32 = 4;

/// The stage of a picture.
#[derive(Debug)]
enum Stage {
    /// One sample a pixel, coarse to fine; the last stage where nothing is oversampled.
    Samples(Passes),
    /// Oversampled blocks: the number of the next.
    Blocks(usize),
}

#[derive(Debug)]
struct Job {
    request: Request,
    camera: Camera,
    window: Crop,
    stage: Stage,
    blocks: Vec<Block>,
    film: Vec<f32>,
    shown: Vec<u8>,
    rays_done: u64,
    seconds_a_ray: f64,
    began: Instant,
    last_shown: Option<Instant>,
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

    /// As long as this is set, no further piece of a portion is begun; what is left of the portion comes later.
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
        self.world.as_ref()?;
        match Job::new(request) {
            Ok(job) => {
                self.job = Some(Box::new(job));
                None
            }
            Err(sentence) => Some(Reply::Refused(sentence)),
        }
    }

    /// Traces one portion; answers where there is something new to show.
    pub fn advance(&mut self) -> Option<Reply> {
        let world = self.world.as_deref()?;
        let job = self.job.as_deref_mut()?;
        let more = job.portion(world, &self.interrupt);
        let now = Instant::now();
        let due = job.last_shown.is_none_or(|last| now.duration_since(last) >= SHOWN_EVERY);
        let reply = (due || !more).then(|| job.reply(!more, now));
        if !more {
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
    fn new(request: Request) -> Result<Self, String> {
        request.options.validate().map_err(|error| error.to_string())?;
        let window = request.options.window();
        let pixels = window.width as usize * window.height as usize;
        if pixels as u64 > request.options.max_pixels {
            return Err(format!("a picture of {}x{} pixels is too large", window.width, window.height));
        }
        let oversampled = request.options.antialias != Antialias::None;
        // Before oversampled blocks a rough picture is enough.
        let passes = Passes::new(window, if oversampled { 4 } else { 1 });
        Ok(Self {
            camera: camera_of(&request),
            window,
            stage: Stage::Samples(passes),
            blocks: if oversampled { blocks(window, request.options.height) } else { Vec::new() },
            film: vec![0.0; pixels * 3],
            shown: vec![0; pixels * 4],
            rays_done: 0,
            seconds_a_ray: FIRST_GUESS,
            began: Instant::now(),
            last_shown: None,
            request,
        })
    }

    /// Rows from below, as the renderer counts, of a row of the window from above.
    fn row_from_below(&self, y: u32) -> u32 {
        self.request.options.height - 1 - self.window.y - y
    }

    /// Traces as much as takes about [`PORTION`]; false where nothing is left.
    fn portion(&mut self, world: &World, interrupt: &AtomicBool) -> bool {
        let threads = rayon::current_num_threads().max(1);
        let start = Instant::now();
        let most = (PORTION.as_secs_f64() * threads as f64 / self.seconds_a_ray).clamp(1.0, 65536.0) as usize;
        let rays = match &mut self.stage {
            Stage::Samples(passes) => {
                let spots = passes.next(most);
                if spots.is_empty() {
                    self.stage = Stage::Blocks(0);
                    return !self.blocks.is_empty();
                }
                self.spots(world, &spots, threads, interrupt)
            }
            Stage::Blocks(first) => {
                let first = *first;
                let a_block = (BLOCK * BLOCK) as usize * self.samples_a_pixel();
                let count = (most / a_block).max(1).min(self.blocks.len() - first);
                self.stage = Stage::Blocks(first + count);
                self.block_range(world, first, count, interrupt) * a_block
            }
        };
        self.rays_done += rays as u64;
        // A moving mean, quick to learn that a part of the picture is dear.
        if rays > 0 {
            let measured = start.elapsed().as_secs_f64() * threads as f64 / rays as f64;
            self.seconds_a_ray = (0.3 * self.seconds_a_ray + 0.7 * measured).clamp(1e-8, 10.0);
        }
        match &self.stage {
            Stage::Samples(_) => true,
            Stage::Blocks(next) => *next < self.blocks.len(),
        }
    }

    fn samples_a_pixel(&self) -> usize {
        match self.request.options.antialias {
            Antialias::None => 1,
            Antialias::Grid(n) => (n * n) as usize,
            Antialias::Adaptive { .. } => 2,
        }
    }

    /// Traces pixels; answers how many.
    fn spots(&mut self, world: &World, spots: &[Spot], threads: usize, interrupt: &AtomicBool) -> usize {
        let piece = spots.len().div_ceil(threads * 4).max(4);
        let (camera, options) = (&self.camera, &self.request.options);
        let place = |spot: &Spot| {
            let (i, j) = (self.window.x + spot.x, self.row_from_below(spot.y));
            camera.ray(f64::from(i) + 0.5, f64::from(j) + 0.5)
        };
        let trace = |spots: &[Spot]| {
            let rays: Vec<Ray> = spots.iter().map(place).collect();
            let go_on = !interrupt.load(Ordering::Relaxed);
            go_on.then(|| Tracer::new(world, options, level()).colors(&rays))
        };
        let pieces: Vec<Option<Vec<Vec3>>> = spots.par_chunks(piece).map(trace).collect();
        let (mut traced, mut left) = (0, Vec::new());
        for (spots, colors) in spots.chunks(piece).zip(pieces) {
            let Some(colors) = colors else {
                left.extend_from_slice(spots);
                continue;
            };
            traced += spots.len();
            spots.iter().zip(colors).for_each(|(spot, color)| self.store(spot.x, spot.y, spot.size, color));
        }
        if let Stage::Samples(passes) = &mut self.stage {
            passes.give_back(left);
        }
        traced
    }

    /// Traces oversampled blocks; answers how many.
    fn block_range(&mut self, world: &World, first: usize, count: usize, interrupt: &AtomicBool) -> usize {
        let blocks = self.blocks.get(first..first + count).unwrap_or_default().to_vec();
        let (camera, options) = (&self.camera, &self.request.options);
        let trace = |block: &Block| {
            let go_on = !interrupt.load(Ordering::Relaxed);
            go_on.then(|| oversampled(world, options, camera, *block))
        };
        let all: Vec<Option<Vec<Vec3>>> = blocks.par_iter().map(trace).collect();
        let mut traced = 0;
        for (block, colors) in blocks.iter().zip(all) {
            let Some(colors) = colors else {
                self.blocks.push(*block);
                continue;
            };
            traced += 1;
            for ((i, j), color) in block.pixels().into_iter().zip(colors) {
                self.store(i - self.window.x, self.row_from_below(0) - j, 1, color);
            }
        }
        traced
    }

    /// Keeps a colour, and shows it in the square that it stands for.
    fn store(&mut self, x: u32, y: u32, size: u32, color: Vec3) {
        let width = self.window.width as usize;
        let at = (y as usize * width + x as usize) * 3;
        let color = color.to_array().map(|channel| channel as f32);
        if let Some(pixel) = self.film.get_mut(at..at + 3) {
            pixel.copy_from_slice(&color);
        }
        // In double precision, as files have it: where the product is rounded twice, a level may be off.
        let [r, g, b] = color.map(|channel| (f64::from(channel).clamp(0.0, 1.0) * 255.0).round() as u8);
        let right = (x + size).min(self.window.width) as usize;
        for row in y..(y + size).min(self.window.height) {
            let start = row as usize * width;
            let span = self.shown.get_mut((start + x as usize) * 4..(start + right) * 4).unwrap_or_default();
            span.chunks_exact_mut(4).for_each(|pixel| pixel.copy_from_slice(&[r, g, b, 255]));
        }
    }

    fn reply(&mut self, finished: bool, now: Instant) -> Reply {
        self.last_shown = Some(now);
        let (width, height) = (self.window.width as usize, self.window.height as usize);
        let pixels = (width * height) as f64;
        let total = if self.blocks.is_empty() {
            pixels
        } else {
            pixels * (1.0 / 16.0 + self.samples_a_pixel() as f64)
        };
        let image = finished.then(|| std::mem::take(&mut self.film));
        let image = image.and_then(|film| Image::from_samples(width, height, Channels::Rgb, film).ok());
        Reply::Picture {
            serial: self.request.serial,
            size: [width, height],
            pixels: Arc::new(self.shown.clone()),
            done: if finished { 1.0 } else { (self.rays_done as f64 / total).min(0.999) as f32 },
            seconds: now.duration_since(self.began).as_secs_f64(),
            image: image.map(Arc::new),
        }
    }
}

/// The window in blocks, those in the middle first; pixels from the lower left, as the sampler counts.
fn blocks(window: Crop, height: u32) -> Vec<Block> {
    let bottom = height - window.y - window.height;
    let mut blocks = Vec::new();
    for y in (0..window.height).step_by(BLOCK as usize) {
        for x in (0..window.width).step_by(BLOCK as usize) {
            let (width, height) = (BLOCK.min(window.width - x), BLOCK.min(window.height - y));
            blocks.push(Block { x: window.x + x, y: bottom + y, width, height });
        }
    }
    let off = |at: u32, first: u32, size: u32| i64::from(2 * (at - first) + BLOCK) - i64::from(size);
    blocks.sort_by_key(|block| {
        off(block.x, window.x, window.width).pow(2) + off(block.y, bottom, window.height).pow(2)
    });
    blocks
}

fn oversampled(world: &World, options: &Options, camera: &Camera, block: Block) -> Vec<Vec3> {
    let mut tracer = Tracer::new(world, options, level());
    match options.antialias {
        Antialias::None | Antialias::Grid(_) => {
            let n = if let Antialias::Grid(n) = options.antialias { n } else { 1 };
            let places = sampler::grid_places(&block.pixels(), n);
            let rays: Vec<Ray> = places.iter().map(|&(x, y)| camera.ray(x, y)).collect();
            sampler::grid_means(tracer.colors(&rays), n)
        }
        Antialias::Adaptive { threshold, depth } => {
            let scale = 1.0 / (1_u64 << depth) as f64;
            let ray = |p: &LatticePoint| camera.ray(p.x as f64 * scale, p.y as f64 * scale);
            sampler::adaptive(block, threshold, depth, |points: &[LatticePoint]| {
                tracer.colors(&points.iter().map(ray).collect::<Vec<_>>())
            })
        }
    }
}

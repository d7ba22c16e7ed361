//! The picture, tile by tile: order, threads, progress, cancelling.

use crate::camera::Camera;
use crate::error::RenderError;
use crate::options::Antialias;
use crate::options::Crop;
use crate::options::Options;
use crate::sampler;
use crate::sampler::Block;
use crate::sampler::LatticePoint;
use crate::sampler::Sample;
use crate::stats::MemoryPart;
use crate::stats::Stats;
use crate::threads::on_threads;
use crate::trace::Tracer;
use crate::world::World;
use dotray_geometry::Ray;
use dotray_geometry::Vec3;
use dotray_geometry::Vec4;
use dotray_image::Channels;
use dotray_image::Image;
use dotray_image::Limits;
use rayon::prelude::*;
use std::collections::HashMap;
use std::sync::Condvar;
use std::sync::Mutex;
use std::sync::PoisonError;
use web_time::Instant;

/// How far a picture has come.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Progress {
    /// Pixels that are finished.
    pub finished_pixels: u64,
    /// All pixels.
    pub total_pixels: u64,
}

/// Somebody who watches a picture being made and may stop it.
pub trait Observer: Sync {
    /// A tile is finished; called from any thread.
    fn tile_finished(&self, progress: &Progress) {
        let _ = progress;
    }

    /// Whether to stop; asked before each tile.
    fn cancelled(&self) -> bool {
        false
    }
}

/// Nobody watches.
#[derive(Clone, Copy, Debug, Default)]
pub struct Silent;

impl Observer for Silent {}

/// A picture and what it cost.
#[derive(Debug)]
pub struct Rendering {
    /// The window's pixels, upper row first; black where the work was cancelled before.
    pub image: Image,
    /// Counts, bytes, seconds.
    pub stats: Stats,
    /// Whether every tile was computed.
    pub complete: bool,
}

/// What tiles write into.
struct Film {
    image: Image,
    stats: Stats,
    finished_pixels: u64,
}

/// Makes the picture.
///
/// # Errors
/// Options that make no sense, a picture too large for memory, threads that cannot be started.
pub fn render(world: &World, options: &Options, observer: &dyn Observer) -> Result<Rendering, RenderError> {
    options.validate()?;
    let start = Instant::now();
    let window = options.window();
    let channels = if options.transparent { Channels::Rgba } else { Channels::Rgb };
    // Whoever allows so many pixels allows the memory for them.
    let limits = Limits { max_pixels: options.max_pixels, max_bytes: u64::MAX };
    let image = Image::new_within(window.width as usize, window.height as usize, channels, &limits).map_err(
        |error| RenderError::Film { width: window.width, height: window.height, reason: error.to_string() },
    )?;
    let film_bytes = size_of_val(image.samples()) as u64;
    let film = Film { image, stats: Stats::default(), finished_pixels: 0 };
    let (film, complete) = if options.transparent {
        develop::<Vec4>(world, options, film, observer)?
    } else {
        develop::<Vec3>(world, options, film, observer)?
    };
    let Film { image, mut stats, .. } = film;
    stats.memory = world.memory();
    stats.memory.push(MemoryPart { name: "film", bytes: film_bytes });
    stats.seconds = world.seconds().to_vec();
    stats.seconds.push(("trace", start.elapsed().as_secs_f64()));
    Ok(Rendering { image, stats, complete })
}

/// Fills the film with samples of one kind; also says whether every tile was computed.
fn develop<T: Traced>(
    world: &World,
    options: &Options,
    film: Film,
    observer: &dyn Observer,
) -> Result<(Film, bool), RenderError> {
    let window = options.window();
    let job = Job::<T> {
        world,
        options,
        camera: Camera::new(&world.camera, options.width, options.height),
        window,
        borders: Borders { known: Mutex::default(), published: Condvar::new() },
        film: Mutex::new(film),
        observer,
    };
    let tiles = tiles(options, window);
    let run = || tiles.par_iter().with_max_len(1).map(|tile| job.tile(*tile)).reduce(|| true, |a, b| a && b);
    let complete = on_threads(options.threads, run)?;
    Ok((job.film.into_inner().unwrap_or_else(PoisonError::into_inner), complete))
}

/// A sample that the tracer gives and the film takes.
trait Traced: Sample {
    /// Samples of these rays.
    fn trace(tracer: &mut Tracer<'_>, rays: &[Ray]) -> Vec<Self>;

    /// Stores it as a pixel of the film.
    fn store(self, pixel: &mut [f32]);

    /// The film's channels.
    const CHANNELS: usize;
}

impl Traced for Vec3 {
    const CHANNELS: usize = 3;

    fn trace(tracer: &mut Tracer<'_>, rays: &[Ray]) -> Vec<Self> {
        tracer.colors(rays)
    }

    fn store(self, pixel: &mut [f32]) {
        pixel.copy_from_slice(&self.to_array().map(|x| x as f32));
    }
}

impl Traced for Vec4 {
    const CHANNELS: usize = 4;

    fn trace(tracer: &mut Tracer<'_>, rays: &[Ray]) -> Vec<Self> {
        tracer.covered_colors(rays)
    }

    /// Pictures in memory are not multiplied by alpha.
    fn store(self, pixel: &mut [f32]) {
        let alpha = self.w;
        let color = if alpha > 0.0 { self.truncate() / alpha } else { Vec3::ZERO };
        pixel.copy_from_slice(&color.extend(alpha).to_array().map(|x| x as f32));
    }
}

/// The window in tiles along a Morton curve, so that tiles computed one after another look at the same part of the
/// scene. The grid of tiles starts at the picture's lower left corner.
fn tiles(options: &Options, window: Crop) -> Vec<Block> {
    let size = options.tile_size;
    let bottom = options.height - window.y - window.height;
    let columns = window.x / size..(window.x + window.width).div_ceil(size);
    let rows = bottom / size..(bottom + window.height).div_ceil(size);
    let mut tiles: Vec<(u64, Block)> = Vec::new();
    for row in rows {
        for column in columns.clone() {
            let (left, low) = ((column * size).max(window.x), (row * size).max(bottom));
            let right = ((column + 1) * size).min(window.x + window.width);
            let high = ((row + 1) * size).min(bottom + window.height);
            let block = Block { x: left, y: low, width: right - left, height: high - low };
            tiles.push((spread(column) | spread(row) << 1, block));
        }
    }
    tiles.sort_by_key(|(key, _)| *key);
    tiles.into_iter().map(|(_, block)| block).collect()
}

/// The bits of a number on every other place.
fn spread(number: u32) -> u64 {
    (0..32).fold(0, |sum, bit| sum | u64::from(number >> bit & 1) << (2 * bit))
}

/// The samples of a grid that are held at once.
const GRID_SAMPLES: usize = 1 << 12;

struct Job<'a, T> {
    world: &'a World,
    options: &'a Options,
    camera: Camera,
    window: Crop,
    borders: Borders<T>,
    film: Mutex<Film>,
    observer: &'a dyn Observer,
}

impl<T: Traced> Job<'_, T> {
    /// Computes a tile and stores it; false where the work was cancelled before.
    fn tile(&self, block: Block) -> bool {
        if self.observer.cancelled() {
            return false;
        }
        let mut tracer = Tracer::new(self.world, self.options, dotray_accel::simd::level());
        let colors = match self.options.antialias {
            Antialias::None => self.grid(block, 1, &mut tracer),
            Antialias::Grid(n) => self.grid(block, n, &mut tracer),
            Antialias::Adaptive { threshold, depth } => self.adaptive(block, threshold, depth, &mut tracer),
        };
        self.store(block, &colors, &tracer.stats);
        true
    }

    fn grid(&self, block: Block, n: u32, tracer: &mut Tracer<'_>) -> Vec<T> {
        // Some pixels at a time, lest the samples of a fine grid fill memory.
        let at_once = (GRID_SAMPLES / (n * n) as usize).max(1);
        let mut colors = Vec::new();
        for pixels in block.pixels().chunks(at_once) {
            let places = sampler::grid_places(pixels, n);
            let rays: Vec<Ray> = places.iter().map(|&(x, y)| self.camera.ray(x, y)).collect();
            colors.append(&mut sampler::grid_means(T::trace(tracer, &rays), n));
        }
        colors
    }

    fn adaptive(&self, block: Block, threshold: f64, depth: u32, tracer: &mut Tracer<'_>) -> Vec<T> {
        let edge = 1u64 << depth;
        let scale = 1.0 / edge as f64;
        let (left, right) = (u64::from(block.x) * edge, u64::from(block.x + block.width) * edge);
        let (low, high) = (u64::from(block.y) * edge, u64::from(block.y + block.height) * edge);
        let on_border = |p: &LatticePoint| p.x == left || p.x == right || p.y == low || p.y == high;
        let mut trace = |points: &[LatticePoint]| {
            let rays: Vec<Ray> =
                points.iter().map(|p| self.camera.ray(p.x as f64 * scale, p.y as f64 * scale)).collect();
            T::trace(tracer, &rays)
        };
        sampler::adaptive(block, threshold, depth, |points| self.borders.share(points, on_border, &mut trace))
    }

    fn store(&self, block: Block, colors: &[T], stats: &Stats) {
        let mut film = self.film.lock().unwrap_or_else(PoisonError::into_inner);
        let width = self.window.width as usize;
        let samples = film.image.samples_mut();
        for ((i, j), color) in block.pixels().into_iter().zip(colors) {
            let x = (i - self.window.x) as usize;
            let y = (self.options.height - 1 - j - self.window.y) as usize;
            let start = (y * width + x) * T::CHANNELS;
            color.store(&mut samples[start..start + T::CHANNELS]);
        }
        film.stats.add_counts(stats);
        film.finished_pixels += u64::from(block.width) * u64::from(block.height);
        let progress = Progress {
            finished_pixels: film.finished_pixels,
            total_pixels: u64::from(self.window.width) * u64::from(self.window.height),
        };
        drop(film);
        self.observer.tile_finished(&progress);
    }
}

/// Samples on the borders of tiles, so that two tiles that share one trace it once. `None` is a claim: some tile
/// is about to publish the colour.
struct Borders<T> {
    known: Mutex<HashMap<LatticePoint, Option<T>>>,
    published: Condvar,
}

/// A tile's claims; given up should the tile fail before it publishes, so that nobody waits for ever.
struct Claims<'a, T: Sample> {
    borders: &'a Borders<T>,
    points: Vec<LatticePoint>,
}

impl<T: Sample> Drop for Claims<'_, T> {
    fn drop(&mut self) {
        let mut known = self.borders.known.lock().unwrap_or_else(PoisonError::into_inner);
        for point in &self.points {
            if known.get(point) == Some(&None) {
                known.remove(point);
            }
        }
        self.borders.published.notify_all();
    }
}

impl<T: Sample> Borders<T> {
    /// The colours of `points`: those that nobody has claimed are traced and published, the others are waited for.
    /// A tile publishes what it has claimed before it waits, so two tiles never wait for each other.
    fn share(
        &self,
        points: &[LatticePoint],
        on_border: impl Fn(&LatticePoint) -> bool,
        trace: &mut impl FnMut(&[LatticePoint]) -> Vec<T>,
    ) -> Vec<T> {
        let mut colors: Vec<Option<T>> = vec![None; points.len()];
        let (mine, claims) = self.claim(points, on_border);
        let wanted: Vec<LatticePoint> = mine.iter().map(|&index| points[index]).collect();
        for (&index, color) in mine.iter().zip(trace(&wanted)) {
            colors[index] = Some(color);
        }
        self.publish(claims, points.iter().zip(&colors));
        let color = |(point, color): (&LatticePoint, Option<T>)| {
            color.or_else(|| self.wait_for(point)).unwrap_or_else(|| trace(&[*point])[0])
        };
        points.iter().zip(colors).map(color).collect()
    }

    /// The indices of the points that the caller traces, with its claims on those that others may want.
    fn claim(
        &self,
        points: &[LatticePoint],
        on_border: impl Fn(&LatticePoint) -> bool,
    ) -> (Vec<usize>, Claims<'_, T>) {
        let mut known = self.known.lock().unwrap_or_else(PoisonError::into_inner);
        let mut claims = Claims { borders: self, points: Vec::new() };
        let mut mine = Vec::with_capacity(points.len());
        for (index, point) in points.iter().enumerate() {
            if on_border(point) {
                if known.contains_key(point) {
                    continue;
                }
                known.insert(*point, None);
                claims.points.push(*point);
            }
            mine.push(index);
        }
        (mine, claims)
    }

    fn publish<'p>(
        &self,
        claims: Claims<'_, T>,
        colors: impl Iterator<Item = (&'p LatticePoint, &'p Option<T>)>,
    ) where
        T: 'p,
    {
        let mut known = self.known.lock().unwrap_or_else(PoisonError::into_inner);
        for (point, color) in colors {
            if let Some(entry @ None) = known.get_mut(point) {
                *entry = *color;
            }
        }
        drop(known);
        drop(claims);
    }

    /// The colour that another tile publishes; `None` where it gave up.
    fn wait_for(&self, point: &LatticePoint) -> Option<T> {
        let mut known = self.known.lock().unwrap_or_else(PoisonError::into_inner);
        loop {
            match known.get(point) {
                Some(Some(color)) => return Some(*color),
                Some(None) => known = self.published.wait(known).unwrap_or_else(PoisonError::into_inner),
                None => return None,
            }
        }
    }
}

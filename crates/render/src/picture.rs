//! A picture as tiles that can be computed alone: in any order, by any number of threads, processes or machines.

use crate::borders::Borders;
use crate::camera::Camera;
use crate::error::RenderError;
use crate::film::Film;
use crate::observer::Observer;
use crate::options::Antialias;
use crate::options::Options;
use crate::sampler;
use crate::sampler::Block;
use crate::sampler::LatticePoint;
use crate::sampler::Sample;
use crate::tile::Tile;
use crate::tile::TilePixels;
use crate::tile::tiles;
use crate::trace::Tracer;
use crate::world::World;
use dotray_geometry::Ray;
use dotray_geometry::Vec3;
use dotray_geometry::Vec4;

/// A picture that is to be made of a world.
///
/// A tile's pixels depend on the world, the options and the tile alone, so tiles that were computed apart make the same
/// picture as [`render`](crate::tiles::render) does in one go.
///
/// ```
/// use dotray_render::{Options, Picture, PrepareOptions, Silent, TilePixels, World, render};
/// use dotray_scene::{files, load, resolve};
///
/// let text = "#camera 0 0 4 0 0 -1 0 1 0 .5  #light_dir 1 1 1 0 -1 -1  #shape_sphere -1 0 0 0 1";
/// let scene = load::load_text("a.ray", text, &files::Disk, &load::LoadOptions::default()).scene.expect("a scene");
/// let resolved = resolve::resolve(scene).resolved.expect("resolved");
/// let world = World::prepare(resolved, &files::Disk, &PrepareOptions::default()).expect("a world");
/// let options = Options { width: 100, height: 75, ..Options::default() };
///
/// let picture = Picture::new(&world, &options)?;
/// let mut film = picture.film()?;
/// for tile in picture.tiles().iter().rev() {
///     let bytes = picture.tile(tile, &Silent).expect("nobody cancels").to_bytes();
///     assert!(film.store(&TilePixels::from_bytes(&bytes).expect("whole")));
/// }
/// assert!(film.is_complete());
/// assert_eq!(film.into_image(), render(&world, &options, &Silent)?.image);
/// # Ok::<(), dotray_render::RenderError>(())
/// ```
#[derive(Debug)]
pub struct Picture<'a> {
    world: &'a World,
    options: &'a Options,
    parts: Parts,
}

/// What a picture is made of besides its world and its options: to be kept where those cannot stay borrowed, and to go
/// on with later.
#[derive(Debug)]
pub struct Parts {
    camera: Camera,
    tiles: Vec<Tile>,
    /// Of the two, the one is used whose samples the picture has.
    opaque: Borders<Vec3>,
    covered: Borders<Vec4>,
}

/// A sample that the tracer gives and the film takes.
trait Traced: Sample {
    /// Numbers a pixel.
    const CHANNELS: u32;

    /// Samples of these rays; fewer where the tracer was stopped.
    fn trace(tracer: &mut Tracer<'_>, rays: &[Ray]) -> Vec<Self>;

    /// Stores it as a pixel.
    fn store(self, pixel: &mut [f32]);

    /// Any sample.
    const BLACK: Self;
}

impl Traced for Vec3 {
    const CHANNELS: u32 = 3;
    const BLACK: Self = Self::ZERO;

    fn trace(tracer: &mut Tracer<'_>, rays: &[Ray]) -> Vec<Self> {
        tracer.colors(rays)
    }

    fn store(self, pixel: &mut [f32]) {
        pixel.copy_from_slice(&self.to_array().map(|x| x as f32));
    }
}

impl Traced for Vec4 {
    const CHANNELS: u32 = 4;
    const BLACK: Self = Self::ZERO;

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

/// The samples of a grid that are held at once.
const GRID_SAMPLES: usize = 1 << 12;

impl<'a> Picture<'a> {
    /// The picture that `options` ask for.
    ///
    /// # Errors
    /// Options that make no sense.
    pub fn new(world: &'a World, options: &'a Options) -> Result<Self, RenderError> {
        options.validate()?;
        let camera = Camera::new(&world.camera, options.width, options.height);
        let (tiles, opaque, covered) = (tiles(options), Borders::default(), Borders::default());
        Ok(Self::of(world, options, Parts { camera, tiles, opaque, covered }))
    }

    /// A picture of these parts, which were taken from one of the same world, seen by the same camera, and of the same
    /// options.
    pub fn of(world: &'a World, options: &'a Options, parts: Parts) -> Self {
        Self { world, options, parts }
    }

    /// Its parts, so that another picture can go on with them.
    pub fn into_parts(self) -> Parts {
        self.parts
    }

    /// The world that it shows.
    pub fn world(&self) -> &'a World {
        self.world
    }

    /// What it was asked for by.
    pub fn options(&self) -> &'a Options {
        self.options
    }

    /// Its tiles by number, along a Morton curve. They depend on size, crop and tile size alone.
    pub fn tiles(&self) -> &[Tile] {
        &self.parts.tiles
    }

    /// A film for its tiles, all missing.
    ///
    /// # Errors
    /// A picture too large for memory.
    pub fn film(&self) -> Result<Film, RenderError> {
        Film::new(self.options)
    }

    /// Computes a tile; `None` where the observer cancelled it. The observer is asked for nothing else.
    ///
    /// # Panics
    /// May panic where the tile is not one of this picture's.
    pub fn tile(&self, tile: &Tile, observer: &dyn Observer) -> Option<TilePixels> {
        if self.options.transparent {
            self.compute(tile, &self.parts.covered, observer)
        } else {
            self.compute(tile, &self.parts.opaque, observer)
        }
    }

    /// Looks at a tile coarsely, with one ray a square of `step` pixels, whose colour all pixels of the square get;
    /// `None` where the observer cancelled it.
    ///
    /// # Panics
    /// May panic where the tile is not one of this picture's.
    pub fn preview(&self, tile: &Tile, step: u32, observer: &dyn Observer) -> Option<TilePixels> {
        let step = step.max(1);
        if self.options.transparent {
            self.look::<Vec4>(tile, step, observer)
        } else {
            self.look::<Vec3>(tile, step, observer)
        }
    }

    fn compute<T: Traced>(
        &self,
        tile: &Tile,
        borders: &Borders<T>,
        observer: &dyn Observer,
    ) -> Option<TilePixels> {
        let mut tracer = self.tracer(observer);
        let block = self.block(tile);
        let colors = match self.options.antialias {
            Antialias::None => self.grid(block, 1, &mut tracer),
            Antialias::Grid(n) => self.grid(block, n, &mut tracer),
            Antialias::Adaptive { threshold, depth } => {
                self.adaptive(block, threshold, depth, &mut tracer, borders)
            }
        }?;
        let mut samples = vec![0.0; block.width as usize * block.height as usize * T::CHANNELS as usize];
        for ((i, j), color) in block.pixels().into_iter().zip(colors) {
            let row = block.height - 1 - (j - block.y);
            let at = (row as usize * block.width as usize + (i - block.x) as usize) * T::CHANNELS as usize;
            color.store(&mut samples[at..at + T::CHANNELS as usize]);
        }
        Some(TilePixels { tile: *tile, channels: T::CHANNELS, samples, counts: tracer.stats })
    }

    /// The tile's pixels counted from the lower left.
    fn block(&self, tile: &Tile) -> Block {
        let y = self.options.height - tile.y - tile.height;
        Block { x: tile.x, y, width: tile.width, height: tile.height }
    }

    fn tracer<'b>(&self, observer: &'b dyn Observer) -> Tracer<'b>
    where
        'a: 'b,
    {
        Tracer::new(self.world, self.options, dotray_accel::simd::level()).watched_by(observer)
    }

    fn grid<T: Traced>(&self, block: Block, n: u32, tracer: &mut Tracer<'_>) -> Option<Vec<T>> {
        // Some pixels at a time, lest the samples of a fine grid fill memory.
        let at_once = (GRID_SAMPLES / (n * n) as usize).max(1);
        let mut colors = Vec::new();
        for pixels in block.pixels().chunks(at_once) {
            let places = sampler::grid_places(pixels, n);
            let rays: Vec<Ray> = places.iter().map(|&(x, y)| self.parts.camera.ray(x, y)).collect();
            let traced = T::trace(tracer, &rays);
            if tracer.is_stopped() {
                return None;
            }
            colors.append(&mut sampler::grid_means(traced, n));
        }
        Some(colors)
    }

    fn adaptive<T: Traced>(
        &self,
        block: Block,
        threshold: f64,
        depth: u32,
        tracer: &mut Tracer<'_>,
        borders: &Borders<T>,
    ) -> Option<Vec<T>> {
        let edge = 1u64 << depth;
        let scale = 1.0 / edge as f64;
        let (left, right) = (u64::from(block.x) * edge, u64::from(block.x + block.width) * edge);
        let (low, high) = (u64::from(block.y) * edge, u64::from(block.y + block.height) * edge);
        let on_border = |p: &LatticePoint| p.x == left || p.x == right || p.y == low || p.y == high;
        let observer = tracer.observer();
        let mut trace = |points: &[LatticePoint]| {
            let rays: Vec<Ray> = points
                .iter()
                .map(|p| self.parts.camera.ray(p.x as f64 * scale, p.y as f64 * scale))
                .collect();
            let colors = T::trace(tracer, &rays);
            (!tracer.is_stopped()).then_some(colors)
        };
        let mut stopped = false;
        let means = sampler::adaptive(block, threshold, depth, |points| {
            let shared = if stopped {
                None
            } else {
                borders.share(points, on_border, &mut trace, || observer.cancelled())
            };
            // What is not traced any more looks alike everywhere, so that the division comes to its end.
            shared.unwrap_or_else(|| {
                stopped = true;
                vec![T::BLACK; points.len()]
            })
        });
        (!stopped).then_some(means)
    }

    fn look<T: Traced>(&self, tile: &Tile, step: u32, observer: &dyn Observer) -> Option<TilePixels> {
        let mut tracer = self.tracer(observer);
        let squares = |edge: u32| edge.div_ceil(step);
        let middle = |square: u32, edge: u32| (square * step + step / 2).min(edge - 1);
        let mut rays = Vec::new();
        for row in 0..squares(tile.height) {
            for column in 0..squares(tile.width) {
                let x = tile.x + middle(column, tile.width);
                let from_below = self.options.height - 1 - (tile.y + middle(row, tile.height));
                rays.push(self.parts.camera.ray(f64::from(x) + 0.5, f64::from(from_below) + 0.5));
            }
        }
        let colors = T::trace(&mut tracer, &rays);
        if tracer.is_stopped() {
            return None;
        }
        let mut samples = Vec::new();
        for y in 0..tile.height {
            for x in 0..tile.width {
                let color = colors[(y / step * squares(tile.width) + x / step) as usize];
                let at = samples.len();
                samples.resize(at + T::CHANNELS as usize, 0.0);
                color.store(&mut samples[at..]);
            }
        }
        Some(TilePixels { tile: *tile, channels: T::CHANNELS, samples, counts: tracer.stats })
    }
}

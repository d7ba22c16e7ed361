//! A picture under way, and its tiles.

use super::Part;
use super::Reply;
use super::Request;
use super::Share;
use super::interrupt::Interrupt;
use dotray_render::Antialias;
use dotray_render::Crop;
use dotray_render::Film;
use dotray_render::Observer;
use dotray_render::Parts;
use dotray_render::Picture;
use dotray_render::RenderError;
use dotray_render::Tile;
use dotray_render::TilePixels;
use dotray_render::World;
use dotray_render::progress::Meter;
use dotray_render::tiles::COARSE_STEPS;
use rayon::prelude::*;
use std::collections::BTreeSet;
use std::sync::Arc;
use std::sync::atomic::AtomicUsize;
use std::sync::atomic::Ordering;
use std::time::Duration;
use web_time::Instant;

/// For how long a portion of work begins new tiles.
pub const PORTION: Duration = Duration::from_millis(if cfg!(target_arch = "wasm32") { 12 } else { 30 });

/// The edge of a tile: small, so that a portion that nobody can interrupt ends soon after its time.
const TILE: u32 = 16;

/// The edge of a tile whose pixels have many samples each.
const OVERSAMPLED_TILE: u32 = 8;

/// A picture under way.
#[derive(Debug)]
pub struct Job {
    pub request: Request,
    /// Taken out while a portion is traced.
    parts: Option<Parts>,
    pub film: Film,
    /// How many of the coarse looks are done.
    looks: usize,
    /// What this look, or the picture itself, still lacks, in order.
    left: Vec<Tile>,
    /// What others trace of it.
    lent: Vec<Tile>,
    shown: Vec<u8>,
    meter: Meter,
    pub begun: Instant,
    pub last_shown: Option<Instant>,
}

impl Job {
    pub fn new(world: &World, mut request: Request) -> Result<Self, RenderError> {
        let oversampled = request.options.antialias != Antialias::None;
        request.options.tile_size = if oversampled { OVERSAMPLED_TILE } else { TILE };
        request.options.transparent = false;
        let picture = Picture::new(world, &request.options)?;
        let film = picture.film()?;
        let left = middle_first(picture.tiles(), request.options.window());
        let shown = vec![0; film.image().width() * film.image().height() * 4];
        let (parts, mut meter) = (Some(picture.into_parts()), Meter::new());
        meter.advance(&film.progress());
        let (lent, begun) = (Vec::new(), Instant::now());
        Ok(Self { request, parts, film, looks: 0, left, lent, shown, meter, begun, last_shown: None })
    }

    /// Traces tiles for about [`PORTION`]; answers whether any was finished.
    pub fn portion(&mut self, world: &World, interrupt: &Interrupt<'_>) -> bool {
        let Some(parts) = self.parts.take() else { return false };
        let picture = Picture::of(world, &self.request.options, parts);
        // Where nothing else is left, what was lent: nobody waits for another who is slow, or gone.
        let lent: Vec<Tile> =
            if self.left.is_empty() { self.lent.iter().rev().copied().collect() } else { Vec::new() };
        let tiles = if self.left.is_empty() { &lent } else { &self.left };
        let traced = trace(&picture, tiles, COARSE_STEPS.get(self.looks).copied(), interrupt);
        self.parts = Some(picture.into_parts());
        self.take(&traced);
        !traced.is_empty()
    }

    fn take(&mut self, traced: &[TilePixels]) {
        let is_look = self.looks < COARSE_STEPS.len();
        for pixels in traced {
            let is_new = if is_look { self.film.show(pixels) } else { self.film.store(pixels) };
            if is_new {
                show(&mut self.shown, self.request.options.window(), pixels);
            }
        }
        let done: BTreeSet<u32> = traced.iter().map(|pixels| pixels.tile.number).collect();
        self.left.retain(|tile| !done.contains(&tile.number));
        self.lent.retain(|tile| !done.contains(&tile.number));
        if self.left.is_empty() && self.lent.is_empty() {
            self.looks += 1;
            self.left = middle_first(self.film.missing(), self.request.options.window());
        }
    }

    pub fn lend(&mut self, count: usize) -> Option<Share> {
        // The last one stays here.
        let count = count.min(self.left.len().saturating_sub(1));
        let tiles: Vec<u32> = self.left.iter().take(count).map(|tile| tile.number).collect();
        self.lent.extend(self.left.drain(..count));
        (count > 0).then(|| Share { request: self.request.clone(), looks: self.looks, tiles })
    }

    pub fn accept(&mut self, part: &Part) -> bool {
        let fits = part.serial == self.request.serial && part.looks == self.looks;
        if fits {
            self.take(&part.tiles);
        }
        fits && !part.tiles.is_empty()
    }

    pub fn reply(&mut self, now: Instant) -> Reply {
        self.last_shown = Some(now);
        let complete = self.film.is_complete();
        let progress = self.meter.advance(&self.film.progress());
        let image = self.film.image();
        Reply::Picture {
            serial: self.request.serial,
            size: [image.width(), image.height()],
            pixels: Arc::new(self.shown.clone()),
            progress,
            image: complete.then(|| Arc::new(image.clone())),
        }
    }
}

/// Computes tiles, or looks at them in squares of `step` pixels, for about [`PORTION`]; at least one, unless it is
/// interrupted.
pub fn trace(
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

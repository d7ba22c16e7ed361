//! What layers are put together on, band by band.

use crate::error::RenderError;
use crate::layers::Layer;
use crate::layers::LayerPicture;
use crate::layers::numbers_a_pixel;
use crate::layers::options_of;
use crate::layers::samples_of;
use crate::observer::Observer;
use crate::observer::Progress;
use crate::options::Crop;
use crate::options::Options;
use crate::stats::Stats;
use crate::threads::on_threads;
use crate::tile::Tile;
use crate::tile::TilePixels;
use crate::tile::tiles;
use crate::world::World;
use rayon::prelude::*;
use std::sync::Mutex;
use std::sync::PoisonError;

/// The rows that are traced together: as many as a brick of pixels has.
const BAND: u32 = 4;

/// Layers that are being put together of bands, which are tiles as wide as the picture. Their numbers follow those of
/// the picture's own tiles, so that one file can hold both.
#[derive(Clone, Debug)]
pub struct LayerFilm {
    wanted: Vec<Layer>,
    window: Crop,
    first: u32,
    bands: Vec<Tile>,
    finished: Vec<bool>,
    finished_pixels: u64,
    /// Of each layer; empty until the first band comes.
    samples: Vec<Vec<f32>>,
}

impl LayerFilm {
    /// All layers of the picture that `options` ask for, all bands missing.
    ///
    /// # Errors
    /// Options that make no sense.
    pub fn new(options: &Options, wanted: &[Layer]) -> Result<Self, RenderError> {
        options.validate()?;
        let window = options.window();
        let first = tiles(options).len() as u32;
        let count = if wanted.is_empty() { 0 } else { window.height.div_ceil(BAND) };
        let band = |index: u32| {
            let y = window.y + index * BAND;
            let height = BAND.min(window.y + window.height - y);
            Tile { number: first + index, x: window.x, y, width: window.width, height }
        };
        Ok(Self {
            wanted: wanted.to_vec(),
            window,
            first,
            bands: (0..count).map(band).collect(),
            finished: vec![false; count as usize],
            finished_pixels: 0,
            samples: vec![Vec::new(); wanted.len()],
        })
    }

    /// The bands by number.
    pub fn bands(&self) -> &[Tile] {
        &self.bands
    }

    /// Numbers a pixel, all layers together.
    pub fn channels(&self) -> u32 {
        numbers_a_pixel(&self.wanted) as u32
    }

    fn index(&self, band: &Tile) -> Option<usize> {
        let index = band.number.checked_sub(self.first)? as usize;
        (self.bands.get(index) == Some(band)).then_some(index)
    }

    /// Takes a finished band; false where it is no band of these layers, or is there already.
    pub fn store(&mut self, pixels: &TilePixels) -> bool {
        let Some(index) = self.index(&pixels.tile) else { return false };
        let there = self.finished.get(index) != Some(&false);
        if there || pixels.channels != self.channels() || !pixels.is_whole() {
            return false;
        }
        let all = self.window.width as usize * self.window.height as usize;
        let from = (pixels.tile.y - self.window.y) as usize * self.window.width as usize;
        let mut before = 0;
        for (layer, samples) in self.wanted.iter().zip(&mut self.samples) {
            let count = layer.channels().len();
            samples.resize(all * count, 0.0);
            let places = samples.chunks_exact_mut(count).skip(from);
            for (place, pixel) in places.zip(pixels.samples.chunks_exact(pixels.channels as usize)) {
                place.copy_from_slice(&pixel[before..before + count]);
            }
            before += count;
        }
        self.finished[index] = true;
        self.finished_pixels += pixels.tile.pixels();
        true
    }

    /// The numbers of a band that is there.
    pub fn pixels(&self, band: &Tile) -> Option<TilePixels> {
        let index = self.index(band)?;
        if self.finished.get(index) != Some(&true) {
            return None;
        }
        let from = (band.y - self.window.y) as usize * self.window.width as usize;
        let mut samples = Vec::with_capacity(band.pixels() as usize * self.channels() as usize);
        for place in from..from + band.pixels() as usize {
            for (layer, all) in self.wanted.iter().zip(&self.samples) {
                let count = layer.channels().len();
                samples.extend_from_slice(&all[place * count..(place + 1) * count]);
            }
        }
        Some(TilePixels { tile: *band, channels: self.channels(), samples, counts: Stats::default() })
    }

    /// The bands that are not there yet, in order.
    pub fn missing(&self) -> Vec<Tile> {
        self.bands.iter().zip(&self.finished).filter(|(_, there)| !**there).map(|(band, _)| *band).collect()
    }

    /// Whether every band is there.
    pub fn is_complete(&self) -> bool {
        self.finished.iter().all(|there| *there)
    }

    /// How far it has come.
    pub fn progress(&self) -> Progress {
        let total_pixels = self.bands.iter().map(Tile::pixels).sum();
        Progress { finished_pixels: self.finished_pixels, total_pixels }
    }

    /// The layers, in the order in which they were asked for.
    pub fn into_pictures(self) -> Vec<LayerPicture> {
        let (width, height) = (self.window.width as usize, self.window.height as usize);
        let layers = self.wanted.into_iter().zip(self.samples);
        layers.map(|(layer, samples)| LayerPicture { layer, width, height, samples }).collect()
    }
}

/// Computes one band alone: its numbers depend on the world, the options, the layers and the band.
pub fn layer_band(world: &World, options: &Options, wanted: &[Layer], band: &Tile) -> TilePixels {
    let rows = Crop { x: band.x, y: band.y, width: band.width, height: band.height };
    let samples = samples_of(world, &options_of(wanted, options), wanted, rows);
    let channels = numbers_a_pixel(wanted) as u32;
    TilePixels { tile: *band, channels, samples, counts: Stats::default() }
}

/// Computes the bands that the layers lack, unless the observer cancels it; it is shown each.
///
/// # Errors
/// Threads that cannot be started.
pub fn develop_layers(
    world: &World,
    options: &Options,
    film: &Mutex<LayerFilm>,
    observer: &dyn Observer,
) -> Result<(), RenderError> {
    let missing = film.lock().unwrap_or_else(PoisonError::into_inner).missing();
    develop_bands(world, options, film, &missing, observer)
}

/// Computes these bands of the layers, unless the observer cancels it; it is shown each.
///
/// # Errors
/// Threads that cannot be started.
pub fn develop_bands(
    world: &World,
    options: &Options,
    film: &Mutex<LayerFilm>,
    bands: &[Tile],
    observer: &dyn Observer,
) -> Result<(), RenderError> {
    let lock = || film.lock().unwrap_or_else(PoisonError::into_inner);
    let wanted = lock().wanted.clone();
    let band = |tile: &Tile| {
        let pixels = layer_band(world, options, &wanted, tile);
        let progress = {
            let mut film = lock();
            film.store(&pixels);
            film.progress()
        };
        observer.tile_traced(&pixels);
        observer.tile_finished(&progress);
    };
    // One band a task, so that threads that have finished take over from others.
    let run = || bands.par_iter().with_max_len(1).filter(|_| !observer.cancelled()).for_each(band);
    on_threads(options.threads, run)
}

/// Computes layers of the window of the picture that `options` describe; `None` where the observer cancelled it.
///
/// # Errors
/// Options that make no sense; threads that cannot be started.
pub fn render_layers(
    world: &World,
    options: &Options,
    wanted: &[Layer],
    observer: &dyn Observer,
) -> Result<Option<Vec<LayerPicture>>, RenderError> {
    let film = Mutex::new(LayerFilm::new(options, wanted)?);
    develop_layers(world, options, &film, observer)?;
    let film = film.into_inner().unwrap_or_else(PoisonError::into_inner);
    Ok(film.is_complete().then(|| film.into_pictures()))
}

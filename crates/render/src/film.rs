//! What tiles are put together on.

use crate::error::RenderError;
use crate::observer::Progress;
use crate::options::Crop;
use crate::options::Options;
use crate::stats::Stats;
use crate::tile::Tile;
use crate::tile::TilePixels;
use crate::tile::tiles;
use dotray_image::Channels;
use dotray_image::Image;
use dotray_image::Limits;

/// A picture that is being put together of tiles.
#[derive(Clone, Debug)]
pub struct Film {
    image: Image,
    window: Crop,
    channels: u32,
    tiles: Vec<Tile>,
    finished: Vec<bool>,
    finished_pixels: u64,
    counts: Stats,
}

impl Film {
    /// Black, for the tiles of the picture that `options` ask for.
    ///
    /// # Errors
    /// Options that make no sense, a picture too large for memory.
    pub fn new(options: &Options) -> Result<Self, RenderError> {
        options.validate()?;
        let tiles = tiles(options);
        let window = options.window();
        let channels = if options.transparent { Channels::Rgba } else { Channels::Rgb };
        // Whoever allows so many pixels allows the memory for them.
        let limits = Limits { max_pixels: options.max_pixels, max_bytes: u64::MAX };
        let image = Image::new_within(window.width as usize, window.height as usize, channels, &limits)
            .map_err(|error| RenderError::Film {
                width: window.width,
                height: window.height,
                reason: error.to_string(),
            })?;
        let finished = vec![false; tiles.len()];
        let channels = if options.transparent { 4 } else { 3 };
        Ok(Self { image, window, channels, tiles, finished, finished_pixels: 0, counts: Stats::default() })
    }

    /// Takes a finished tile; false where it is no tile of this picture, or is there already.
    pub fn store(&mut self, pixels: &TilePixels) -> bool {
        let number = pixels.tile.number as usize;
        if self.finished.get(number) != Some(&false) || !self.put(pixels) {
            return false;
        }
        self.finished[number] = true;
        self.finished_pixels += pixels.tile.pixels();
        self.counts.add_counts(&pixels.counts);
        true
    }

    /// Shows a tile's pixels until its own come; false where it is no tile of this picture, or is finished.
    pub fn show(&mut self, pixels: &TilePixels) -> bool {
        self.finished.get(pixels.tile.number as usize) == Some(&false) && self.put(pixels)
    }

    fn put(&mut self, pixels: &TilePixels) -> bool {
        let tile = pixels.tile;
        let known = self.tiles.get(tile.number as usize) == Some(&tile);
        if !known || pixels.channels != self.channels || !pixels.is_whole() {
            return false;
        }
        let channels = self.channels as usize;
        let width = self.window.width as usize * channels;
        let samples = self.image.samples_mut();
        let left = (tile.x - self.window.x) as usize * channels;
        let top = (tile.y - self.window.y) as usize;
        for (row, line) in pixels.samples.chunks_exact(tile.width as usize * channels).enumerate() {
            let start = (top + row) * width + left;
            samples[start..start + line.len()].copy_from_slice(line);
        }
        true
    }

    /// Numbers a pixel: 3, or 4 with alpha.
    pub fn channels(&self) -> u32 {
        self.channels
    }

    /// All tiles by number.
    pub fn tiles(&self) -> &[Tile] {
        &self.tiles
    }

    /// The pixels of a tile that is there; what each tile cost is not kept, so its counts are 0.
    pub fn pixels(&self, tile: &Tile) -> Option<TilePixels> {
        if !self.has(tile) {
            return None;
        }
        let channels = self.channels as usize;
        let width = self.window.width as usize * channels;
        let left = (tile.x - self.window.x) as usize * channels;
        let mut samples = Vec::new();
        for row in tile.y - self.window.y..tile.y - self.window.y + tile.height {
            let start = row as usize * width + left;
            samples.extend_from_slice(&self.image.samples()[start..start + tile.width as usize * channels]);
        }
        Some(TilePixels { tile: *tile, channels: self.channels, samples, counts: Stats::default() })
    }

    /// The picture so far.
    pub fn image(&self) -> &Image {
        &self.image
    }

    /// The picture so far, taken out.
    pub fn into_image(self) -> Image {
        self.image
    }

    /// The rays and tests of the tiles that are there.
    pub fn counts(&self) -> &Stats {
        &self.counts
    }

    /// Whether a tile is there.
    pub fn has(&self, tile: &Tile) -> bool {
        self.finished.get(tile.number as usize) == Some(&true)
    }

    /// The tiles that are not there yet, in order.
    pub fn missing(&self) -> Vec<Tile> {
        self.tiles.iter().zip(&self.finished).filter(|(_, there)| !**there).map(|(tile, _)| *tile).collect()
    }

    /// Whether every tile is there.
    pub fn is_complete(&self) -> bool {
        self.finished.iter().all(|there| *there)
    }

    /// How far it has come.
    pub fn progress(&self) -> Progress {
        Progress {
            finished_pixels: self.finished_pixels,
            total_pixels: u64::from(self.window.width) * u64::from(self.window.height),
        }
    }
}

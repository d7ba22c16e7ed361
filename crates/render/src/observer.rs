//! Somebody who watches a picture being made and may stop it.

use crate::tile::TilePixels;

/// How far a picture has come.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Progress {
    /// Pixels that are finished.
    pub finished_pixels: u64,
    /// All pixels.
    pub total_pixels: u64,
}

/// Somebody who watches a picture being made and may stop it. Every method is called from any thread.
pub trait Observer: Sync {
    /// A tile is finished; these are its pixels. Called before [`Observer::tile_finished`] of the same tile.
    fn tile_traced(&self, pixels: &TilePixels) {
        let _ = pixels;
    }

    /// A tile was looked at coarsely: these pixels may be shown until its own come, and are no part of the picture.
    fn tile_previewed(&self, pixels: &TilePixels) {
        let _ = pixels;
    }

    /// A tile is finished, and so far the picture has come.
    fn tile_finished(&self, progress: &Progress) {
        let _ = progress;
    }

    /// Whether to stop; asked before each tile and, inside of it, between bounces and lights: often.
    fn cancelled(&self) -> bool {
        false
    }

    /// Whether it must be asked soon again, whatever the scene costs: then no more rays travel together than are traced
    /// in some milliseconds. The pixels are the same.
    fn is_impatient(&self) -> bool {
        false
    }
}

/// Nobody watches.
#[derive(Clone, Copy, Debug, Default)]
pub struct Silent;

impl Observer for Silent {}

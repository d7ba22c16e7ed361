//! All tiles of a picture: order, threads, progress, cancelling.

use crate::error::RenderError;
use crate::film::Film;
use crate::observer::Observer;
use crate::options::Options;
use crate::options::Order;
use crate::picture::Picture;
use crate::stats::MemoryPart;
use crate::stats::Stats;
use crate::threads::on_threads;
use crate::tile::Tile;
use crate::tile::TilePixels;
use crate::world::World;
use dotray_image::Image;
use rayon::prelude::*;
use std::sync::Mutex;
use std::sync::PoisonError;
use web_time::Instant;

/// A picture and what it cost.
#[derive(Debug)]
pub struct Rendering {
    /// The window's pixels, upper row first; where the work was cancelled before, black or what a coarse look gave.
    pub image: Image,
    /// Counts, bytes, seconds.
    pub stats: Stats,
    /// Whether every tile was computed.
    pub complete: bool,
}

/// Makes the picture.
///
/// # Errors
/// Options that make no sense, a picture too large for memory, threads that cannot be started.
pub fn render(world: &World, options: &Options, observer: &dyn Observer) -> Result<Rendering, RenderError> {
    let picture = Picture::new(world, options)?;
    render_missing(&picture, picture.film()?, observer)
}

/// Makes what a film lacks of its picture: so work that was interrupted goes on.
///
/// # Errors
/// Threads that cannot be started.
pub fn render_missing(
    picture: &Picture<'_>,
    film: Film,
    observer: &dyn Observer,
) -> Result<Rendering, RenderError> {
    let start = Instant::now();
    let film = Mutex::new(film);
    develop(picture, &film, observer)?;
    let film = film.into_inner().unwrap_or_else(PoisonError::into_inner);
    Ok(Rendering::of(picture, film, start))
}

impl Rendering {
    /// What a film holds, and what it cost since `start`.
    pub fn of(picture: &Picture<'_>, film: Film, start: Instant) -> Self {
        let complete = film.is_complete();
        let mut stats = film.counts().clone();
        let image = film.into_image();
        stats.memory = picture.world().memory();
        stats.memory.push(MemoryPart { name: "film", bytes: size_of_val(image.samples()) as u64 });
        stats.seconds = picture.world().seconds().to_vec();
        stats.seconds.push(("trace", start.elapsed().as_secs_f64()));
        Self { image, stats, complete }
    }
}

/// The edges of the squares of the looks before the picture itself, for [`Order::CoarseToFine`].
pub const COARSE_STEPS: [u32; 2] = [16, 4];

/// Computes the tiles that a film lacks, unless the observer cancels it; others may look at the film meanwhile.
///
/// # Errors
/// Threads that cannot be started.
pub fn develop(
    picture: &Picture<'_>,
    film: &Mutex<Film>,
    observer: &dyn Observer,
) -> Result<(), RenderError> {
    let missing = film.lock().unwrap_or_else(PoisonError::into_inner).missing();
    develop_part(picture, film, &missing, observer)
}

/// Computes these tiles, unless the observer cancels it.
///
/// # Errors
/// Threads that cannot be started.
pub fn develop_part(
    picture: &Picture<'_>,
    film: &Mutex<Film>,
    tiles: &[Tile],
    observer: &dyn Observer,
) -> Result<(), RenderError> {
    on_threads(picture.options().threads, || develop_here(picture, film, tiles, observer))
}

fn develop_here(picture: &Picture<'_>, film: &Mutex<Film>, tiles: &[Tile], observer: &dyn Observer) {
    let lock = || film.lock().unwrap_or_else(PoisonError::into_inner);
    // One tile a task, so that threads that have finished take over from others.
    let each = |work: &(dyn Fn(&Tile) + Sync)| {
        tiles.par_iter().with_max_len(1).filter(|_| !observer.cancelled()).for_each(work);
    };
    match picture.options().order {
        Order::Morton => {}
        Order::CoarseToFine => {
            for step in COARSE_STEPS {
                each(&|tile| {
                    let Some(pixels) = picture.preview(tile, step, observer) else { return };
                    lock().show(&pixels);
                    observer.tile_previewed(&pixels);
                });
            }
        }
    }
    each(&|tile| {
        let Some(pixels) = picture.tile(tile, observer) else { return };
        finish(film, &pixels, observer);
    });
}

fn finish(film: &Mutex<Film>, pixels: &TilePixels, observer: &dyn Observer) {
    let progress = {
        let mut film = film.lock().unwrap_or_else(PoisonError::into_inner);
        film.store(pixels);
        film.progress()
    };
    observer.tile_traced(pixels);
    observer.tile_finished(&progress);
}

//! Tracing a picture while its tiles are kept, its state is shown, and somebody may stop it.

use dotray::image::encode;
use dotray::render::Fingerprint;
use dotray::render::LayerFilm;
use dotray::render::LayerPicture;
use dotray::render::Observer;
use dotray::render::Picture;
use dotray::render::Progress;
use dotray::render::RenderError;
use dotray::render::Rendering;
use dotray::render::TilePixels;
use dotray::render::World;
use dotray::render::develop;
use dotray::render::develop_layers;
use dotray::render::progress::Extent;
use dotray::render::progress::SavedKind;
use std::sync::Condvar;
use std::sync::Mutex;
use std::sync::PoisonError;
use std::sync::atomic::AtomicBool;
use std::sync::atomic::Ordering;
use std::time::Duration;
use std::time::Instant;

use crate::args::quoted;
use crate::events;
use crate::exit::Failure;
use crate::exit::say;
use crate::extras::Extras;
use crate::interrupt;
use crate::keep::Films;
use crate::keep::Keep;
use crate::meaning::Place;
use crate::output;
use crate::plan::Plan;
use crate::progress::Watcher;

/// How often tiles are kept where nobody says it.
const EVERY: Duration = Duration::from_secs(10);

/// A picture with its layers, and the checkpoint to be removed once they are written.
pub struct Made {
    /// The picture.
    pub rendering: Rendering,
    /// Its layers, and the seconds that they took now.
    pub layers: (Vec<LayerPicture>, f64),
    /// Its checkpoint.
    pub keep: Option<Keep>,
}

/// Watches, keeps, stops.
struct Overseer<'a> {
    watcher: Watcher,
    keep: Option<&'a Keep>,
    deadline: Option<Instant>,
    late: AtomicBool,
    ended: Mutex<bool>,
    end: Condvar,
}

impl Observer for Overseer<'_> {
    fn tile_traced(&self, pixels: &TilePixels) {
        tracing::trace!(number = pixels.tile.number, rays = pixels.counts.rays(), "a tile is finished");
        if let Some(keep) = self.keep {
            keep.take(pixels);
        }
    }

    fn tile_finished(&self, progress: &Progress) {
        self.watcher.tile_finished(progress);
    }

    fn cancelled(&self) -> bool {
        if self.deadline.is_some_and(|deadline| Instant::now() >= deadline) {
            self.late.store(true, Ordering::Relaxed);
        }
        self.late.load(Ordering::Relaxed) || interrupt::pressed()
    }
}

/// What is made, for those who write it while it is not finished.
struct Work<'a> {
    picture: &'a Picture<'a>,
    world: &'a World,
    plan: &'a Plan,
    extras: &'a Extras,
    films: Films,
    keep: Option<Keep>,
    deadline: Option<Instant>,
}

impl Work<'_> {
    /// The share of the picture that is finished, and that of the picture and its layers; never 100 % before the end.
    fn percents(&self) -> (u64, u64) {
        let (picture, layers) = (self.films.picture().progress(), self.films.layers().progress());
        let percent = |finished: u64, total: u64| 100 * finished / total.max(1);
        let both =
            (picture.finished_pixels + layers.finished_pixels, picture.total_pixels + layers.total_pixels);
        (percent(picture.finished_pixels, picture.total_pixels), percent(both.0, both.1))
    }

    /// Writes the picture so far.
    fn write_partial(&self) -> Result<(), Failure> {
        let image = self.films.picture().image().clone();
        let image = self.extras.apply(image, self.world, self.plan)?;
        output::write(&self.plan.output, &encode(&image, self.plan.format, &self.plan.encode)?)?;
        tracing::debug!("wrote the picture so far");
        if let Place::File(path) = &self.plan.output {
            events::saved(SavedKind::Partial, path);
        }
        Ok(())
    }

    /// Makes one part of it, the picture or the layers, while it is watched and kept. Fails where it was stopped.
    fn part(
        &self,
        progress: &Progress,
        develop: impl FnOnce(&Overseer<'_>) -> Result<(), RenderError>,
    ) -> Result<(), Failure> {
        let long = &self.plan.long;
        let watcher = Watcher::new(progress.total_pixels, long.progress, self.plan.quiet);
        watcher.tile_finished(progress);
        let overseer = Overseer {
            watcher,
            keep: self.keep.as_ref(),
            deadline: self.deadline,
            late: AtomicBool::new(false),
            ended: Mutex::new(false),
            end: Condvar::new(),
        };
        let developed = std::thread::scope(|scope| {
            if overseer.keep.is_some() || long.partial_every.is_some() {
                scope.spawn(|| self.save_regularly(&overseer));
            }
            let developed = develop(&overseer);
            *overseer.ended.lock().unwrap_or_else(PoisonError::into_inner) = true;
            overseer.end.notify_all();
            developed
        });
        overseer.watcher.finish();
        developed?;
        if self.films.picture().is_complete() && self.films.layers().is_complete() {
            return Ok(());
        }
        let late = overseer.late.load(Ordering::Relaxed) && !interrupt::pressed();
        // The layers come after the picture, so a picture that is there was not stopped.
        if !late && !interrupt::pressed() { Ok(()) } else { Err(stopped(self, late)) }
    }

    /// Keeps what is finished; true where all of it is kept.
    fn save(&self) -> Option<bool> {
        self.keep.as_ref().map(|keep| keep.save(&self.films))
    }

    /// Keeps tiles and writes the picture so far, each at its times, until all tiles are there.
    fn save_regularly(&self, overseer: &Overseer<'_>) {
        let long = &self.plan.long;
        let every = overseer.keep.map(|_| long.every.map_or(EVERY, |span| span.0));
        let partial_every = long.partial_every.map(|span| span.0);
        let after = |period: Option<Duration>| period.map(|period| Instant::now() + period);
        let (mut next_keep, mut next_partial) = (after(every), after(partial_every));
        let mut told = false;
        let mut ended = overseer.ended.lock().unwrap_or_else(PoisonError::into_inner);
        while !*ended {
            let Some(next) = next_keep.into_iter().chain(next_partial).min() else { return };
            let wait = next.saturating_duration_since(Instant::now());
            ended = overseer.end.wait_timeout(ended, wait).unwrap_or_else(PoisonError::into_inner).0;
            let due = |next: Option<Instant>| next.is_some_and(|next| Instant::now() >= next);
            if *ended {
                return;
            }
            drop(ended);
            if due(next_keep) {
                self.save();
                next_keep = after(every);
            }
            if due(next_partial) {
                // Once is enough: the picture itself will be written, or not, at the end.
                if let Err(Failure::Failed(message)) = self.write_partial()
                    && !std::mem::replace(&mut told, true)
                {
                    say(&format!("warning: {message}; the picture goes on"));
                }
                next_partial = after(partial_every);
            }
            ended = overseer.ended.lock().unwrap_or_else(PoisonError::into_inner);
        }
    }
}

/// What programs are told of a picture, or of its layers: how large it is, and how much of it a checkpoint has brought.
fn extent(plan: &Plan, tiles: usize, progress: &Progress) -> impl FnOnce(f64) -> Extent + use<> {
    let window = plan.options.window();
    let Progress { finished_pixels, total_pixels } = *progress;
    move |seconds| Extent {
        seconds,
        width: window.width,
        height: window.height,
        tiles: tiles as u64,
        finished_pixels,
        total_pixels,
    }
}

/// Traces the picture and its layers until the deadline; with a fingerprint, their checkpoint is kept.
pub fn make(
    world: &World,
    plan: &Plan,
    extras: &Extras,
    fingerprint: Option<Fingerprint>,
    deadline: Option<Instant>,
) -> Result<Made, Failure> {
    let start = Instant::now();
    let picture = Picture::new(world, &plan.options)?;
    let layers = LayerFilm::new(&plan.options, &plan.layers)?;
    let films = Films { picture: Mutex::new(picture.film()?), layers: Mutex::new(layers) };
    let keep = match (&plan.long.checkpoint, fingerprint) {
        (Some(path), Some(fingerprint)) => Some(Keep::begin(path, plan.long.resume, fingerprint, &films)?),
        (Some(_) | None, _) => None,
    };
    let work = Work { picture: &picture, world, plan, extras, films, keep, deadline };
    let progress = work.films.picture().progress();
    events::picture(extent(plan, picture.tiles().len(), &progress));
    work.part(&progress, |overseer| develop(work.picture, &work.films.picture, overseer))?;
    let looking = Instant::now();
    if !plan.layers.is_empty() {
        let (bands, progress) = {
            let layers = work.films.layers();
            (layers.bands().len(), layers.progress())
        };
        events::layers(extent(plan, bands, &progress));
        work.part(&progress, |overseer| develop_layers(world, &plan.options, &work.films.layers, overseer))?;
    }
    let seconds = looking.elapsed().as_secs_f64();
    work.save();
    let Work { films: Films { picture: film, layers }, keep, .. } = work;
    let film = film.into_inner().unwrap_or_else(PoisonError::into_inner);
    let layers = layers.into_inner().unwrap_or_else(PoisonError::into_inner);
    let mut rendering = Rendering::of(&picture, film, start);
    if let Some((_, trace)) = rendering.stats.seconds.iter_mut().find(|(stage, _)| *stage == "trace") {
        *trace -= seconds;
    }
    Ok(Made { rendering, layers: (layers.into_pictures(), seconds), keep })
}

/// What is to be said and written of a picture that was stopped.
fn stopped(work: &Work<'_>, late: bool) -> Failure {
    let kept = work.save();
    let keep = work.keep.as_ref().filter(|_| kept == Some(true));
    let (percent, of_all) = work.percents();
    let mut kept = Vec::new();
    let long = &work.plan.long;
    if late && long.time_limit.is_some() || long.partial_every.is_some() {
        match (work.write_partial(), &work.plan.output) {
            (Ok(()), Place::File(path)) => {
                kept.push(format!("`{}` holds {percent} % of the picture", path.display()));
            }
            (Ok(()), Place::Standard) => kept.push(format!("{percent} % of the picture was written")),
            (Err(Failure::Failed(message)), _) => kept.push(message),
            (Err(_), _) => {}
        }
    }
    if let Some(keep) = keep {
        let path = keep.path().display();
        let what = if work.plan.layers.is_empty() { "the picture" } else { "the picture and its layers" };
        kept.push(format!("`{path}` keeps {of_all} % of {what}; go on with:\n  {}", again()));
    }
    let kept = (!kept.is_empty()).then(|| kept.join("; "));
    if late {
        return Failure::TimeLimit(kept.unwrap_or_else(|| "nothing was written".to_owned()));
    }
    Failure::Interrupted { signal: interrupt::signal().unwrap_or(2), kept }
}

/// The command line that goes on with the work.
pub fn again() -> String {
    let mut words: Vec<String> = std::env::args_os().map(|word| quoted(&word.to_string_lossy())).collect();
    if !words.iter().any(|word| word == "--resume") {
        words.push("--resume".to_owned());
    }
    words.join(" ")
}

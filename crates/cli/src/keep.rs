//! Checkpoints: finished tiles in a file while a picture is being made.

use dotray::render::Film;
use dotray::render::Fingerprint;
use dotray::render::LayerFilm;
use dotray::render::TileFile;
use dotray::render::TilePixels;
use dotray::render::progress::SavedKind;
use dotray::render::tile_file::Known;
use dotray::render::tile_file::fingerprint_of;
use std::fs;
use std::io;
use std::path::Path;
use std::path::PathBuf;
use std::sync::Mutex;
use std::sync::MutexGuard;
use std::sync::PoisonError;

use crate::events;
use crate::exit::Failure;
use crate::exit::say;

/// What the tiles of a picture and the bands of its layers are put together on.
pub struct Films {
    /// The picture.
    pub picture: Mutex<Film>,
    /// Its layers.
    pub layers: Mutex<LayerFilm>,
}

impl Films {
    /// The picture, for a moment.
    pub fn picture(&self) -> MutexGuard<'_, Film> {
        self.picture.lock().unwrap_or_else(PoisonError::into_inner)
    }

    /// The layers, for a moment.
    pub fn layers(&self) -> MutexGuard<'_, LayerFilm> {
        self.layers.lock().unwrap_or_else(PoisonError::into_inner)
    }

    /// Everything that is finished, as a file holds it.
    fn bytes(&self) -> Vec<u8> {
        let (picture, layers) = (self.picture(), self.layers());
        let tiles = picture.tiles().iter().filter_map(|tile| picture.pixels(tile));
        let bands = layers.bands().iter().filter_map(|band| layers.pixels(band));
        tiles.chain(bands).flat_map(|tile| tile.to_bytes()).collect()
    }
}

/// A checkpoint that is being written.
pub struct Keep {
    path: PathBuf,
    fingerprint: Fingerprint,
    state: Mutex<State>,
}

struct State {
    file: TileFile,
    /// Finished tiles that are not in the file yet.
    pending: Vec<u8>,
    /// Whether the last attempt failed, so that it is told once.
    failed: bool,
}

impl Keep {
    /// Begins a checkpoint, or goes on with one: then its tiles come into the films.
    pub fn begin(
        path: &Path,
        resume: bool,
        fingerprint: Fingerprint,
        films: &Films,
    ) -> Result<Self, Failure> {
        let file = match (fs::metadata(path), resume) {
            (Ok(metadata), _) if metadata.is_dir() => {
                return Err(Failure::file("keep a checkpoint in", path, &"it is a folder"));
            }
            (Ok(_), false) => {
                return Err(Failure::Failed(format!(
                    "the checkpoint `{}` is there already: --resume goes on with it; delete it to begin anew",
                    path.display()
                )));
            }
            (Ok(_), true) => load(path, &fingerprint, films)?,
            (Err(error), _) if error.kind() == io::ErrorKind::NotFound => {
                tracing::debug!("beginning the checkpoint {}", path.display());
                // The message names the file.
                TileFile::create(path, &fingerprint).map_err(|error| Failure::Failed(error.to_string()))?
            }
            (Err(error), _) => return Err(Failure::file("read", path, &error)),
        };
        let state = Mutex::new(State { file, pending: Vec::new(), failed: false });
        Ok(Self { path: path.to_owned(), fingerprint, state })
    }

    /// The file.
    pub fn path(&self) -> &Path {
        &self.path
    }

    fn state(&self) -> MutexGuard<'_, State> {
        self.state.lock().unwrap_or_else(PoisonError::into_inner)
    }

    /// A tile is finished.
    pub fn take(&self, pixels: &TilePixels) {
        self.state().pending.extend(pixels.to_bytes());
    }

    /// Adds what is finished to the file; where that fails, it is told, and tried again the next time. True where all
    /// is kept.
    pub fn save(&self, films: &Films) -> bool {
        let mut state = self.state();
        let there = fs::exists(&self.path).unwrap_or(true);
        if there && state.pending.is_empty() {
            return true;
        }
        let saved = if there {
            let pending = std::mem::take(&mut state.pending);
            let saved = state.file.append(&pending);
            if saved.is_err() {
                state.pending = pending;
            }
            saved
        } else {
            self.begin_again(&mut state, films)
        };
        match saved {
            Ok(()) => {
                state.failed = false;
                tracing::debug!("finished tiles are in {}", self.path.display());
                events::saved(SavedKind::Checkpoint, &self.path);
            }
            Err(error) => {
                if !state.failed {
                    say(&format!(
                        "warning: cannot add to the checkpoint `{}`: {error}; the picture goes on, and so do attempts",
                        self.path.display()
                    ));
                }
                state.failed = true;
            }
        }
        !state.failed
    }

    /// Somebody has taken the file away: everything that is finished goes into a new one.
    fn begin_again(&self, state: &mut State, films: &Films) -> io::Result<()> {
        let mut file = TileFile::create(&self.path, &self.fingerprint)?;
        let all = films.bytes();
        // Said before the file is there, lest nobody hears it who only waits for the file.
        say(&format!(
            "warning: the checkpoint `{}` had vanished; all that is finished goes into a new one",
            self.path.display()
        ));
        file.append(&all)?;
        state.pending.clear();
        state.file = file;
        Ok(())
    }

    /// The picture is written: the file has done its work.
    pub fn remove(self) {
        let Self { path, state, .. } = self;
        // Not every system removes an open file.
        drop(state);
        if let Err(error) = fs::remove_file(&path)
            && error.kind() != io::ErrorKind::NotFound
        {
            say(&format!("warning: cannot remove the checkpoint `{}`: {error}", path.display()));
        }
    }
}

fn load(path: &Path, fingerprint: &Fingerprint, films: &Films) -> Result<TileFile, Failure> {
    let fault = |error: io::Error| Failure::file("go on with", path, &error);
    let name = path.display();
    let Some(there) = fingerprint_of(path).map_err(fault)? else {
        return Err(Failure::Failed(format!(
            "`{name}` is no checkpoint, or nothing in it is whole; delete it to begin anew"
        )));
    };
    let differences = there.differences(fingerprint, "there", "now");
    if !differences.is_empty() {
        let list = differences.join("; ");
        return Err(Failure::Failed(format!(
            "the checkpoint `{name}` belongs to another picture ({list}); \
             go on with what it was begun with, or delete it to begin anew"
        )));
    }
    let mut file = TileFile::open(path, fingerprint).map_err(fault)?;
    let (mut picture, mut layers) = (films.picture(), films.layers());
    let (tiles, bands) = (picture.tiles().to_vec(), layers.bands().to_vec());
    let known = [
        Known { tiles: &tiles, channels: picture.channels() },
        Known { tiles: &bands, channels: layers.channels() },
    ];
    let contents = file
        .read(&known, |pixels| {
            let _known = picture.store(&pixels) || layers.store(&pixels);
        })
        .map_err(fault)?;
    if contents.lost_bytes > 0 {
        let lost = contents.lost_bytes;
        say(&format!(
            "warning: {lost} bytes of the checkpoint `{name}` are damaged; only their tiles are made again"
        ));
    }
    let progress = picture.progress();
    tracing::debug!("{} of {} pixels are in {name}", progress.finished_pixels, progress.total_pixels);
    Ok(file)
}

//! Noticing that the scene's files have changed.

use crate::link::Wake;
use notify::Event;
use notify::RecursiveMode;
use notify::Watcher;
use std::collections::BTreeSet;
use std::path::Path;
use std::path::PathBuf;
use std::sync::mpsc;
use std::time::Duration;
use std::time::Instant;

/// Programs write a file in several steps; nothing is read before it has been still for so long.
const STILL: Duration = Duration::from_millis(120);

/// Watches the folders of some files: a file that is written anew by renaming is another file to the system.
pub struct Watch {
    events: mpsc::Receiver<notify::Result<Event>>,
    /// Dropping it ends the watching.
    _watcher: notify::RecommendedWatcher,
    files: BTreeSet<PathBuf>,
    changed: Option<Instant>,
}

impl Watch {
    /// Watches these files; `None` where the system cannot.
    pub fn new<'a>(files: impl IntoIterator<Item = &'a Path>, wake: Wake) -> Option<Self> {
        let (sender, events) = mpsc::channel();
        let handler = move |event| {
            let _ = sender.send(event);
            wake();
        };
        let mut watcher = notify::recommended_watcher(handler).ok()?;
        let files: BTreeSet<PathBuf> =
            files.into_iter().filter_map(|path| std::path::absolute(path).ok()).collect();
        let folders: BTreeSet<&Path> = files.iter().filter_map(|path| path.parent()).collect();
        for folder in folders {
            watcher.watch(folder, RecursiveMode::NonRecursive).ok()?;
        }
        Some(Self { events, _watcher: watcher, files, changed: None })
    }

    /// Whether a file has changed and been still since.
    ///
    /// # Errors
    /// How long to wait before asking again, where a file has changed a moment ago.
    pub fn changed(&mut self) -> Result<bool, Duration> {
        let of_interest = |event: &Event| {
            let writes = !matches!(event.kind, notify::EventKind::Access(_));
            writes && event.paths.iter().any(|path| self.files.contains(path))
        };
        if self.events.try_iter().flatten().filter(of_interest).count() > 0 {
            self.changed = Some(Instant::now());
        }
        let Some(changed) = self.changed else { return Ok(false) };
        let still = changed.elapsed();
        if still < STILL {
            return Err(STILL - still);
        }
        self.changed = None;
        Ok(true)
    }
}

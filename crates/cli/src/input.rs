//! From a file or standard input to a scene, with its messages printed and its time taken.

use dotray::scene::Diagnostic;
use dotray::scene::Files;
use dotray::scene::Resolved;
use dotray::scene::Scene;
use dotray::scene::files::is_outside;
use dotray::scene::load::Loaded;
use dotray::scene::load::load;
use dotray::scene::load::load_text;
use dotray::scene::resolve::resolve_within;
use dotray::scene::sources::Sources;
use dotray::scene::span::FileId;
use std::io;
use std::io::Read;
use std::path::Path;
use std::path::PathBuf;
use std::sync::atomic::AtomicU64;
use std::sync::atomic::Ordering;
use std::time::Instant;

use crate::exit::Failure;
use crate::exit::say;
use crate::limits::load_options;
use crate::limits::reachable;
use crate::limits::resolve_limits;
use crate::meaning::Place;
use crate::messages::Messages;
use crate::reading_args::LimitArgs;
use crate::reading_args::ReadingArgs;

/// The disk, or a folder of it, with a clock: what reading took.
pub struct TimedDisk {
    nanoseconds: AtomicU64,
    disk: Box<dyn Files + Send>,
}

impl TimedDisk {
    /// The whole disk, or what `--confine` leaves of it.
    pub fn new(limits: &LimitArgs) -> Result<Self, Failure> {
        Ok(Self { nanoseconds: AtomicU64::new(0), disk: reachable(limits)? })
    }

    /// Seconds spent reading so far.
    pub fn seconds(&self) -> f64 {
        self.nanoseconds.load(Ordering::Relaxed) as f64 * 1e-9
    }

    fn timed<T>(&self, read: impl FnOnce() -> io::Result<T>) -> io::Result<T> {
        let start = Instant::now();
        let result = read();
        let spent = u64::try_from(start.elapsed().as_nanos()).unwrap_or(u64::MAX);
        self.nanoseconds.fetch_add(spent, Ordering::Relaxed);
        result
    }
}

/// Stands for a texture whose file is nowhere: no file can have this name.
const WHITE: &str = "\0white.ppm";

impl Files for TimedDisk {
    fn read(&self, path: &Path) -> io::Result<Vec<u8>> {
        self.timed(|| self.disk.read(path))
    }

    fn read_at_most(&self, path: &Path, limit: u64) -> io::Result<Vec<u8>> {
        if path == Path::new(WHITE) {
            return Ok(b"P6 1 1 255\n\xff\xff\xff".to_vec());
        }
        self.timed(|| self.disk.read_at_most(path, limit))
    }

    fn read_asked_for(&self, path: &Path, limit: u64) -> io::Result<Vec<u8>> {
        self.timed(|| self.disk.read_asked_for(path, limit))
    }

    fn identity(&self, path: &Path) -> PathBuf {
        self.disk.identity(path)
    }

    fn names_in(&self, folder: &Path) -> Vec<String> {
        self.disk.names_in(folder)
    }
}

/// A scene as written, its text, and what it took.
pub struct Written {
    /// The scene.
    pub scene: Scene,
    /// Warnings, not yet printed.
    pub warnings: Vec<Diagnostic>,
    /// The text, for messages.
    pub sources: Sources,
    /// The disk, for textures.
    pub disk: TimedDisk,
    /// Seconds by stage.
    pub seconds: Vec<(&'static str, f64)>,
}

impl Written {
    /// Bytes of text.
    pub fn text_bytes(&self) -> u64 {
        let files = u32::try_from(self.sources.len()).unwrap_or(u32::MAX);
        (0..files).map(|number| self.sources.bytes(FileId(number)).len() as u64).sum()
    }
}

/// Reads a scene. Where it has errors, prints all messages and stops.
pub fn read(place: &Place, reading: &ReadingArgs, messages: Messages) -> Result<Written, Failure> {
    let disk = TimedDisk::new(&reading.limits)?;
    let start = Instant::now();
    let options = load_options(reading);
    let loaded = match place {
        Place::File(path) => load(path, &disk, &options),
        Place::Standard => {
            let text = disk
                .timed(|| standard_input(options.limits.max_file_bytes))
                .map_err(|error| Failure::Failed(format!("cannot read standard input: {error}")))?;
            load_text("<stdin>", text, &disk, &options)
        }
    };
    let read = disk.seconds();
    let parsing = (start.elapsed().as_secs_f64() - read).max(0.0);
    let Loaded { scene, diagnostics, sources, dialect, because, .. } = loaded;
    if let Some(because) = because.filter(|_| !messages.quiet) {
        say(&format!("note: read in the dialect `{dialect}`: {because} (`--dialect NAME` says otherwise)"));
    }
    match scene {
        Some(scene) => {
            let seconds = vec![("read", read), ("parse", parsing)];
            Ok(Written { scene, warnings: diagnostics, sources, disk, seconds })
        }
        None => {
            messages.print(&diagnostics, &sources);
            Err(Failure::Reported)
        }
    }
}

/// The whole of standard input, if it has at most `limit` bytes.
pub fn standard_input(limit: u64) -> io::Result<Vec<u8>> {
    let mut text = Vec::new();
    let read = io::stdin().lock().take(limit.saturating_add(1)).read_to_end(&mut text)?;
    if read as u64 > limit { Err(io::Error::other(format!("more than {limit} bytes"))) } else { Ok(text) }
}

/// A scene with nothing left to guess, its text, and what it took.
pub struct Understood {
    /// The scene.
    pub resolved: Resolved,
    /// The text, for messages.
    pub sources: Sources,
    /// The disk, for textures.
    pub disk: TimedDisk,
    /// Bytes of text.
    pub text_bytes: u64,
    /// Seconds by stage.
    pub seconds: Vec<(&'static str, f64)>,
}

/// Reads and resolves a scene and prints all messages; stops where there is an error.
pub fn understand(place: &Place, reading: &ReadingArgs, messages: Messages) -> Result<Understood, Failure> {
    let read = read(place, reading, messages)?;
    let text_bytes = read.text_bytes();
    let Written { scene, warnings, sources, disk, mut seconds } = read;
    let start = Instant::now();
    let outcome = resolve_within(scene, &resolve_limits(&reading.limits));
    seconds.push(("resolve", start.elapsed().as_secs_f64()));
    let mut diagnostics = warnings;
    diagnostics.extend(outcome.diagnostics);
    messages.print(&diagnostics, &sources);
    let resolved = outcome.resolved.ok_or(Failure::Reported)?;
    Ok(Understood { resolved, sources, disk, text_bytes, seconds })
}

/// Puts white in the place of textures whose files are nowhere, and says which.
pub fn whiten(resolved: &mut Resolved, disk: &TimedDisk, quiet: bool) {
    for texture in &mut resolved.textures {
        let is_there = |path: &PathBuf| {
            let missing = |fault: &io::Error| fault.kind() == io::ErrorKind::NotFound || is_outside(fault);
            !disk.read_at_most(path, 0).is_err_and(|fault| missing(&fault))
        };
        if texture.candidates.iter().any(is_there) {
            continue;
        }
        texture.candidates = vec![PathBuf::from(WHITE)];
        if !quiet {
            say(&format!("warning: the texture `{}` was not found; white takes its place", texture.name));
        }
    }
}

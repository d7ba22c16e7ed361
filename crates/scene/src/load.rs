//! A file and all that it includes, to one scene.

#![deny(clippy::indexing_slicing, clippy::unwrap_used, clippy::expect_used)]

use crate::detect::Marks;
use crate::detect::Verdict;
use crate::diagnostic::Diagnostic;
use crate::diagnostic::Severity;
use crate::diagnostic::Sink;
use crate::dialect::Dialect;
use crate::files::Files;
use crate::files::is_outside;
use crate::model::Scene;
use crate::model::SceneFile;
use crate::parse;
use crate::parse::NOT_LOADED;
use crate::similar::similar_file;
use crate::sources::Sources;
use crate::span::FileId;
use crate::span::Span;
#[cfg(feature = "compressed")]
use crate::unpack;
use std::collections::HashMap;
use std::io;
use std::path::Path;
use std::path::PathBuf;

pub use crate::parse::Limits;

/// What the caller may choose.
#[derive(Clone, Debug, Default)]
pub struct LoadOptions {
    /// Bounds on what a file may make the reader do.
    pub limits: Limits,
    /// Where included files are looked for that do not stand beside the file that names them; `None` is the
    /// process's own working directory.
    pub working_directory: Option<PathBuf>,
    /// The dialect; `None` finds out from the file and its includes.
    pub dialect: Option<Dialect>,
}

/// What reading gives.
#[derive(Debug)]
pub struct Loaded {
    /// The scene; `None` where there was any error.
    pub scene: Option<Scene>,
    /// Errors and warnings in the order of files and places.
    pub diagnostics: Vec<Diagnostic>,
    /// The text that the diagnostics point into.
    pub sources: Sources,
    /// The dialect that the files were read in.
    pub dialect: Dialect,
    /// What spoke for that dialect, where it was found out and is not the slides' own.
    pub because: Option<String>,
}

/// Reads the file at `path` and all that it includes. Everything that is wrong, be it that the file cannot be read,
/// is told in the diagnostics.
pub fn load(path: &Path, files: &dyn Files, options: &LoadOptions) -> Loaded {
    let limit = options.limits.max_file_bytes;
    match files.read_asked_for(path, limit).and_then(|bytes| unpacked(bytes, limit)) {
        Ok(bytes) => load_bytes(path.to_owned(), bytes, files, options),
        Err(fault) => not_loaded(path, &fault, files, options),
    }
}

/// What there is to say where the file asked for cannot be read.
fn not_loaded(path: &Path, fault: &io::Error, files: &dyn Files, options: &LoadOptions) -> Loaded {
    let mut loader = Loader::new(files, options, options.dialect.unwrap_or_default());
    loader.cannot_read(path, fault);
    loader.finish()
}

/// A scene's text, which may be compressed.
#[cfg(feature = "compressed")]
fn unpacked(bytes: Vec<u8>, limit: u64) -> io::Result<Vec<u8>> {
    unpack::unpacked(bytes, limit)
}

/// A scene's text; what is compressed is told as binary data.
#[cfg(not(feature = "compressed"))]
fn unpacked(bytes: Vec<u8>, _: u64) -> io::Result<Vec<u8>> {
    Ok(bytes)
}

/// Reads as slides first, so that a slides file is never taken for another and costs no second look. Only a file that
/// is faulty as such may be of another dialect.
fn load_bytes(path: PathBuf, bytes: Vec<u8>, files: &dyn Files, options: &LoadOptions) -> Loaded {
    let mut loader = Loader::new(files, options, options.dialect.unwrap_or_default());
    loader.run(path.clone(), bytes);
    if options.dialect.is_some() || loader.sink.errors() == 0 {
        return loader.finish();
    }
    let Verdict { dialect, because, doubt } = loader.verdict();
    if let Some(doubt) = doubt.as_ref().filter(|doubt| doubt.severity == Severity::Error) {
        // Whatever else there is to say depends on the dialect.
        loader.sink = Sink::new(options.limits.max_errors, options.limits.max_warnings_of_a_kind);
        loader.sink.error(doubt.clone());
        return loader.finish();
    }
    let because = because.map(|(span, what)| format!("{what} at {}", loader.sources.place(span)));
    if dialect != Dialect::Slides {
        let bytes = loader.sources.take_bytes(FileId(0));
        loader = Loader::new(files, options, dialect);
        loader.run(path, bytes);
        loader.because = because;
    }
    // The doubt may point into files that this reading has not reached.
    let known = u32::try_from(loader.sources.len()).unwrap_or(u32::MAX);
    if let Some(mut doubt) = doubt {
        doubt.notes.retain(|(span, _)| span.is_none_or(|span| span.file.0 < known));
        loader.sink.warn(doubt.code, || doubt);
    }
    loader.finish()
}

/// Reads a scene from memory; `name` stands for the path of its file. Included files are read by `files`.
///
/// ```
/// use dotray_scene::files::Disk;
/// use dotray_scene::load::{LoadOptions, load_text};
///
/// let loaded = load_text("ball.ray", "#shape_sphere -1  0 0 0  1", &Disk, &LoadOptions::default());
/// let scene = loaded.scene.expect("the text has no errors");
/// assert_eq!(scene.files[0].spheres.shapes.len(), 1);
/// ```
pub fn load_text(name: &str, text: impl Into<Vec<u8>>, files: &dyn Files, options: &LoadOptions) -> Loaded {
    match unpacked(text.into(), options.limits.max_file_bytes) {
        Ok(bytes) => load_bytes(PathBuf::from(name), bytes, files, options),
        Err(fault) => not_loaded(Path::new(name), &fault, files, options),
    }
}

/// How a file came to be read.
struct Reached {
    /// The `#ray_file` that named it first; `None` for the file asked for.
    by: Option<Span>,
    depth: usize,
}

struct Loader<'a> {
    files: &'a dyn Files,
    options: &'a LoadOptions,
    dialect: Dialect,
    because: Option<String>,
    sink: Sink,
    sources: Sources,
    scene: Scene,
    reached: Vec<Reached>,
    /// The numbers of the files by their identities.
    known: HashMap<PathBuf, FileId>,
}

impl<'a> Loader<'a> {
    fn new(files: &'a dyn Files, options: &'a LoadOptions, dialect: Dialect) -> Self {
        let Limits { max_errors, max_warnings_of_a_kind, .. } = options.limits;
        Self {
            files,
            options,
            dialect,
            because: None,
            sink: Sink::new(max_errors, max_warnings_of_a_kind),
            sources: Sources::default(),
            scene: Scene::default(),
            reached: Vec::new(),
            known: HashMap::new(),
        }
    }

    /// Reads the file asked for, then, one after the other, those that come to be known.
    fn run(&mut self, path: PathBuf, bytes: Vec<u8>) {
        self.take(path, bytes, Reached { by: None, depth: 0 });
        let mut next = 0;
        while next < self.reached.len() && !self.sink.is_full() {
            let file = FileId(next as u32);
            let path = self.sources.path(file).to_owned();
            let limits = &self.options.limits;
            let parsed =
                parse::parse(path, self.sources.bytes(file), file, self.dialect, limits, &mut self.sink);
            self.scene.files.push(parsed);
            self.find_includes(next);
            next += 1;
        }
        self.refuse_cycles();
    }

    /// Which dialect the file asked for is written in: by itself where it has any mark, else by what it includes.
    fn verdict(&self) -> Verdict {
        let mut marks = Marks::default();
        let mut names: Vec<(PathBuf, String)> = Vec::new();
        let main = self.sources.path(FileId(0)).to_owned();
        let found = marks.scan(&main, self.sources.bytes(FileId(0)), FileId(0));
        names.extend(found.into_iter().map(|name| (main.clone(), name)));
        let mut seen: Vec<PathBuf> = vec![self.files.identity(&main)];
        let mut next = 0;
        while marks.is_empty() && next < names.len() && next < self.options.limits.max_includes {
            let Some((from, name)) = names.get(next).cloned() else { break };
            next += 1;
            for path in self.candidates(&from, &name, true) {
                let identity = self.files.identity(&path);
                if seen.contains(&identity) {
                    break;
                }
                let Ok(bytes) = self.read(&path) else {
                    continue;
                };
                seen.push(identity);
                // A file that no reading has numbered yet has no place that a message could show.
                let found = marks.scan(&path, &bytes, FileId(u32::MAX));
                names.extend(found.into_iter().map(|name| (path.clone(), name)));
                break;
            }
        }
        let mut verdict = marks.verdict();
        if let Some((span, _)) = &verdict.because
            && span.file.0 == u32::MAX
        {
            verdict.because = verdict.because.map(|(_, what)| (Span::new(FileId(0), 0, 0), what));
        }
        verdict
    }

    fn take(&mut self, path: PathBuf, bytes: Vec<u8>, reached: Reached) -> FileId {
        let identity = self.files.identity(&path);
        let file = self.sources.add(path, bytes);
        self.known.insert(identity, file);
        self.reached.push(reached);
        file
    }

    /// Where an included file may be: beside the file that names it, else in the working directory; for the sake of
    /// courses whose programs ran in another folder than that of their scenes, else under its bare name beside the file
    /// that names it, or in the folders above.
    fn candidates(&self, from: &Path, name: &str, above: bool) -> Vec<PathBuf> {
        const ABOVE: usize = 3;
        // Through its components a path loses `./`.
        let name = if above { name.replace('\\', "/") } else { name.to_owned() };
        let within = |folder: &Path| folder.join(&name).components().collect::<PathBuf>();
        let beside = within(from.parent().unwrap_or(Path::new("")));
        let working = within(self.options.working_directory.as_deref().unwrap_or(Path::new("")));
        let mut all = if beside == working { vec![beside] } else { vec![beside, working] };
        if above {
            let bare = Path::new(&name).file_name().unwrap_or_default();
            all.push(from.parent().unwrap_or(Path::new("")).join(bare));
            // The folders of the whole path, for a relative one may end too soon.
            let whole = self.files.identity(from);
            all.extend(whole.ancestors().skip(2).take(ABOVE).map(within));
        }
        all
    }

    fn find_includes(&mut self, of: usize) {
        let count = self.scene.files.get(of).map_or(0, |file| file.includes.len());
        for number in 0..count {
            let Some(include) = self.scene.files.get(of).and_then(|file| file.includes.get(number)) else {
                return;
            };
            let (name, span) = (include.value.name.clone(), include.span);
            let found = self.find_include(&name, span);
            let include = self.scene.files.get_mut(of).and_then(|file| file.includes.get_mut(number));
            if let (Some(include), Some(found)) = (include, found) {
                include.value.file = found;
            }
            if self.sink.is_full() {
                return;
            }
        }
    }

    fn find_include(&mut self, name: &str, span: Span) -> Option<FileId> {
        let candidates =
            self.candidates(self.sources.path(span.file), name, self.dialect.conventions().lenient);
        let usual = self.candidates(self.sources.path(span.file), name, false).len();
        let depth = self.reached.get(span.file.0 as usize).map_or(0, |reached| reached.depth) + 1;
        let Limits { max_include_depth, max_includes, .. } = self.options.limits;
        let mut tried = Vec::new();
        for path in candidates {
            if let Some(known) = self.known.get(&self.files.identity(&path)) {
                return Some(*known);
            }
            if depth > max_include_depth || self.reached.len() >= max_includes {
                let (message, option) = match depth > max_include_depth {
                    true => {
                        let message = format!("files include each other more than {max_include_depth} deep");
                        (message, "--max-include-depth")
                    }
                    false => (format!("the scene has more than {max_includes} files"), "--max-includes"),
                };
                let error = Diagnostic::error("include-limit", message).at(span).label("is not read");
                self.sink.error(error.help(format!("`{option} N` allows more")));
                return None;
            }
            match self.read(&path) {
                Ok(bytes) => {
                    if tried.len() >= usual {
                        self.found_elsewhere(name, &path, span);
                    }
                    return Some(self.take(path, bytes, Reached { by: Some(span), depth }));
                }
                Err(fault) => tried.push((path, fault)),
            }
        }
        // That the further places lie outside is no news.
        let is_news =
            |(number, (_, fault)): &(usize, (PathBuf, io::Error))| *number == 0 || !is_outside(fault);
        let tried: Vec<_> = tried.into_iter().enumerate().filter(is_news).map(|(_, tried)| tried).collect();
        self.sink.error(self.not_found(name, span, &tried));
        None
    }

    fn read(&self, path: &Path) -> io::Result<Vec<u8>> {
        let limit = self.options.limits.max_file_bytes;
        self.files.read_at_most(path, limit).and_then(|bytes| unpacked(bytes, limit))
    }

    fn found_elsewhere(&mut self, name: &str, path: &Path, span: Span) {
        self.sink.warn("include-elsewhere", || {
            let message = format!("`{name}` was found as `{}`", path.display());
            let warning = Diagnostic::warning("include-elsewhere", message).at(span);
            warning.label("neither beside this file nor in the working directory")
        });
    }

    fn not_found(&self, name: &str, span: Span, tried: &[(PathBuf, io::Error)]) -> Diagnostic {
        let is_missing = |fault: &io::Error| fault.kind() == io::ErrorKind::NotFound;
        let too_large = tried.iter().find(|(_, fault)| fault.kind() == io::ErrorKind::FileTooLarge);
        if let Some((path, _)) = too_large {
            return too_large_error(path, &self.options.limits).at(span).label("is not read");
        }
        let error = match tried.iter().find(|(_, fault)| !is_missing(fault)) {
            Some((path, fault)) => {
                Diagnostic::error("cannot-read", format!("cannot read `{}`: {fault}", path.display()))
            }
            None => {
                Diagnostic::error("include-not-found", format!("the included file `{name}` was not found"))
            }
        };
        let error = error.at(span).label("named here");
        let error =
            tried.iter().fold(error, |error, (path, _)| error.note(format!("tried `{}`", path.display())));
        match tried
            .iter()
            .filter(|(_, fault)| is_missing(fault))
            .find_map(|(path, _)| similar_file(self.files, path))
        {
            Some(similar) => error.help(format!("there is a file `{similar}`")),
            None => error,
        }
    }

    fn cannot_read(&mut self, path: &Path, fault: &io::Error) {
        if fault.kind() == io::ErrorKind::FileTooLarge {
            return self.sink.error(too_large_error(path, &self.options.limits));
        }
        let error = Diagnostic::error("cannot-read", format!("cannot read `{}`: {fault}", path.display()));
        self.sink.error(
            match similar_file(self.files, path).filter(|_| fault.kind() == io::ErrorKind::NotFound) {
                Some(similar) => error.help(format!("there is a file `{similar}`")),
                None => error,
            },
        );
    }

    /// Walks the files' includes depth first, without a stack of calls.
    fn refuse_cycles(&mut self) {
        let mut state = vec![State::Fresh; self.scene.files.len()];
        for root in 0..state.len() {
            if state.get(root) != Some(&State::Fresh) {
                continue;
            }
            // The files on the way and which of their includes comes next.
            let mut way: Vec<(usize, usize)> = vec![(root, 0)];
            while let Some((file, next)) = way.last_mut() {
                let (from, number) = (*file, *next);
                *next += 1;
                set(&mut state, from, State::OnTheWay);
                let include = self.scene.files.get(from).and_then(|file| file.includes.get(number));
                let Some(include) = include else {
                    set(&mut state, from, State::Done);
                    way.pop();
                    continue;
                };
                let (to, span) = (include.value.file.0 as usize, include.span);
                match state.get(to) {
                    Some(State::Fresh) => way.push((to, 0)),
                    Some(State::OnTheWay) => {
                        let error = self.cycle(&way, to, span);
                        self.sink.error(error);
                    }
                    Some(State::Done) | None => {}
                }
            }
        }
    }

    fn cycle(&self, way: &[(usize, usize)], to: usize, span: Span) -> Diagnostic {
        const SHOWN: usize = 8;
        let path = |file: usize| format!("`{}`", self.sources.path(FileId(file as u32)).display());
        let ring = way.iter().map(|(file, _)| *file).skip_while(|&file| file != to).chain([to]);
        let mut chain: Vec<String> = ring.map(path).collect();
        if chain.len() > SHOWN {
            let end = chain.split_off(chain.len() - SHOWN / 2);
            chain.truncate(SHOWN / 2);
            chain.push("…".to_owned());
            chain.extend(end);
        }
        Diagnostic::error("include-cycle", format!("{} includes itself", path(to)))
            .at(span)
            .label("closes the circle")
            .note(format!("the chain is {}", chain.join(" → ")))
    }

    fn finish(mut self) -> Loaded {
        let failed = self.sink.errors() > 0;
        let mut diagnostics = self.sink.finish();
        for diagnostic in &mut diagnostics {
            let mut file = diagnostic.span.map_or(FileId(0), |span| span.file);
            // Long chains are of no use to a reader.
            for _ in 0..8 {
                let Some(by) = self.reached.get(file.0 as usize).and_then(|reached| reached.by) else {
                    break;
                };
                diagnostic.notes.push((None, format!("included from {}", self.sources.place(by))));
                file = by.file;
            }
        }
        debug_assert_eq!(failed, diagnostics.iter().any(|diagnostic| diagnostic.severity == Severity::Error));
        debug_assert!(failed || self.scene.files.iter().all(is_complete));
        self.scene.files.iter_mut().for_each(shrink);
        let Self { dialect, because, sources, .. } = self;
        Loaded { scene: (!failed).then_some(self.scene), diagnostics, sources, dialect, because }
    }
}

#[derive(Clone, Copy, PartialEq, Eq)]
enum State {
    Fresh,
    OnTheWay,
    Done,
}

fn set(state: &mut [State], file: usize, new: State) {
    if let Some(state) = state.get_mut(file) {
        *state = new;
    }
}

fn is_complete(file: &SceneFile) -> bool {
    file.includes.iter().all(|include| include.value.file != NOT_LOADED)
}

/// Lists grow by doubling; what is not used goes back.
fn shrink(file: &mut SceneFile) {
    file.vertices.shrink_to_fit();
    file.vertex_colors.shrink_to_fit();
    file.items.shrink_to_fit();
}

fn too_large_error(path: &Path, limits: &Limits) -> Diagnostic {
    let message = format!("`{}` is larger than {} bytes", path.display(), limits.max_file_bytes);
    Diagnostic::error("file-too-large", message).help("`--max-file-size BYTES` allows more")
}

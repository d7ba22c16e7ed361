//! Scenes on the disk.

use crate::document::Document;
use crate::link::Source;
use crate::link::Wake;
use crate::state::State;
use crate::watch::Watch;
use dotray_scene::files::Disk;
use dotray_scene::span::FileId;
use eframe::egui;
use std::path::Path;
use std::path::PathBuf;
use std::sync::Arc;

/// Whether files can be picked from a list.
pub const CAN_PICK: bool = false;

/// See the module.
pub struct Inbox {
    wake: Wake,
    watch: Option<Watch>,
}

impl Inbox {
    /// Nothing has come yet.
    pub fn new(wake: Wake) -> Self {
        Self { wake, watch: None }
    }

    /// A scene that was named at the start.
    pub fn open(&mut self, path: PathBuf, state: &mut State) {
        state.open(Source { path, files: Arc::new(Disk) });
        self.watch = None;
    }

    /// Takes what has come since the last time.
    pub fn look(&mut self, ctx: &egui::Context, state: &mut State) {
        let dropped = ctx.input(|input| input.raw.dropped_files.clone());
        if let Some(path) = dropped.first().map(|file| file.path().to_path_buf()) {
            self.open(path, state);
        }
        self.follow(ctx, state);
    }

    /// Reads the scene again when its files change.
    fn follow(&mut self, ctx: &egui::Context, state: &mut State) {
        let Some(source) = &state.source else { return };
        if self.watch.is_none() {
            self.watch = Watch::new([source.path.as_path()], self.wake.clone());
        }
        match self.watch.as_mut().map(Watch::changed) {
            Some(Ok(true)) => state.changed_outside(),
            Some(Err(wait)) => ctx.request_repaint_after(wait),
            Some(Ok(false)) | None => {}
        }
    }

    /// Watches what the scene turned out to be made of.
    pub fn opened(&mut self, document: &Document) {
        let sources = (0..document.sources.len() as u32).map(FileId);
        let textures = document.style.textures.iter().flat_map(|texture| &texture.candidates);
        let paths: Vec<&Path> = sources
            .map(|file| document.sources.path(file))
            .chain(textures.map(PathBuf::as_path).filter(|path| path.is_file()))
            .collect();
        self.watch = Watch::new(paths, self.wake.clone());
    }

    /// A window has room.
    pub fn is_small(&self) -> bool {
        false
    }

    /// There is no list to pick from.
    pub fn pick(&self) {}
}

//! The application: panels, view, keys, files that are dropped or change.

use crate::gpu::Raster;
use crate::link::Link;
use crate::link::Source;
use crate::panels::Panels;
use crate::state::Mode;
use crate::state::State;
use crate::viewport::Viewport;
use crate::watch::Watch;
use dotray_scene::files::Disk;
use eframe::CreationContext;
use eframe::egui;
use eframe::egui::Key;
use eframe::egui::Modifiers;
use std::sync::Arc;

/// See the module.
pub struct App {
    state: State,
    panels: Panels,
    viewport: Viewport,
    wake: crate::link::Wake,
    watch: Option<Watch>,
}

/// What is asked for at the start.
#[derive(Clone, Debug, Default)]
pub struct Start {
    /// The scene.
    pub scene: Option<std::path::PathBuf>,
    /// Traced at once.
    pub traced: bool,
    /// Traced when at rest.
    pub trace_at_rest: bool,
}

impl App {
    /// The application in its window.
    pub fn new(creation: &CreationContext<'_>, start: &Start) -> Self {
        let ctx = creation.egui_ctx.clone();
        let wake: crate::link::Wake = Arc::new(move || ctx.request_repaint());
        let mut state = State::new(Link::new(wake.clone()));
        state.raster = creation.wgpu_render_state.as_ref().map(Raster::new);
        state.mode = if start.traced { Mode::Traced } else { Mode::Preview };
        state.trace_at_rest = start.trace_at_rest;
        if let Some(path) = &start.scene {
            state.open(Source { path: path.clone(), files: Arc::new(Disk) });
        }
        Self { state, panels: Panels::default(), viewport: Viewport::default(), wake, watch: None }
    }

    /// Files that were dropped on the window.
    fn take_dropped(&mut self, ctx: &egui::Context) {
        let dropped = ctx.input(|input| input.raw.dropped_files.clone());
        if let Some(path) = dropped.first().map(|file| file.path().to_path_buf()) {
            self.state.open(Source { path, files: Arc::new(Disk) });
            self.watch = None;
        }
    }

    /// Reads the scene again when its files change.
    fn follow_files(&mut self, ctx: &egui::Context) {
        let Some(source) = &self.state.source else { return };
        if self.watch.is_none() {
            self.watch = Watch::new([source.path.as_path()], self.wake.clone());
        }
        match self.watch.as_mut().map(Watch::changed) {
            Some(Ok(true)) => {
                let edited = self.state.document.as_ref().is_some_and(crate::document::Document::is_edited);
                if edited {
                    let what =
                        "the file has changed on the disk; Undo all reads it and drops what was edited here";
                    self.state.notice = what.to_owned();
                } else {
                    self.state.reload();
                }
            }
            Some(Err(wait)) => ctx.request_repaint_after(wait),
            Some(Ok(false)) | None => {}
        }
    }

    /// Watches what the scene turned out to be made of.
    fn watch_all(&mut self) {
        let Some(document) = &self.state.document else { return };
        let sources = (0..document.sources.len() as u32).map(dotray_scene::span::FileId);
        let textures = document.style.textures.iter().flat_map(|texture| &texture.candidates);
        let paths: Vec<&std::path::Path> = sources
            .map(|file| document.sources.path(file))
            .chain(textures.map(std::path::PathBuf::as_path).filter(|path| path.is_file()))
            .collect();
        self.watch = Watch::new(paths, self.wake.clone());
    }

    fn keys(&mut self, ctx: &egui::Context) {
        if ctx.egui_wants_keyboard_input() {
            return;
        }
        let pressed =
            |modifiers: Modifiers, key: Key| ctx.input_mut(|input| input.consume_key(modifiers, key));
        let state = &mut self.state;
        if pressed(Modifiers::COMMAND, Key::S) {
            self.panels.save(state);
        }
        if pressed(Modifiers::SHIFT, Key::H) {
            state.set_hidden(|hidden, _| hidden.clear());
        }
        let selected = state.selection.as_ref().map(|selection| selection.shapes.clone());
        if pressed(Modifiers::NONE, Key::H)
            && let Some(shapes) = selected.clone()
        {
            state.set_hidden(|hidden, _| hidden.hide(shapes));
        }
        if pressed(Modifiers::NONE, Key::I)
            && let Some(shapes) = selected
        {
            state.set_hidden(|hidden, count| hidden.isolate(shapes, count));
        }
        if pressed(Modifiers::NONE, Key::T) {
            state.mode = if state.mode == Mode::Traced { Mode::Preview } else { Mode::Traced };
            state.restart();
        }
        if pressed(Modifiers::NONE, Key::R) {
            state.navigate(crate::navigate::Navigator::reset);
        }
        if pressed(Modifiers::NONE, Key::F) {
            state.frame();
        }
        if pressed(Modifiers::NONE, Key::C) {
            crate::panels::copy_camera(ctx, state);
        }
        if pressed(Modifiers::NONE, Key::G) {
            self.panels.marking = !self.panels.marking;
        }
        if pressed(Modifiers::NONE, Key::N) {
            state.step_ray(1);
        }
        if pressed(Modifiers::NONE, Key::P) {
            state.step_ray(-1);
        }
        if pressed(Modifiers::NONE, Key::F1) {
            self.panels.help = !self.panels.help;
        }
        if pressed(Modifiers::NONE, Key::Escape) {
            self.panels.marking = false;
            state.clear_selection();
        }
        self.lead_by_keys(ctx);
    }

    /// What goes on as long as a key is held.
    fn lead_by_keys(&mut self, ctx: &egui::Context) {
        let (held, seconds) = ctx.input(|input| {
            let plain = !input.modifiers.command && !input.modifiers.alt;
            let held = |key: Key| f64::from(u8::from(plain && input.key_down(key)));
            let axes = [
                held(Key::D) - held(Key::A),
                held(Key::E) - held(Key::Q),
                held(Key::W) - held(Key::S),
                held(Key::ArrowRight) - held(Key::ArrowLeft),
                held(Key::ArrowUp) - held(Key::ArrowDown),
                held(Key::Minus) - held(Key::Plus).max(held(Key::Equals)),
            ];
            (axes, f64::from(input.stable_dt.min(0.1)))
        });
        let [x, y, z, right, up, away] = held;
        if held == [0.0; 6] {
            return;
        }
        let step = 0.4 * seconds;
        self.state.fly([x * step, y * step, z * step]);
        self.state.navigate(|navigator| {
            if right != 0.0 || up != 0.0 {
                navigator.orbit(right * seconds, up * seconds);
            }
            if away != 0.0 {
                navigator.dolly(libm::exp(away * seconds));
            }
        });
        ctx.request_repaint();
    }
}

impl eframe::App for App {
    fn ui(&mut self, ui: &mut egui::Ui, _: &mut eframe::Frame) {
        let ctx = ui.ctx().clone();
        self.take_dropped(&ctx);
        self.follow_files(&ctx);
        let opened = self.state.take_news(&ctx);
        if opened {
            self.watch_all();
        }
        self.keys(&ctx);
        self.panels.show(ui, &mut self.state);
        self.viewport.show(ui, &mut self.state, &mut self.panels);
    }
}

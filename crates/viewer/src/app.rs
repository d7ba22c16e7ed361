//! The application: panels, view, keys, files that are dropped or change.

use crate::gpu::Raster;
use crate::link::Link;
use crate::link::Source;
use crate::panels::Panels;
use crate::state::Mode;
use crate::state::State;
use crate::viewport::Viewport;
#[cfg(not(target_arch = "wasm32"))]
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
    #[cfg(not(target_arch = "wasm32"))]
    watch: Option<Watch>,
    #[cfg(target_arch = "wasm32")]
    dropped: std::rc::Rc<std::cell::RefCell<Arrivals>>,
}

/// Files that were dropped on the page: the browser reads them by and by.
#[cfg(target_arch = "wasm32")]
#[derive(Default)]
struct Arrivals {
    files: crate::memory::Dropped,
    awaited: usize,
    /// The scene among those that have come since the last look.
    scene: Option<std::path::PathBuf>,
    any: bool,
    fault: Option<String>,
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
        Self {
            state,
            panels: Panels::default(),
            viewport: Viewport::default(),
            wake,
            #[cfg(not(target_arch = "wasm32"))]
            watch: None,
            #[cfg(target_arch = "wasm32")]
            dropped: Default::default(),
        }
    }

    /// Files that were dropped on the window.
    #[cfg(not(target_arch = "wasm32"))]
    fn take_dropped(&mut self, ctx: &egui::Context) {
        let dropped = ctx.input(|input| input.raw.dropped_files.clone());
        if let Some(path) = dropped.first().map(|file| file.path().to_path_buf()) {
            self.state.open(Source { path, files: Arc::new(Disk) });
            self.watch = None;
        }
    }

    /// Files that were dropped on the page; when all have been read, the scene among them is shown, or the one that is
    /// shown already is read again with its new textures.
    #[cfg(target_arch = "wasm32")]
    fn take_dropped(&mut self, ctx: &egui::Context) {
        for file in ctx.input(|input| input.raw.dropped_files.clone()) {
            self.dropped.borrow_mut().awaited += 1;
            let (dropped, wake) = (self.dropped.clone(), self.wake.clone());
            wasm_bindgen_futures::spawn_local(async move {
                let path = file.path().to_path_buf();
                let content = file.bytes_async().await;
                let mut dropped = dropped.borrow_mut();
                dropped.awaited -= 1;
                match content {
                    Ok(content) => dropped.take(path, content),
                    Err(fault) => dropped.fault = Some(format!("cannot read `{}`: {fault}", path.display())),
                }
                wake();
            });
        }
        let mut dropped = self.dropped.borrow_mut();
        if let Some(fault) = dropped.fault.take() {
            self.state.notice = fault;
        }
        if dropped.awaited > 0 || !std::mem::take(&mut dropped.any) {
            return;
        }
        let shown = self.state.source.as_ref().map(|source| source.path.clone());
        let scene = dropped.scene.take();
        if let Some(path) = scene.clone().or(shown.clone()) {
            let source = Source { path, files: Arc::new(dropped.files.clone()) };
            drop(dropped);
            if scene.is_some() && scene != shown {
                self.state.open(source);
            } else {
                self.state.source = Some(source);
                self.state.reload();
            }
        } else {
            self.state.notice = "there is no .ray file among these: drop one, too".to_owned();
        }
    }

    /// Reads the scene again when its files change.
    #[cfg(not(target_arch = "wasm32"))]
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
    #[cfg(not(target_arch = "wasm32"))]
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

#[cfg(target_arch = "wasm32")]
impl Arrivals {
    fn take(&mut self, path: std::path::PathBuf, content: Vec<u8>) {
        let is_scene = path.extension().is_some_and(|extension| extension.eq_ignore_ascii_case("ray"));
        if is_scene && self.scene.is_none() {
            self.scene = Some(path.clone());
        }
        self.files.add(&path, content);
        self.any = true;
    }
}

impl eframe::App for App {
    fn ui(&mut self, ui: &mut egui::Ui, _: &mut eframe::Frame) {
        let ctx = ui.ctx().clone();
        self.take_dropped(&ctx);
        #[cfg(not(target_arch = "wasm32"))]
        self.follow_files(&ctx);
        let opened = self.state.take_news(&ctx);
        #[cfg(not(target_arch = "wasm32"))]
        if opened {
            self.watch_all();
        }
        #[cfg(target_arch = "wasm32")]
        let _ = opened;
        self.keys(&ctx);
        self.panels.show(ui, &mut self.state);
        self.viewport.show(ui, &mut self.state, &mut self.panels);
    }

    #[cfg(target_arch = "wasm32")]
    fn as_any_mut(&mut self) -> Option<&mut dyn std::any::Any> {
        Some(&mut *self)
    }
}

//! The application: panels, view, keys, scenes that come in.

use crate::gpu::Raster;
use crate::inbox::Inbox;
use crate::link::Link;
use crate::panels::Panels;
use crate::state::Mode;
use crate::state::State;
use crate::viewport::Viewport;
use eframe::CreationContext;
use eframe::egui;
use eframe::egui::Key;
use eframe::egui::Modifiers;
use std::sync::Arc;
use std::time::Duration;
use web_time::Instant;

/// How long a key is held before it leads the camera.
const HELD: Duration = Duration::from_millis(120);

/// How long after a hand has moved over the view it is told what lies there.
const LOOK: Duration = Duration::from_millis(250);

/// See the module.
pub struct App {
    state: State,
    panels: Panels,
    viewport: Viewport,
    inbox: Inbox,
    /// Since when keys that lead the camera are held, and no other.
    held_since: Option<Instant>,
    #[cfg(target_arch = "wasm32")]
    page: OnPage,
}

/// What only a page needs.
#[cfg(target_arch = "wasm32")]
#[derive(Default)]
struct OnPage {
    report: crate::report::Report,
    hover: crate::hover::Hover,
    due: Arc<std::sync::Mutex<crate::hover::Due>>,
    /// Whether the last frame has been put off.
    is_put_off: bool,
    /// Whether there has been news since.
    woken: Arc<std::sync::atomic::AtomicBool>,
}

#[cfg(target_arch = "wasm32")]
fn locked(due: &std::sync::Mutex<crate::hover::Due>) -> std::sync::MutexGuard<'_, crate::hover::Due> {
    due.lock().unwrap_or_else(std::sync::PoisonError::into_inner)
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
        let later = ctx.clone();
        let nudge = Arc::new(move || later.request_repaint_after(LOOK));
        let raster = creation.wgpu_render_state.as_ref().map(Raster::new);
        let is_software = raster.as_ref().is_some_and(Raster::is_software);
        #[cfg(target_arch = "wasm32")]
        let (page, woken) = {
            let page = OnPage::default();
            let (woken, due) = (page.woken.clone(), page.due.clone());
            ctx.set_repaint_observer(move |request| locked(&due).ask(request.delay, Instant::now()));
            (page, woken)
        };
        let wake: crate::link::Wake = Arc::new(move || {
            #[cfg(target_arch = "wasm32")]
            woken.store(true, std::sync::atomic::Ordering::Relaxed);
            if is_software {
                // A request without delay is one for two frames.
                ctx.request_repaint_after(Duration::from_nanos(1));
            } else {
                ctx.request_repaint();
            }
        });
        let mut state = State::new(Link::new(wake.clone(), nudge));
        state.raster = raster;
        if is_software {
            // Each step of what fades or slides is a frame.
            creation.egui_ctx.all_styles_mut(|style| style.animation_time = 0.0);
        }
        state.mode = if start.traced { Mode::Traced } else { Mode::Preview };
        state.trace_at_rest = start.trace_at_rest;
        let mut inbox = Inbox::new(wake);
        if let Some(path) = &start.scene {
            inbox.open(path.clone(), &mut state);
        }
        let (mut panels, viewport) = (Panels::default(), Viewport::default());
        panels.closed = inbox.is_small();
        Self {
            state,
            panels,
            viewport,
            inbox,
            held_since: None,
            #[cfg(target_arch = "wasm32")]
            page,
        }
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
        if pressed(Modifiers::NONE, Key::V) {
            self.panels.closed = !self.panels.closed;
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
            self.held_since = None;
            return;
        }
        ctx.request_repaint();
        // A key of a chord such as Ctrl + S may be seen before or after its other key; that is no flight.
        let since = *self.held_since.get_or_insert_with(Instant::now);
        if since.elapsed() < HELD {
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
    }
}

impl eframe::App for App {
    fn ui(&mut self, ui: &mut egui::Ui, _: &mut eframe::Frame) {
        let ctx = ui.ctx().clone();
        self.inbox.look(&ctx, &mut self.state);
        let opened = self.state.take_news(&ctx);
        if let Some(document) = self.state.document.as_ref().filter(|_| opened) {
            self.inbox.opened(document);
        }
        if std::mem::take(&mut self.panels.picking) {
            self.inbox.pick();
        }
        self.keys(&ctx);
        self.panels.show(ui, &mut self.state);
        self.viewport.show(ui, &mut self.state, &mut self.panels);
        self.state.link.go_on();
        #[cfg(target_arch = "wasm32")]
        self.page.report.tell(&self.state, self.viewport.rect());
    }

    /// Puts a frame off as frames of a page that is hidden are: what it was to show is kept for the next.
    #[cfg(target_arch = "wasm32")]
    fn raw_input_hook(&mut self, ctx: &egui::Context, input: &mut egui::RawInput) {
        let woken = self.page.woken.swap(false, std::sync::atomic::Ordering::Relaxed);
        let Some(raster) = self.state.raster.as_ref().filter(|raster| raster.is_software()) else { return };
        let line = ctx.options(|options| options.input_options.line_scroll_speed);
        input.events = crate::hover::unspread(std::mem::take(&mut input.events), line);
        let is_asked_for = locked(&self.page.due).begin(Instant::now()) && !self.page.hover.is_quiet();
        let is_wanted = woken || is_asked_for || raster.is_unfinished() && !self.state.is_being_traced();
        let (latest, is_down) = ctx.input(|input| {
            (input.pointer.latest_pos(), input.pointer.any_down() || !input.keys_down.is_empty())
        });
        let view = self.viewport.rect().filter(|_| !self.panels.marking && !is_down);
        let is_over_view = |at: egui::Pos2| {
            view.is_some_and(|view| view.contains(at))
                && ctx.layer_id_at(at).is_none_or(|layer| layer.order == egui::Order::Background)
        };
        let was_over_view = latest.is_some_and(is_over_view);
        let over_view = |at| was_over_view && is_over_view(at);
        let can_wait = self.page.hover.can_wait(&input.events, over_view, is_wanted, Instant::now());
        self.page.is_put_off = can_wait;
        if can_wait {
            input.viewports.entry(egui::ViewportId::ROOT).or_default().occluded = Some(true);
        }
    }

    #[cfg(target_arch = "wasm32")]
    fn logic(&mut self, ctx: &egui::Context, _: &mut eframe::Frame) {
        if self.page.is_put_off {
            // Unlike what others have asked for, this is no reason to draw.
            let before = *locked(&self.page.due);
            ctx.request_repaint_after(before.wait(Instant::now()).map_or(LOOK, |wait| wait.min(LOOK)));
            *locked(&self.page.due) = before;
        }
    }
}

//! The view itself: what is drawn in it, and what a hand does there.

use crate::panels::Panels;
use crate::state::Mode;
use crate::state::REST;
use crate::state::State;
use eframe::egui;
use eframe::egui::PointerButton;
use eframe::egui::Rect;
use eframe::egui::Response;
use eframe::egui::Ui;
use std::time::Duration;

/// How long the view is still before a draft is made good.
const STILL: Duration = Duration::from_millis(80);

/// Radians that a point of dragging turns.
const TURN: f64 = 0.008;

/// What the view remembers between frames.
#[derive(Debug, Default)]
pub struct Viewport {
    /// Where a region's drag began.
    corner: Option<egui::Pos2>,
    /// Where the pointer was when it was last asked what lies there.
    looked: Option<egui::Pos2>,
    /// The pictures on the screen: the scene, or lines over a traced one.
    drawn: Option<egui::TextureId>,
    /// Whether that was drawn for a traced picture.
    over_traced: bool,
    /// Where it was drawn last.
    rect: Option<Rect>,
}

impl Viewport {
    /// Fills what is left of the window.
    pub fn show(&mut self, ui: &mut Ui, state: &mut State, panels: &mut Panels) {
        let pixels_per_point = ui.ctx().pixels_per_point();
        let rect = whole_pixels(ui.available_rect_before_wrap(), pixels_per_point);
        let size =
            [rect.width(), rect.height()].map(|edge| (edge * pixels_per_point).round().max(1.0) as u32);
        if size != state.size {
            state.size = size;
            state.moved();
        }
        self.rect = Some(rect);
        let response = ui.allocate_rect(rect, egui::Sense::click_and_drag());
        if state.document.is_some() {
            self.lead(ui, state, panels, &response, rect);
        }
        if state.trace_at_rest && state.mode == Mode::Preview && state.traced.is_none() {
            let rested = state.moved.elapsed();
            if rested >= REST {
                state.start_tracing();
            } else {
                ui.ctx().request_repaint_after(REST.saturating_sub(rested));
            }
        }
        self.paint(ui, state, rect);
        if let Some(region) = state.region {
            let at =
                |x: f64, y: f64| rect.min + egui::vec2(rect.width() * x as f32, rect.height() * y as f32);
            frame(ui, Rect::from_two_pos(at(region[0], region[1]), at(region[2], region[3])));
        }
    }

    /// Where in the window it was drawn last.
    pub fn rect(&self) -> Option<Rect> {
        self.rect
    }

    fn lead(&mut self, ui: &Ui, state: &mut State, panels: &mut Panels, response: &Response, rect: Rect) {
        let pixels_per_point = ui.ctx().pixels_per_point();
        let in_pixels = |p: egui::Pos2| {
            let offset = (p - rect.min) * pixels_per_point;
            (f64::from(offset.x), f64::from(offset.y))
        };
        if panels.marking {
            self.mark(ui, state, panels, rect);
            return;
        }
        drag(ui, state, response, rect.height());
        if response.hovered() {
            let (scroll, zoom) = ui.input(|input| (input.smooth_scroll_delta.y, input.zoom_delta()));
            if scroll != 0.0 || zoom != 1.0 {
                let factor = libm::exp(-f64::from(scroll) * 0.0025) / f64::from(zoom);
                state.navigate(|navigator| navigator.dolly(factor));
            }
        }
        if response.clicked_by(PointerButton::Primary)
            && let Some(at) = response.interact_pointer_pos()
        {
            let (x, y) = in_pixels(at);
            state.inspect(x, y);
        }
        let hovering = response.hover_pos().filter(|_| !response.dragged());
        if hovering != self.looked {
            self.looked = hovering;
            match hovering {
                Some(at) => {
                    let (x, y) = in_pixels(at);
                    state.look(x, y);
                }
                None => state.hovered = None,
            }
        }
        if let (Some(seen), Some(document), true) = (state.hovered, &state.document, hovering.is_some()) {
            let material = document
                .material(seen.material)
                .map_or("default material".to_owned(), |(_, index)| format!("material {index}"));
            let text = format!("{}\n{material}, {:.4} away", document.shape_name(seen.number), seen.distance);
            response.clone().on_hover_text_at_pointer(text);
        }
    }

    /// Follows the button itself, not what became of it by the end of a frame: frames may be slow, hands are not.
    fn mark(&mut self, ui: &Ui, state: &mut State, panels: &mut Panels, rect: Rect) {
        let mut ended = None;
        ui.input(|input| {
            for event in &input.events {
                let egui::Event::PointerButton { pos, button: PointerButton::Primary, pressed, .. } = event
                else {
                    continue;
                };
                if !pressed {
                    ended = self.corner.take().map(|corner| Rect::from_two_pos(corner, *pos)).or(ended);
                } else if rect.contains(*pos) {
                    self.corner = Some(*pos);
                }
            }
        });
        let at = ui.input(|input| input.pointer.latest_pos());
        if let Some((corner, at)) = self.corner.zip(at) {
            frame(ui, Rect::from_two_pos(corner, at).intersect(rect));
        }
        let Some(marked) = ended.map(|marked| marked.intersect(rect)).filter(Rect::is_positive) else {
            return;
        };
        let part = |p: egui::Pos2| {
            let offset = p - rect.min;
            [f64::from(offset.x / rect.width()), f64::from(offset.y / rect.height())]
        };
        let ([left, top], [right, bottom]) = (part(marked.min), part(marked.max));
        state.region = Some([left, top, right, bottom]);
        panels.marking = false;
        state.mode = Mode::Traced;
        state.restart();
    }

    /// The scene, the traced picture over it as far as there is one, and lines over that.
    fn paint(&mut self, ui: &Ui, state: &mut State, rect: Rect) {
        let window = state.traced.as_ref().filter(|traced| traced.texture.is_some());
        let window = window.map(|traced| traced.request.options.window());
        let [width, height] = state.size;
        let whole = window.is_some_and(|window| (window.width, window.height) == (width, height));
        if (state.stale || whole != self.over_traced)
            && let (Some(camera), Some(raster)) = (state.camera(), &mut state.raster)
        {
            self.drawn = raster.draw(&camera, state.size, whole);
            (state.stale, self.over_traced) = (false, whole);
        }
        // Nobody needs the whole of what a traced picture hides soon.
        let going_on = !state.is_being_traced();
        if let Some(raster) = state.raster.as_mut().filter(|raster| going_on && raster.is_unfinished()) {
            if state.moved.elapsed() >= STILL {
                self.drawn = raster.go_on().or(self.drawn);
            }
            if raster.is_unfinished() {
                ui.ctx().request_repaint();
            }
        }
        let painter = ui.painter_at(rect);
        let all = Rect::from_min_max(egui::pos2(0.0, 0.0), egui::pos2(1.0, 1.0));
        let drawn = self.drawn.filter(|_| state.document.is_some());
        let scene = |painter: &egui::Painter| {
            if let Some(id) = drawn {
                painter.image(id, rect, all, egui::Color32::WHITE);
            }
        };
        if !whole {
            scene(&painter);
        }
        let texture = state.traced.as_ref().and_then(|traced| traced.texture.as_ref());
        if let (Some(texture), Some(window)) = (texture, window) {
            let per_pixel = rect.width() / width as f32;
            let min = rect.min + egui::vec2(window.x as f32, window.y as f32) * per_pixel;
            let size = egui::vec2(window.width as f32, window.height as f32) * per_pixel;
            painter.image(texture.id(), Rect::from_min_size(min, size), all, egui::Color32::WHITE);
        }
        if whole {
            scene(&painter);
        }
        if state.document.is_none() {
            let text = match &state.source {
                Some(source) if state.messages.is_empty() => format!("reading {} …", source.path.display()),
                Some(_) => String::new(),
                None => "Drop a .ray file here, with its textures.".to_owned(),
            };
            let font = egui::FontId::proportional(18.0);
            painter.text(rect.center(), egui::Align2::CENTER_CENTER, text, font, ui.visuals().text_color());
        }
    }
}

fn drag(ui: &Ui, state: &mut State, response: &Response, height: f32) {
    if !response.dragged() {
        return;
    }
    let delta = response.drag_delta();
    let (right, down) = (f64::from(delta.x), f64::from(delta.y));
    let modifiers = ui.input(|input| input.modifiers);
    let primary = response.dragged_by(PointerButton::Primary);
    state.navigate(|navigator| {
        if primary && modifiers.command {
            navigator.look(-right * TURN / 3.0, down * TURN / 3.0);
        } else if primary && !modifiers.shift {
            navigator.orbit(right * TURN, -down * TURN);
        } else {
            navigator.pan(right, -down, f64::from(height));
        }
    });
}

/// A frame around a region.
fn frame(ui: &Ui, rect: Rect) {
    let stroke = egui::Stroke::new(1.5, egui::Color32::from_rgb(255, 150, 0));
    ui.painter().rect_stroke(rect, 0.0, stroke, egui::StrokeKind::Inside);
}

/// The rectangle from whole pixel to whole pixel, so that a picture's pixels are the screen's.
fn whole_pixels(rect: Rect, pixels_per_point: f32) -> Rect {
    let whole = |at: egui::Pos2| (at.to_vec2() * pixels_per_point).round() / pixels_per_point;
    Rect::from_min_max(whole(rect.min).to_pos2(), whole(rect.max).to_pos2())
}

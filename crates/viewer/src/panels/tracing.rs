//! What is asked of the tracer.

use super::Panels;
use crate::host;
use crate::state::State;
use dotray_accel::Kind;
use dotray_render::Antialias;
use dotray_render::Options;
use dotray_render::Shadows;
use eframe::egui;
use eframe::egui::DragValue;
use eframe::egui::Ui;

pub fn show(panels: &mut Panels, ui: &mut Ui, state: &mut State) {
    ui.add_space(4.0);
    ui.strong("Tracing");
    let (before, accel) = (state.options.clone(), state.accel);
    egui::Grid::new("options").num_columns(2).show(ui, |ui| choices(ui, state));
    if state.options != before {
        state.restart();
    }
    if state.accel != accel {
        state.reload();
    }
    region(panels, ui, state);
    save(panels, ui, state);
}

fn choices(ui: &mut Ui, state: &mut State) {
    let Options { recursion, threshold, antialias, shadows, light_samples, .. } = &mut state.options;
    ui.label("Recursion");
    ui.add(DragValue::new(recursion).range(0..=50).speed(0.05));
    ui.end_row();
    ui.label("Cut-off");
    ui.add(DragValue::new(threshold).range(0.0..=1.0).speed(0.0005).max_decimals(5));
    ui.end_row();
    ui.label("Shadows");
    let name = |shadows: Shadows| match shadows {
        Shadows::Filtered => "filtered",
        Shadows::Opaque => "opaque",
        Shadows::Off => "off",
    };
    egui::ComboBox::from_id_salt("shadows").selected_text(name(*shadows)).show_ui(ui, |ui| {
        for choice in [Shadows::Filtered, Shadows::Opaque, Shadows::Off] {
            ui.selectable_value(shadows, choice, name(choice));
        }
    });
    ui.end_row();
    ui.label("Lamp samples").on_hover_text("Points that stand for one #light_area");
    ui.add(DragValue::new(light_samples).range(1..=1024).speed(0.5));
    ui.end_row();
    ui.label("Oversampling");
    let name = |antialias: Antialias| match antialias {
        Antialias::None => "none".to_owned(),
        Antialias::Grid(n) => format!("grid {n} × {n}"),
        Antialias::Adaptive { .. } => "adaptive".to_owned(),
    };
    egui::ComboBox::from_id_salt("aa").selected_text(name(*antialias)).show_ui(ui, |ui| {
        for choice in [Antialias::None, Antialias::Grid(2), Antialias::Grid(4), Antialias::ADAPTIVE] {
            ui.selectable_value(antialias, choice, name(choice));
        }
    });
    ui.end_row();
    ui.label("Accelerator").on_hover_text("The picture does not depend on it");
    // For another one the scene is read again, which would drop what was edited here.
    let edited = state.document.as_ref().is_some_and(crate::document::Document::is_edited);
    ui.add_enabled_ui(!edited, |ui| {
        egui::ComboBox::from_id_salt("accel").selected_text(state.accel.name()).show_ui(ui, |ui| {
            for kind in Kind::ALL {
                ui.selectable_value(&mut state.accel, kind, kind.name());
            }
        });
    });
    ui.end_row();
}

fn region(panels: &mut Panels, ui: &mut Ui, state: &mut State) {
    ui.horizontal(|ui| {
        ui.toggle_value(&mut panels.marking, "Mark region").on_hover_text("Then drag in the view (G)");
        if ui.add_enabled(state.region.is_some(), egui::Button::new("Whole view")).clicked() {
            state.region = None;
            state.restart();
        }
    });
}

fn save(panels: &mut Panels, ui: &mut Ui, state: &mut State) {
    let scene = state.document.as_ref().map(|document| &document.path);
    if panels.picture_of.as_ref() != scene {
        panels.picture_of = scene.cloned();
        let path = scene.map(|path| path.with_extension("png"));
        panels.picture_name = path.map_or_else(String::new, |path| path.display().to_string());
    }
    ui.horizontal(|ui| {
        let finished = state.traced.as_ref().is_some_and(|traced| traced.image.is_some());
        let button = egui::Button::new("Save picture");
        if ui.add_enabled(finished, button).on_hover_text("Ctrl + S").clicked() {
            save_picture(panels, state);
        }
        ui.add(egui::TextEdit::singleline(&mut panels.picture_name).desired_width(f32::INFINITY));
    });
}

/// Stores the traced picture under the name that stands there.
pub fn save_picture(panels: &Panels, state: &mut State) {
    let path = std::path::Path::new(panels.picture_name.trim());
    let stored = state.encoded(path).and_then(|bytes| host::save(path, &bytes));
    state.notice = match stored {
        Ok(()) if state.hidden.is_empty() => format!("saved: {}", path.display()),
        Ok(()) => format!("saved without the hidden shapes: {}", path.display()),
        Err(sentence) => sentence,
    };
}

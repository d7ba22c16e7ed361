//! Materials and lights, to be edited and seen at once, and written back into the file.

use super::toolbar::write;
use crate::state::State;
use dotray_geometry::Vec3;
use dotray_scene::model::Attenuation;
use dotray_scene::model::Light;
use eframe::egui;
use eframe::egui::DragValue;
use eframe::egui::Ui;

/// So many materials are listed: no hand edits more.
const MOST: usize = 2000;

/// The button that writes, and why there is none.
fn write_back(ui: &mut Ui, state: &mut State) {
    let Some(document) = &state.document else { return };
    if !document.can_edit() {
        ui.label(format!("Dialect {}: shown, not edited.", document.dialect));
        return;
    }
    let edited = document.is_edited();
    ui.horizontal(|ui| {
        let button = egui::Button::new("Write back");
        let hint = "Changes these numbers in the file; comments and layout stay";
        if ui.add_enabled(edited, button).on_hover_text(hint).clicked() {
            write(state, false);
        }
        if ui.add_enabled(edited, egui::Button::new("Undo all")).clicked() {
            state.reload();
        }
    });
    ui.separator();
}

/// A colour as a button that opens a picker, and as three numbers that may leave 0 to 1.
fn color(ui: &mut Ui, name: &str, color: &mut Vec3) {
    ui.label(name);
    ui.horizontal(|ui| {
        let mut shown = color.to_array().map(|x| (x.clamp(0.0, 1.0) * 255.0).round() as u8);
        if ui.color_edit_button_srgb(&mut shown).changed() {
            *color = Vec3::from_array(shown.map(|x| (f64::from(x) / 255.0 * 1000.0).round() / 1000.0));
        }
        for channel in [&mut color.x, &mut color.y, &mut color.z] {
            ui.add(DragValue::new(channel).speed(0.005).max_decimals(4));
        }
    });
    ui.end_row();
}

fn number(ui: &mut Ui, name: &str, value: &mut f64, range: std::ops::RangeInclusive<f64>) {
    ui.label(name);
    ui.add(DragValue::new(value).speed(0.01).range(range).max_decimals(5));
    ui.end_row();
}

fn vector(ui: &mut Ui, name: &str, value: &mut Vec3, speed: f64) {
    ui.label(name);
    ui.horizontal(|ui| {
        for part in [&mut value.x, &mut value.y, &mut value.z] {
            ui.add(DragValue::new(part).speed(speed).max_decimals(5));
        }
    });
    ui.end_row();
}

pub fn materials(ui: &mut Ui, state: &mut State) {
    write_back(ui, state);
    let Some(document) = &state.document else { return };
    let enabled = document.can_edit();
    let mut changed = None;
    egui::ScrollArea::vertical().auto_shrink([false, false]).show(ui, |ui| {
        let all = document.files().iter().enumerate();
        let all =
            all.flat_map(|(file, it)| it.materials.iter().enumerate().map(move |(m, it)| (file, m, it)));
        for (file, index, placed) in all.take(MOST) {
            let title = format!("material {index} · {}", document.place(placed.span));
            egui::CollapsingHeader::new(title).id_salt((file, index)).default_open(index == 0).show(
                ui,
                |ui| {
                    let mut material = placed.value.clone();
                    ui.add_enabled_ui(enabled, |ui| {
                        egui::Grid::new(("material", file, index)).num_columns(2).show(ui, |ui| {
                            color(ui, "ambient", &mut material.ambient);
                            color(ui, "diffuse", &mut material.diffuse);
                            color(ui, "specular", &mut material.specular);
                            color(ui, "emissive", &mut material.emissive);
                            number(ui, "ks", &mut material.k_specular, 0.0..=100.0);
                            number(ui, "kt", &mut material.k_transmission, 0.0..=100.0);
                            number(ui, "ir", &mut material.index_of_refraction, 0.0..=10.0);
                        });
                    });
                    let text = material.text.trim();
                    if !text.is_empty() {
                        ui.label(egui::RichText::new(text).weak());
                    }
                    if material != placed.value {
                        changed = Some((file, index, material));
                    }
                },
            );
        }
    });
    if let (Some((file, index, material)), Some(document)) = (changed, &mut state.document) {
        let outcome = document.set_material(file, index, material);
        state.restyle(outcome);
    }
}

pub fn lights(ui: &mut Ui, state: &mut State) {
    write_back(ui, state);
    let Some(document) = &state.document else { return };
    let speed = document.packed.frame.unit * 0.005;
    let enabled = document.can_edit();
    let Some(file) = document.files().first() else { return };
    let mut light_changed = None;
    let (mut background, mut ambient) = (file.background, file.ambient);
    egui::ScrollArea::vertical().auto_shrink([false, false]).show(ui, |ui| {
        ui.add_enabled_ui(enabled, |ui| {
            egui::Grid::new("colors").num_columns(2).show(ui, |ui| {
                if let Some(placed) = &mut background {
                    color(ui, "background", &mut placed.value);
                }
                if let Some(placed) = &mut ambient {
                    color(ui, "ambient", &mut placed.value);
                }
            });
            for (index, placed) in file.lights.iter().enumerate().take(MOST) {
                let title =
                    format!("light {index}: {} · {}", kind(&placed.value), document.place(placed.span));
                egui::CollapsingHeader::new(title).id_salt(index).default_open(index < 4).show(ui, |ui| {
                    let mut light = placed.value;
                    egui::Grid::new(("light", index))
                        .num_columns(2)
                        .show(ui, |ui| fields(ui, &mut light, speed));
                    if light != placed.value {
                        light_changed = Some((index, light));
                    }
                });
            }
        });
    });
    let (background, ambient) =
        (background.filter(|b| Some(*b) != file.background), ambient.filter(|a| Some(*a) != file.ambient));
    let Some(document) = &mut state.document else { return };
    let outcome = match (light_changed, background, ambient) {
        (Some((index, light)), _, _) => document.set_light(index, light),
        (None, Some(background), _) => document.set_background(background.value),
        (None, None, Some(ambient)) => document.set_ambient(ambient.value),
        (None, None, None) => return,
    };
    state.restyle(outcome);
}

fn kind(light: &Light) -> &'static str {
    match light {
        Light::Point { .. } => "point",
        Light::Spot { .. } => "spot",
        Light::Directional { .. } => "directional",
        Light::Area { .. } => "area",
    }
}

/// A direction of length 0 means nothing; such an edit is not taken.
fn direction(ui: &mut Ui, value: &mut Vec3) {
    let mut edited = *value;
    vector(ui, "direction", &mut edited, 0.01);
    if edited != Vec3::ZERO {
        *value = edited;
    }
}

fn fading(ui: &mut Ui, attenuation: &mut Attenuation) {
    number(ui, "ca", &mut attenuation.constant, 0.0..=1e9);
    number(ui, "la", &mut attenuation.linear, 0.0..=1e9);
    number(ui, "qa", &mut attenuation.quadratic, 0.0..=1e9);
}

fn fields(ui: &mut Ui, light: &mut Light, speed: f64) {
    match light {
        Light::Point { color: c, position, attenuation } => {
            color(ui, "colour", c);
            vector(ui, "position", position, speed);
            fading(ui, attenuation);
        }
        Light::Spot { color: c, position, direction: d, attenuation, cutoff, dropoff } => {
            color(ui, "colour", c);
            vector(ui, "position", position, speed);
            direction(ui, d);
            fading(ui, attenuation);
            number(ui, "cut-off angle", cutoff, 0.0..=std::f64::consts::PI);
            number(ui, "drop-off", dropoff, 0.0..=100.0);
        }
        Light::Directional { color: c, direction: d } => {
            color(ui, "colour", c);
            direction(ui, d);
        }
        Light::Area { color: c, position, direction: d, radius, attenuation } => {
            color(ui, "colour", c);
            vector(ui, "position", position, speed);
            direction(ui, d);
            number(ui, "radius", radius, 1e-9..=1e9);
            fading(ui, attenuation);
        }
    }
}

//! The rays of the pixel that was clicked.

use crate::document::Document;
use crate::rays::LightRow;
use crate::rays::RayRow;
use crate::rays::end_text;
use crate::state::State;
use dotray_geometry::Vec3;
use dotray_render::inspect::RayKind;
use eframe::egui;
use eframe::egui::RichText;
use eframe::egui::Ui;

/// `material 3 · scene.ray:12`
pub fn material_name(document: &Document, resolved: u32) -> String {
    let Some((file, index)) = document.material(resolved) else { return "default material".to_owned() };
    let placed = document.files().get(file).and_then(|file| file.materials.get(index));
    match placed {
        Some(placed) => format!("material {index} · {}", document.place(placed.span)),
        None => format!("material {index}"),
    }
}

/// A colour as a small square and its numbers.
fn swatch(ui: &mut Ui, color: Vec3) {
    let [r, g, b] = color.to_array().map(|x| (x.clamp(0.0, 1.0) * 255.0).round() as u8);
    let (rect, _) = ui.allocate_exact_size(egui::vec2(12.0, 12.0), egui::Sense::hover());
    ui.painter().rect_filled(rect, 2.0, egui::Color32::from_rgb(r, g, b));
    ui.monospace(numbers(color));
}

fn numbers(v: Vec3) -> String {
    format!("{:.3} {:.3} {:.3}", v.x, v.y, v.z)
}

pub fn show(ui: &mut Ui, state: &mut State) {
    let Some(rays) = &state.rays else {
        ui.strong("Rays");
        ui.label("Click a pixel to see its rays.");
        return;
    };
    let mut chosen = rays.chosen;
    let [x, y] = rays.pixel;
    ui.strong(format!("Rays of pixel {x}, {y}"));
    ui.horizontal(|ui| {
        if ui.button("Previous").on_hover_text("P").clicked() {
            chosen = Some(chosen.map_or(rays.rows.len().saturating_sub(1), |at| at.saturating_sub(1)));
        }
        if ui.button("Next").on_hover_text("N").clicked() {
            chosen = Some(chosen.map_or(0, |at| (at + 1).min(rays.rows.len().saturating_sub(1))));
        }
        if ui.selectable_label(chosen.is_none(), "all").clicked() {
            chosen = None;
        }
        ui.label(format!("{} rays", rays.rows.len()));
    });
    let height = ui.text_style_height(&egui::TextStyle::Body);
    let list = (ui.available_height() * 0.45).max(80.0);
    egui::ScrollArea::vertical().id_salt("rays").max_height(list).auto_shrink([false, true]).show_rows(
        ui,
        height,
        rays.rows.len(),
        |ui, range| {
            for at in range {
                let Some(row) = rays.rows.get(at) else { continue };
                let text = ray_name(state.document.as_ref(), row);
                if ui.add(egui::Button::selectable(chosen == Some(at), text).truncate()).clicked() {
                    chosen = Some(at);
                }
            }
        },
    );
    ui.separator();
    if let (Some(row), Some(document)) = (rays.rows.get(chosen.unwrap_or(0)), &state.document) {
        egui::ScrollArea::vertical().id_salt("ray").auto_shrink([false, false]).show(ui, |ui| {
            details(ui, row, document);
        });
    }
    if chosen != rays.chosen {
        if let Some(rays) = &mut state.rays {
            rays.chosen = chosen;
        }
        state.redraw_lines();
    }
}

fn ray_name(document: Option<&Document>, row: &RayRow) -> String {
    let indent = "   ".repeat(row.depth.min(20) as usize);
    let kind = match row.kind {
        RayKind::Eye => "eye",
        RayKind::Reflected => "mirrored",
        RayKind::Refracted => "refracted",
    };
    let met = row.met.zip(document).map_or_else(
        || "background".to_owned(),
        |((number, _), document)| match document.shape(number) {
            Some((kind, _)) => format!("{kind} {number}"),
            None => format!("shape {number}"),
        },
    );
    format!("{indent}{kind}: {met}")
}

fn details(ui: &mut Ui, row: &RayRow, document: &Document) {
    egui::Grid::new("ray").num_columns(2).show(ui, |ui| {
        let mut line = |name: &str, value: String| {
            ui.label(name);
            ui.add(egui::Label::new(RichText::new(value).monospace()).truncate());
            ui.end_row();
        };
        if let Some((number, material)) = row.met {
            line("shape", document.shape_name(number));
            line("material", material_name(document, material));
            line("at", numbers(row.to));
            line("normal", numbers(row.normal));
            line("distance", format!("{:.4}", row.distance));
            line("side", if row.entering { "from outside" } else { "from inside" }.to_owned());
        }
        for (name, color) in [("colour", row.color), ("own and lights", row.direct), ("weight", row.weight)] {
            ui.label(name);
            ui.horizontal(|ui| swatch(ui, color));
            ui.end_row();
        }
        for (name, end) in [("mirrored", row.ends[0]), ("refracted", row.ends[1])] {
            if let Some(end) = end {
                ui.label(name);
                ui.add(egui::Label::new(RichText::new(end_text(end)).weak()).wrap());
                ui.end_row();
            }
        }
        for light in row.lights.iter().take(64) {
            ui.label(format!("light {}", light.light));
            ui.horizontal(|ui| {
                swatch(ui, light.gives);
                ui.add(egui::Label::new(RichText::new(between(light)).weak()).wrap());
            });
            ui.end_row();
        }
    });
}

fn between(light: &LightRow) -> String {
    let LightRow { samples, shining, blocked, blocker, crossed, .. } = light;
    match (blocker, samples) {
        _ if *shining == 0 => "does not shine here".to_owned(),
        (Some(number), 1) => format!("behind shape {number}"),
        (Some(_), _) => format!("{blocked} of {samples} points hidden"),
        (None, _) if *crossed > 0 => "through surfaces".to_owned(),
        (None, _) => String::new(),
    }
}

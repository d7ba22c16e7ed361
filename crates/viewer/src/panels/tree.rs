//! Groups and shapes: search, select, hide, isolate.

use super::Panels;
use crate::outline::Row;
use crate::state::State;
use eframe::egui;
use eframe::egui::Ui;
use std::ops::Range;

/// What was asked for in a row.
enum Asked {
    Toggle(u32),
    Select(Range<u32>),
    Show(Range<u32>, bool),
    Isolate(Range<u32>),
}

/// So many results of a search are listed.
const MOST_FOUND: usize = 500;

pub fn show(panels: &mut Panels, ui: &mut Ui, state: &mut State) {
    let search = egui::TextEdit::singleline(&mut panels.search).hint_text("search: sphere, 12, scene.ray:3");
    ui.add(search.desired_width(f32::INFINITY));
    ui.horizontal(|ui| {
        if ui.checkbox(&mut state.show_bounds, "box").on_hover_text("Around the selection").changed() {
            state.redraw_lines();
        }
        let any = !state.hidden.is_empty();
        if ui.add_enabled(any, egui::Button::new("Show all").small()).on_hover_text("Shift + H").clicked() {
            state.set_hidden(|hidden, _| hidden.clear());
        }
        if let Some(selection) = state.selection.clone() {
            if ui.small_button("Hide").on_hover_text("H").clicked() {
                state.set_hidden(|hidden, _| hidden.hide(selection.shapes.clone()));
            }
            if ui.small_button("Isolate").on_hover_text("I").clicked() {
                state.set_hidden(|hidden, count| hidden.isolate(selection.shapes.clone(), count));
            }
        }
    });
    if any_hidden_in_traced(state) {
        ui.label(egui::RichText::new("Hidden shapes are left out of the traced picture.").weak());
    }
    ui.separator();
    let asked =
        if panels.search.trim().is_empty() { rows(panels, ui, state) } else { found(panels, ui, state) };
    match asked {
        Some(Asked::Toggle(node)) => {
            if let Some(document) = &mut state.document {
                document.outline.toggle(node);
            }
        }
        Some(Asked::Select(shapes)) => {
            panels.last_selected = Some(shapes.start);
            state.rays = None;
            state.select(shapes);
        }
        Some(Asked::Show(shapes, true)) => state.set_hidden(|hidden, _| hidden.show(shapes)),
        Some(Asked::Show(shapes, false)) => state.set_hidden(|hidden, _| hidden.hide(shapes)),
        Some(Asked::Isolate(shapes)) => state.set_hidden(|hidden, count| hidden.isolate(shapes, count)),
        None => {}
    }
}

fn any_hidden_in_traced(state: &State) -> bool {
    !state.hidden.is_empty() && state.traced.is_some()
}

fn rows(panels: &mut Panels, ui: &mut Ui, state: &mut State) -> Option<Asked> {
    let selected = state.selection.as_ref().filter(|s| s.shapes.len() == 1).map(|s| s.shapes.start);
    if let Some(number) = selected.filter(|number| panels.last_selected != Some(*number)) {
        panels.last_selected = Some(number);
        panels.scroll_to = state.document.as_mut().and_then(|document| document.outline.reveal(number));
    }
    let document = state.document.as_ref()?;
    let height = ui.spacing().interact_size.y;
    let mut area = egui::ScrollArea::vertical().auto_shrink([false, false]);
    if let Some(row) = panels.scroll_to.take() {
        let above = row.saturating_sub(4) as f32;
        area = area.vertical_scroll_offset(above * (height + ui.spacing().item_spacing.y));
    }
    let mut asked = None;
    area.show_rows(ui, height, document.outline.row_count(), |ui, range| {
        for row in range.filter_map(|at| document.outline.row(at)) {
            if let Some(of_row) = line(ui, state, row) {
                asked = Some(of_row);
            }
        }
    });
    asked
}

fn line(ui: &mut Ui, state: &State, row: Row) -> Option<Asked> {
    let document = state.document.as_ref()?;
    let node = document.outline.nodes().get(row.node as usize)?;
    let shapes = document.outline.shapes(row);
    let mut asked = None;
    ui.horizontal(|ui| {
        let depth = node.depth.min(12) + u32::from(row.shape.is_some());
        ui.add_space(depth as f32 * 12.0);
        let opens = row.shape.is_none() && document.outline.can_open(row.node);
        let (_, arrow) = ui.allocate_exact_size(egui::vec2(14.0, 14.0), egui::Sense::click());
        if opens {
            let openness = f32::from(u8::from(document.outline.is_open(row.node)));
            egui::collapsing_header::paint_default_icon(ui, openness, &arrow);
            if arrow.clicked() {
                asked = Some(Asked::Toggle(row.node));
            }
        }
        let mut shown = !state.hidden.covers(&shapes);
        if ui.checkbox(&mut shown, "").on_hover_text("Shown").changed() {
            asked = Some(Asked::Show(shapes.clone(), shown));
        }
        let is_selected = state.selection.as_ref().is_some_and(|s| s.shapes == shapes);
        let label = ui.add(egui::Button::selectable(is_selected, document.row_name(row)).truncate());
        if label.clicked() {
            asked = Some(Asked::Select(shapes.clone()));
        }
        label.context_menu(|ui| {
            if ui.button("Show this alone").clicked() {
                asked = Some(Asked::Isolate(shapes.clone()));
                ui.close();
            }
        });
    });
    asked
}

fn found(panels: &mut Panels, ui: &mut Ui, state: &State) -> Option<Asked> {
    let document = state.document.as_ref()?;
    let wanted = panels.search.trim().to_lowercase();
    if panels.found.as_ref().is_none_or(|(last, _)| *last != wanted) {
        let nodes = document.outline.nodes();
        let mut at = 0;
        let matching = document.outline.find(MOST_FOUND, |_| {
            let row = Row { node: at, shape: None };
            at += 1;
            document.row_name(row).to_lowercase().contains(&wanted)
        });
        debug_assert!(matching.iter().all(|node| (*node as usize) < nodes.len()));
        panels.found = Some((wanted.clone(), matching));
    }
    let (_, matching) = panels.found.as_ref()?;
    let mut asked = None;
    let number = wanted.parse::<u32>().ok().filter(|number| *number < document.shape_count);
    egui::ScrollArea::vertical().auto_shrink([false, false]).show(ui, |ui| {
        if let Some(number) = number
            && ui.selectable_label(false, document.shape_name(number)).clicked()
        {
            asked = Some(Asked::Select(number..number + 1));
        }
        for &node in matching {
            let row = Row { node, shape: None };
            if ui.selectable_label(false, document.row_name(row)).clicked() {
                asked = Some(Asked::Select(document.outline.shapes(row)));
            }
        }
        if matching.is_empty() && number.is_none() {
            ui.label("nothing found");
        }
    });
    asked
}

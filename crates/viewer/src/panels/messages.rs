//! What is wrong with the scene, over the last good picture.

use super::Panels;
use crate::state::State;
use eframe::egui;
use eframe::egui::Ui;

pub fn show(panels: &mut Panels, ui: &Ui, state: &mut State) {
    if state.messages.is_empty() {
        panels.messages_hidden = false;
        return;
    }
    let errors = state.messages.iter().filter(|message| message.error).count();
    if panels.messages_hidden && errors == 0 {
        return;
    }
    let title = match errors {
        0 => format!("{} warnings", state.messages.len()),
        1 => "The scene has an error".to_owned(),
        _ => format!("The scene has {errors} errors"),
    };
    let anchor = egui::Align2::CENTER_BOTTOM;
    let mut open = true;
    // As wide as the messages, whose lines are those of the file, where the window is.
    let widest = (ui.ctx().content_rect().width() - 60.0).max(200.0);
    egui::Window::new(title)
        .id(egui::Id::unique("messages"))
        .open(&mut open)
        .anchor(anchor, [0.0, -40.0])
        .auto_sized()
        .show(ui.ctx(), |ui| {
            if errors > 0 && state.document.is_some() {
                ui.label("What is shown is the last good state of the file.");
            }
            egui::ScrollArea::both().max_height(220.0).max_width(widest).show(ui, |ui| {
                for message in &state.messages {
                    let color =
                        if message.error { ui.visuals().error_fg_color } else { ui.visuals().warn_fg_color };
                    let text = egui::RichText::new(&message.text).monospace().size(12.0).color(color);
                    ui.add(egui::Label::new(text).wrap_mode(egui::TextWrapMode::Extend));
                    ui.separator();
                }
            });
        });
    if !open {
        panels.messages_hidden = true;
        state.messages.retain(|message| message.error && state.document.is_none());
    }
}

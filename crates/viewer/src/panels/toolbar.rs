//! The line above: modes, the camera, saving, help.

use super::Panels;
use crate::edit::camera_line;
use crate::edit::rounded_camera;
use crate::inbox;
use crate::state::Mode;
use crate::state::State;
use eframe::egui;
use eframe::egui::Ui;

/// Light, dark, or as the system has it.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Default)]
pub enum Theme {
    /// As the system has it.
    #[default]
    System,
    /// Dark.
    Dark,
    /// Light.
    Light,
}

impl Theme {
    fn next(self) -> (Self, egui::ThemePreference) {
        match self {
            Self::System => (Self::Dark, egui::ThemePreference::Dark),
            Self::Dark => (Self::Light, egui::ThemePreference::Light),
            Self::Light => (Self::System, egui::ThemePreference::System),
        }
    }

    fn name(self) -> &'static str {
        match self {
            Self::System => "Theme: system",
            Self::Dark => "Theme: dark",
            Self::Light => "Theme: light",
        }
    }
}

pub fn show(panels: &mut Panels, ui: &mut Ui, state: &mut State) {
    ui.horizontal_wrapped(|ui| {
        if inbox::CAN_PICK {
            let what = "A .ray file with its textures; they stay on this machine";
            panels.picking |= ui.button("Open …").on_hover_text(what).clicked();
            ui.separator();
        }
        let mode = state.mode;
        ui.selectable_value(&mut state.mode, Mode::Preview, "Preview");
        ui.selectable_value(&mut state.mode, Mode::Traced, "Traced").on_hover_text("T");
        if state.mode != mode {
            state.restart();
        }
        ui.checkbox(&mut state.trace_at_rest, "when at rest")
            .on_hover_text("Trace whenever the camera has come to rest");
        ui.separator();
        if ui.button("Reset").on_hover_text("Back to the file's camera (R)").clicked() {
            state.navigate(crate::navigate::Navigator::reset);
        }
        if ui.button("Frame").on_hover_text("Look at what is selected, or at everything (F)").clicked() {
            state.frame();
        }
        if ui.button("Copy camera").on_hover_text("As a #camera line (C)").clicked() {
            copy_camera(ui.ctx(), state);
        }
        let writable = state.document.as_ref().is_some_and(crate::document::Document::can_edit);
        if ui
            .add_enabled(writable, egui::Button::new("Write camera"))
            .on_hover_text("Into the file")
            .clicked()
        {
            write(state, true);
        }
        ui.separator();
        if ui.button(panels.theme.name()).clicked() {
            let (theme, preference) = panels.theme.next();
            panels.theme = theme;
            ui.ctx().set_theme(preference);
        }
        let mut open = !panels.closed;
        if ui.toggle_value(&mut open, "Panels").on_hover_text("At the sides (V)").changed() {
            panels.closed = !open;
        }
        if ui.button("Keys").on_hover_text("F1").clicked() {
            panels.help = !panels.help;
        }
    });
}

/// Puts the camera on the clipboard.
pub fn copy_camera(ctx: &egui::Context, state: &mut State) {
    if let Some(camera) = state.camera() {
        let line = camera_line(&rounded_camera(&camera));
        state.notice = format!("copied: {line}");
        ctx.copy_text(line);
    }
}

/// Writes what was edited, or the camera, into the files.
pub fn write(state: &mut State, with_camera: bool) {
    let texts = match state.texts_to_write(with_camera) {
        Ok(texts) => texts,
        Err(sentence) => {
            state.notice = sentence;
            return;
        }
    };
    let (Some(document), Some(source)) = (&state.document, &state.source) else { return };
    let mut names = Vec::new();
    for (file, text) in &texts {
        let path = document.sources.path(*file);
        if !source.files.is_as_read(path, document.sources.bytes(*file)) {
            state.notice = format!(
                "`{}` is not what is shown: it has changed on the disk, or is compressed; nothing was written",
                path.display()
            );
            return;
        }
        if let Err(sentence) = source.files.store(path, text) {
            state.notice = sentence;
            return;
        }
        names.push(path.display().to_string());
    }
    state.notice = format!("written: {}", names.join(", "));
    state.reload();
}

const KEYS: [(&str, &str); 19] = [
    ("drag", "orbit"),
    ("right or middle drag, Shift + drag", "pan"),
    ("wheel", "nearer, farther"),
    ("Ctrl + drag", "look around"),
    ("W A S D, Q E", "fly; down, up"),
    ("arrows, + and -", "orbit; nearer, farther"),
    ("click", "the rays of a pixel, and its shape"),
    ("N, P", "next ray, previous ray"),
    ("T", "preview or traced"),
    ("R", "back to the file's camera"),
    ("F", "look at the selection, or at everything"),
    ("C", "copy the camera as a #camera line"),
    ("H, Shift + H", "hide the selection; show everything"),
    ("I", "show the selection alone"),
    ("G", "mark the part to trace with the next drag"),
    ("Ctrl + S", "save the traced picture"),
    ("V", "close and open the panels at the sides"),
    ("Escape", "select nothing"),
    ("F1", "this list"),
];

pub fn help(panels: &mut Panels, ui: &Ui) {
    let anchor = egui::Align2::CENTER_CENTER;
    let window = egui::Window::new("Keys").open(&mut panels.help).resizable(false).anchor(anchor, [0.0, 0.0]);
    window.show(ui.ctx(), |ui| {
        egui::Grid::new("keys").striped(true).show(ui, |ui| {
            for (key, meaning) in KEYS {
                ui.strong(key);
                ui.label(meaning);
                ui.end_row();
            }
        });
    });
}

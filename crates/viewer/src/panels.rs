//! The panels around the view.

mod messages;
mod rays;
mod status;
mod styles;
mod toolbar;
mod tracing;
mod tree;

use crate::state::State;
use eframe::egui;

pub use toolbar::Theme;
pub use toolbar::copy_camera;

/// Which list the left panel shows.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Default)]
pub enum Tab {
    /// Groups and shapes.
    #[default]
    Tree,
    /// Materials.
    Materials,
    /// Lights and colours.
    Lights,
}

/// What the panels remember.
#[derive(Debug, Default)]
pub struct Panels {
    /// The left panel's list.
    pub tab: Tab,
    /// Whether the keys are explained.
    pub help: bool,
    /// Light, dark, or as the system has it.
    pub theme: Theme,
    /// Whether the next drag marks the part to trace.
    pub marking: bool,
    /// Whether the panels at the sides are closed.
    pub closed: bool,
    /// Whether the user wants to pick files.
    pub picking: bool,
    search: String,
    found: Option<(String, Vec<u32>)>,
    picture_name: String,
    /// The scene that this name was made for.
    picture_of: Option<std::path::PathBuf>,
    scroll_to: Option<usize>,
    messages_hidden: bool,
    last_selected: Option<u32>,
}

impl Panels {
    /// All of them; what is left is for the view.
    pub fn show(&mut self, ui: &mut egui::Ui, state: &mut State) {
        egui::Panel::top("toolbar").show(ui, |ui| toolbar::show(self, ui, state));
        egui::Panel::bottom("status").show(ui, |ui| status::show(ui, state));
        if !self.closed {
            self.sides(ui, state);
        }
        messages::show(self, ui, state);
        if self.help {
            toolbar::help(self, ui);
        }
    }

    fn sides(&mut self, ui: &mut egui::Ui, state: &mut State) {
        egui::Panel::left("scene").exact_size(300.0).show(ui, |ui| self.left(ui, state));
        egui::Panel::right("tracing").exact_size(310.0).show(ui, |ui| {
            tracing::show(self, ui, state);
            ui.separator();
            rays::show(ui, state);
        });
    }

    /// Stores the traced picture under the name that stands in its field.
    pub fn save(&self, state: &mut State) {
        tracing::save_picture(self, state);
    }

    fn left(&mut self, ui: &mut egui::Ui, state: &mut State) {
        ui.add_space(4.0);
        ui.horizontal(|ui| {
            for (tab, name) in [(Tab::Tree, "Scene"), (Tab::Materials, "Materials"), (Tab::Lights, "Lights")]
            {
                ui.selectable_value(&mut self.tab, tab, name);
            }
        });
        ui.separator();
        match self.tab {
            Tab::Tree => tree::show(self, ui, state),
            Tab::Materials => styles::materials(ui, state),
            Tab::Lights => styles::lights(ui, state),
        }
    }
}

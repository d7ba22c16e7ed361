//! What the page says of itself besides its picture: for people who hear their screen, and for tests. A canvas tells
//! neither anything.

use crate::host::Page;
use crate::state::Mode;
use crate::state::State;
use eframe::egui;

/// See the module.
pub struct Report {
    /// Where there is no page, nobody is told anything.
    page: Option<Page>,
    told: Vec<(&'static str, String)>,
}

impl Default for Report {
    fn default() -> Self {
        Self { page: Page::find().ok(), told: Vec::new() }
    }
}

impl Report {
    /// Tells what has changed.
    pub fn tell(&mut self, state: &State, view: Option<egui::Rect>) {
        let Some(page) = &self.page else { return };
        let now = attributes(state, view);
        for new in &now {
            if !self.told.contains(new) {
                // A canvas that was taken out of its page needs no attributes.
                let _ = page.canvas.set_attribute(new.0, &new.1);
            }
        }
        self.told = now;
    }
}

/// Attributes of the canvas: `data-view` is the view's place in points of the canvas and its size in pixels.
fn attributes(state: &State, view: Option<egui::Rect>) -> Vec<(&'static str, String)> {
    let place = view.map_or_else(String::new, |view| format!("{} {}", view.min.x, view.min.y));
    let [width, height] = state.size;
    let document = state.document.as_ref();
    let scene = document.and_then(|document| document.path.file_name());
    let traced = state.traced.as_ref();
    let number = |camera: dotray_scene::model::Camera| crate::edit::camera_line(&camera);
    let hidden: usize = state.hidden.ranges().iter().map(|range| range.len()).sum();
    let texts: Vec<&str> = state.messages.iter().map(|message| message.text.as_str()).collect();
    vec![
        ("aria-label", sentence(state)),
        ("data-view", format!("{place} {width} {height}")),
        ("data-scene", scene.map_or_else(String::new, |name| name.to_string_lossy().into_owned())),
        ("data-shapes", document.map_or(0, |document| document.shape_count).to_string()),
        ("data-mode", if state.mode == Mode::Traced { "traced" } else { "preview" }.to_owned()),
        ("data-prepared", state.prepared.to_string()),
        ("data-traced", traced.is_some_and(|traced| traced.image.is_some()).to_string()),
        ("data-camera", state.camera().map_or_else(String::new, number)),
        ("data-tracers", state.tracers.map_or_else(String::new, |count| count.to_string())),
        ("data-hidden", hidden.to_string()),
        ("data-rays", state.rays.as_ref().map_or(0, |rays| rays.rows.len()).to_string()),
        ("data-selected", state.selection.as_ref().map_or_else(String::new, |it| it.name.clone())),
        ("data-messages", texts.join("\n")),
        ("data-notice", state.notice.clone()),
        ("data-device", state.raster.as_ref().map_or_else(String::new, |raster| raster.device_name())),
    ]
}

/// What a reader of screens says of the canvas.
fn sentence(state: &State) -> String {
    let scene = match &state.document {
        Some(document) => {
            let name = document.path.file_name().unwrap_or(document.path.as_os_str()).to_string_lossy();
            format!("{name}, {} shapes", document.shape_count)
        }
        None => "no scene: drop a .ray file here, with its textures".to_owned(),
    };
    let mode = match (&state.traced, state.mode) {
        (Some(traced), _) if traced.image.is_some() => "traced",
        (Some(_), _) => "being traced",
        (None, Mode::Traced) => "waits for the tracer",
        (None, Mode::Preview) => "preview",
    };
    let errors = state.messages.iter().filter(|message| message.error).count();
    let faults = if errors > 0 { format!("; {errors} errors in the scene") } else { String::new() };
    let left_out = if state.hidden.is_empty() { "" } else { ", hidden shapes left out" };
    format!("rayview: {scene}; {mode}{left_out}{faults}")
}

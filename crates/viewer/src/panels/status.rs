//! The line below: what is shown, by what, and what lies under the pointer.

use crate::state::State;
use dotray_accel::simd::level;
use dotray_accel::simd::level_name;
use dotray_render::progress::Advance;
use eframe::egui;
use eframe::egui::Ui;

pub fn show(ui: &mut Ui, state: &State) {
    ui.horizontal(|ui| {
        let device = state.raster.as_ref().map_or_else(String::new, |raster| raster.device_name());
        // Some drivers have long names, and what else stands here changes.
        let widest = 0.35 * ui.available_width();
        ui.scope(|ui| {
            ui.set_max_width(widest);
            ui.add(egui::Label::new(&device).truncate())
                .on_hover_text(format!("What draws the preview: {device}"));
        });
        ui.separator();
        if let Some(document) = &state.document {
            let name = document.path.file_name().unwrap_or(document.path.as_os_str()).to_string_lossy();
            ui.label(format!("{name}: {} shapes", document.shape_count));
            ui.separator();
        }
        ui.label(format!("{} × {}", state.size[0], state.size[1]));
        ui.separator();
        let tracer = match state.tracers {
            Some(threads) => format!(
                "Traced by {threads} thread{}, {}",
                if threads == 1 { "" } else { "s" },
                level_name(level())
            ),
            None => "Traced by the program that serves this page".to_owned(),
        };
        ui.label(traced(state)).on_hover_text(tracer);
        if let Some((seen, document)) = state.hovered.zip(state.document.as_ref()) {
            ui.separator();
            let material = super::rays::material_name(document, seen.material);
            ui.label(format!("{} · {material}", document.shape_name(seen.number)));
        }
        if !state.notice.is_empty() {
            ui.separator();
            ui.add(egui::Label::new(&state.notice).truncate());
        }
    });
}

/// The per cent that are finished, and the seconds left where there are some.
fn under_way(progress: &Advance) -> String {
    let left = progress.seconds_left.filter(|seconds| *seconds >= 1.0);
    let left = left.map_or_else(String::new, |seconds| format!(", {seconds:.0} s left"));
    format!("tracing: {} %{left}", progress.percent())
}

/// How far the traced picture has come.
fn traced(state: &State) -> String {
    if state.document.is_some() && !state.prepared {
        let faulty = state.messages.iter().any(|message| message.error);
        return if faulty { "cannot be traced" } else { "preparing to trace …" }.to_owned();
    }
    let left_out = if state.hidden.is_empty() { "" } else { ", hidden shapes left out" };
    match &state.traced {
        Some(traced) if traced.image.is_some() => {
            format!("traced in {:.2} s{left_out}", traced.progress.seconds)
        }
        Some(traced) => format!("{}{left_out}", under_way(&traced.progress)),
        None => "preview".to_owned(),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_time_left_is_told_once_it_is_known_and_counts() {
        let at = |finished_pixels, seconds_left| {
            under_way(&Advance { finished_pixels, total_pixels: 300, seconds_left, ..Advance::default() })
        };
        assert_eq!(at(0, None), "tracing: 0 %");
        assert_eq!(at(299, Some(0.4)), "tracing: 99 %");
        assert_eq!(at(150, Some(12.3)), "tracing: 50 %, 12 s left");
    }
}

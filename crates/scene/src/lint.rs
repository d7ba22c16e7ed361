//! What is no fault but hardly meant: shapes that no ray will meet, files that nothing places, colours from 0 to 255.
//! Asked for by whoever checks a scene, not by whoever renders it.

mod duplicates;
mod enclosed;

use crate::bounds::world_bounds;
use crate::diagnostic::Diagnostic;
use crate::diagnostic::Severity;
use crate::diagnostic::Sink;
use crate::model::Color;
use crate::model::Item;
use crate::model::SceneFile;
use crate::number::General;
use crate::resolved::Resolved;
use crate::resolved::Run;
use crate::span::FileId;
use crate::span::Span;
use dotray_geometry::Aabb;
use dotray_geometry::Affine;
use dotray_geometry::Shape;
use dotray_geometry::Vec3;

/// Every code that [`lint`] can give, with what it means.
pub const LINT_CODES: &[(&str, Severity, &str)] = &[
    ("color-range", Severity::Warning, "A colour looks as if it ran from 0 to 255; 1 is full."),
    (
        "duplicate-shape",
        Severity::Warning,
        "A shape stands twice at the same place; rays meet the first one only.",
    ),
    ("empty-view", Severity::Warning, "The camera looks away from all shapes."),
    ("enclosed-shape", Severity::Warning, "A shape stands wholly inside an opaque one; no ray meets it."),
    (
        "unused-include",
        Severity::Warning,
        "A `#ray_file` that no `#ray_file_instance` places: its shapes are nowhere.",
    ),
    (
        "vanishing-shape",
        Severity::Warning,
        "A shape is too small for where it stands: double precision cannot tell its sides apart.",
    ),
];

/// The places of a shape, and how it stands in the world.
struct Standing<'a> {
    run: &'a Run,
    /// The entry of its kind's list.
    entry: usize,
    shape: Shape,
    world_from_object: &'a Affine,
}

impl Standing<'_> {
    fn span(&self, scene: &Resolved) -> Span {
        let file = scene.files.get(self.run.file.0 as usize);
        file.and_then(|file| file.shape_span(self.run.file, self.run.kind, self.entry)).unwrap_or_default()
    }

    fn word(&self) -> &'static str {
        self.run.kind.directive()
    }

    fn bounds(&self) -> Aabb {
        self.shape.world_bounds(self.world_from_object)
    }
}

/// Every shape, instances expanded, in file order.
fn standing(scene: &Resolved) -> impl Iterator<Item = Standing<'_>> {
    scene.runs.iter().flat_map(move |run| {
        let file = scene.files.get(run.file.0 as usize);
        let frame = scene.frames.get(run.frame as usize);
        let entries = run.first as usize..run.first as usize + run.count as usize;
        entries.filter_map(move |entry| {
            let shape = file?.shape(run.kind, entry)?;
            Some(Standing { run, entry, shape, world_from_object: frame? })
        })
    })
}

/// Looks a scene over. Warnings only; of each kind a few, the rest is counted.
pub fn lint(scene: &Resolved) -> Vec<Diagnostic> {
    const WARNINGS_OF_A_KIND: usize = 5;
    let mut sink = Sink::new(0, WARNINGS_OF_A_KIND);
    unused_includes(&scene.files, &mut sink);
    colors(&scene.files, &mut sink);
    vanishing(scene, &mut sink);
    duplicates::find(scene, &mut sink);
    enclosed::find(scene, &mut sink);
    empty_view(scene, &mut sink);
    sink.finish()
}

/// Only files that are placed themselves are looked at: what an unused file includes is told by the one message.
fn unused_includes(files: &[SceneFile], sink: &mut Sink) {
    let mut placed = vec![false; files.len()];
    let mut open = vec![FileId(0)];
    while let Some(file) = open.pop() {
        let Some(known) = placed.get_mut(file.0 as usize) else { continue };
        let Some(file) = files.get(file.0 as usize).filter(|_| !std::mem::replace(known, true)) else {
            continue;
        };
        let mut used = vec![false; file.includes.len()];
        for item in &file.items {
            let Item::Instance(number) = *item else { continue };
            if let (Some(used), Some(include)) =
                (used.get_mut(number as usize), file.includes.get(number as usize))
            {
                *used = true;
                open.push(include.value.file);
            }
        }
        for ((number, include), used) in file.includes.iter().enumerate().zip(used) {
            if !used {
                sink.warn("unused-include", || {
                    let message = format!("`{}` is included but never placed", include.value.name);
                    Diagnostic::warning("unused-include", message)
                        .at(include.span)
                        .label("its shapes are nowhere in the scene")
                        .help(format!("`#ray_file_instance {number}` places it"))
                });
            }
        }
    }
}

/// Lamps may be as bright as they like, so only what is lit is looked at.
fn colors(files: &[SceneFile], sink: &mut Sink) {
    for file in files {
        for (what, color) in [("background", &file.background), ("ambient light", &file.ambient)] {
            if let Some(placed) = color {
                judge_color(what, placed.value, placed.span, sink);
            }
        }
        for placed in &file.materials {
            let material = &placed.value;
            let all = [
                ("ambient", material.ambient),
                ("diffuse", material.diffuse),
                ("specular", material.specular),
            ];
            for (what, color) in all {
                judge_color(&format!("material's {what} colour"), color, placed.span, sink);
            }
        }
    }
}

fn judge_color(what: &str, color: Color, span: Span, sink: &mut Sink) {
    let bytes = 32.0..=255.0;
    let channels = color.to_array();
    let whole = channels.iter().all(|channel| channel.fract() == 0.0 && *channel >= 0.0);
    if !whole || !bytes.contains(&color.max_element()) {
        return;
    }
    sink.warn("color-range", || {
        let shown = |scale: f64| channels.map(|channel| rounded(channel * scale)).join(" ");
        Diagnostic::warning("color-range", format!("the {what} `{}` is far above 1", shown(1.0)))
            .at(span)
            .label("looks like 0 to 255")
            .help(format!("colours run from 0 to 1: `{}`", shown(1.0 / 255.0)))
    });
}

/// Three decimals are more than eight bits hold.
fn rounded(channel: f64) -> String {
    General((channel * 1000.0).round() / 1000.0).to_string()
}

fn vanishing(scene: &Resolved, sink: &mut Sink) {
    /// Boxes are padded by some units in the last place, which must not count as an extent.
    const RELATIVE: f64 = 1e-14;
    for standing in standing(scene) {
        let bounds = standing.bounds();
        let far = bounds.min.abs().max(bounds.max.abs()).max_element();
        if bounds.size().max_element() <= RELATIVE * far {
            sink.warn("vanishing-shape", || {
                let message = format!(
                    "`{}` is too small for where it stands: {} units from the origin its sides are one number",
                    standing.word(),
                    General(far)
                );
                Diagnostic::warning("vanishing-shape", message).at(standing.span(scene)).label("no ray can meet it")
            });
        }
    }
}

/// A box around everything that lies behind the camera is enough to know; what lies beside the picture depends on the
/// picture's shape.
fn empty_view(scene: &Resolved, sink: &mut Sink) {
    let Some(camera) = scene.files.first().and_then(|file| file.camera) else { return };
    let bounds = world_bounds(scene);
    let ahead = |corner: Vec3| (corner - scene.camera.position).dot(scene.camera.direction) > 0.0;
    if bounds.is_empty() || corners(bounds).into_iter().any(ahead) {
        return;
    }
    sink.warn("empty-view", || {
        let towards = (bounds.center() - scene.camera.position).to_array().map(|x| General(x).to_string());
        Diagnostic::warning("empty-view", "the camera looks away from all shapes: they are behind it")
            .at(camera.span)
            .label("sees the background only")
            .help(format!("the middle of the shapes lies in the direction `{}`", towards.join(" ")))
    });
}

fn corners(bounds: Aabb) -> [Vec3; 8] {
    let (a, b) = (bounds.min, bounds.max);
    [(a.x, a.y), (a.x, b.y), (b.x, a.y), (b.x, b.y)]
        .map(|(x, y)| [Vec3::new(x, y, a.z), Vec3::new(x, y, b.z)])
        .as_flattened()
        .try_into()
        .unwrap_or([a; 8])
}

//! From the scene as written to the scene with nothing left to guess: cumulative transforms, material and texture
//! numbers, defaults. The only place where ambiguity is settled.

mod camera;
mod flatten;
mod material;

pub use material::resolve_texture;

use crate::diagnostic::Diagnostic;
use crate::diagnostic::Severity;
use crate::diagnostic::Sink;
use crate::dialect::Dialect;
use crate::model::Scene;
use crate::model::SceneFile;
use crate::model::Tint;
use crate::resolved::Resolved;
use crate::walk::DEFAULT_STEPS;
use dotray_geometry::Vec3;

/// What [`resolve`] finds out.
#[derive(Clone, Debug)]
pub struct Outcome {
    /// The scene; `None` where there is an error.
    pub resolved: Option<Resolved>,
    /// Errors and warnings.
    pub diagnostics: Vec<Diagnostic>,
}

/// How much instances may multiply. What the files write out themselves is never refused, but for the number of
/// shapes, which must fit 32 bits.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Limits {
    /// Steps of the tree.
    pub steps: u64,
    /// Runs of shapes, and with them transforms.
    pub runs: u64,
    /// Shapes.
    pub shapes: u64,
}

impl Default for Limits {
    fn default() -> Self {
        Self { steps: DEFAULT_STEPS, runs: 10_000_000, shapes: 1 << 31 }
    }
}

const MOST_ERRORS: usize = 20;
const MOST_WARNINGS_OF_A_KIND: usize = 5;

/// Every code that resolving a scene can give, with what it means. Some are also the reader's.
pub const RESOLVER_CODES: &[(&str, Severity, &str)] = &[
    (
        "broken-scene",
        Severity::Error,
        "A scene made by a program, not read from a file, names an item that does not exist.",
    ),
    ("include-cycle", Severity::Error, "A file includes itself, be it by way of others."),
    (
        "index-of-refraction",
        Severity::Error,
        "A material transmits (kt > 0), but its index of refraction is not above 0.",
    ),
    (
        "material-range",
        Severity::Warning,
        "ks or kt is below 0; it is used as written, but for the highlight's exponent.",
    ),
    (
        "material-text",
        Severity::Warning,
        "A clause of a material's text has a bad key or value; that word is ignored.",
    ),
    ("no-camera", Severity::Warning, "The scene has no camera; one that frames the scene is used."),
    ("no-light", Severity::Warning, "The scene has no light."),
    ("no-shape", Severity::Warning, "The scene has no shape."),
    (
        "singular-product",
        Severity::Error,
        "The matrices of nested groups multiply to one that is singular or not finite.",
    ),
    ("too-many-errors", Severity::Error, "There are more errors than are shown."),
    (
        "too-many-shapes",
        Severity::Error,
        "The scene has too many shapes, or its instances multiply too often.",
    ),
    ("unknown-material", Severity::Error, "A shape names a material that the file does not have."),
    ("unknown-texture", Severity::Error, "A material names a texture that the file does not have."),
];

/// Resolves a scene within the default [`Limits`].
pub fn resolve(scene: Scene) -> Outcome {
    resolve_within(scene, &Limits::default())
}

/// Resolves a scene: takes it over, so that its lists of shapes are never copied.
pub fn resolve_within(scene: Scene, limits: &Limits) -> Outcome {
    let mut sink = Sink::new(MOST_ERRORS, MOST_WARNINGS_OF_A_KIND);
    let materials = material::resolve(&scene.files, &mut sink);
    material::check_shapes(&scene.files, &mut sink);
    let flat = flatten::flatten(&scene.files, &materials.bases, limits, &mut sink);
    let main = scene.files.first();
    let light_count = main.map_or(0, |file| file.lights.len());
    if light_count == 0 {
        warn(&mut sink, "no-light", "the scene has no light: only ambient light and emission show");
    }
    if flat.shape_count == 0 && sink.errors() == 0 {
        warn(&mut sink, "no-shape", "the scene has no shape: the picture is all background");
    }
    let color = |place: fn(&SceneFile) -> Option<Vec3>| main.and_then(place).unwrap_or(Vec3::ZERO);
    let background = color(|file| file.background.map(|placed| placed.value));
    let conventions = main.map_or(Dialect::Slides, |file| file.dialect).conventions();
    let tints = main.map_or(&[][..], |file| &file.tints).iter().copied();
    let mut resolved = Resolved {
        camera: main.and_then(|file| file.camera).map_or(camera::FALLBACK, |placed| placed.value),
        background,
        secondary_background: if conventions.background_behind_surfaces { background } else { Vec3::ZERO },
        ambient: color(|file| file.ambient.map(|placed| placed.value)),
        lights: main.map_or_else(Vec::new, |file| file.lights.iter().map(|placed| placed.value).collect()),
        tints: tints.chain(std::iter::repeat(Tint::PLAIN)).take(light_count).collect(),
        materials: materials.materials,
        textures: materials.textures,
        frames: flat.frames,
        runs: flat.runs,
        tree: flat.tree,
        shape_count: flat.shape_count,
        files: scene.files,
    };
    if sink.errors() > 0 {
        return Outcome { resolved: None, diagnostics: sink.finish() };
    }
    if resolved.files.first().is_none_or(|file| file.camera.is_none()) {
        resolved.camera = camera::framing(&resolved);
        sink.warn("no-camera", || camera::warning(&resolved.camera));
    }
    Outcome { resolved: Some(resolved), diagnostics: sink.finish() }
}

/// A warning about the scene as a whole.
fn warn(sink: &mut Sink, code: &'static str, message: &str) {
    sink.warn(code, || Diagnostic::warning(code, message));
}

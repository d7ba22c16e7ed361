//! Text to picture in one call.

use dotray_image::Image;
use dotray_render::Options;
use dotray_render::PrepareOptions;
use dotray_render::RenderError;
use dotray_render::Silent;
use dotray_render::World;
use dotray_render::on_threads;
use dotray_scene::Diagnostic;
use dotray_scene::files::Disk;
use dotray_scene::load::LoadOptions;
use dotray_scene::load::Loaded;
use dotray_scene::load::load;
use dotray_scene::load::load_text;
use dotray_scene::report::render_text as messages_as_text;
use dotray_scene::resolve::resolve;
use std::fmt;
use std::path::Path;

/// Why there is no picture.
#[derive(Debug, thiserror::Error)]
pub enum Error {
    /// The scene is at fault.
    #[error(transparent)]
    Scene(SceneError),
    /// The options are, or the machine.
    #[error(transparent)]
    Render(#[from] RenderError),
}

/// What is wrong with a scene: all errors and warnings, as data and as text.
#[derive(Debug)]
pub struct SceneError {
    /// Errors, and the warnings beside them.
    pub diagnostics: Vec<Diagnostic>,
    text: String,
}

impl fmt::Display for SceneError {
    /// The messages with their places, as the program prints them.
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(self.text.trim_end())
    }
}

impl std::error::Error for SceneError {}

/// Renders the scene of a file. Warnings are passed over; whoever wants them takes the steps one by one, as the
/// program does: [`dotray_scene::load::load`], [`dotray_scene::resolve::resolve`], [`World::prepare`],
/// [`dotray_render::render`].
///
/// # Errors
/// [`Error::Scene`] with every fault that was found, [`Error::Render`] for options that make no sense.
pub fn render_file(path: &Path, options: &Options) -> Result<Image, Error> {
    options.validate()?;
    let load = || load(path, &Disk, &LoadOptions::default());
    picture(on_threads(options.threads, load)?, options)
}

/// Renders a scene given as text; the names of textures in it are relative to the working directory.
///
/// # Errors
/// As [`render_file`].
///
/// ```
/// let error = dotray::render_text("#shape_spere 0 0 0 0 1", &dotray::Options::default()).unwrap_err();
/// assert!(error.to_string().contains("#shape_sphere"), "{error}");
/// ```
pub fn render_text(text: &str, options: &Options) -> Result<Image, Error> {
    options.validate()?;
    let load = || load_text("<text>", text, &Disk, &LoadOptions::default());
    picture(on_threads(options.threads, load)?, options)
}

fn picture(loaded: Loaded, options: &Options) -> Result<Image, Error> {
    let Loaded { scene, mut diagnostics, sources, .. } = loaded;
    let outcome = scene.map(resolve);
    let resolved = outcome.and_then(|outcome| {
        diagnostics.extend(outcome.diagnostics);
        outcome.resolved
    });
    let prepare = PrepareOptions { threads: options.threads, ..PrepareOptions::default() };
    let world = resolved.and_then(|resolved| {
        World::prepare(resolved, &Disk, &prepare).map_err(|faults| diagnostics.extend(faults)).ok()
    });
    match world {
        Some(world) => Ok(dotray_render::render(&world, options, &Silent)?.image),
        None => {
            let text = messages_as_text(&diagnostics, &sources, false);
            Err(Error::Scene(SceneError { diagnostics, text }))
        }
    }
}

//! One test's scene in memory, and pictures of it: the truth, and those of wrong variants.

use dotray_image::EncodeOptions;
use dotray_image::Format;
use dotray_image::Image;
use dotray_image::Limits;
use dotray_image::decode;
use dotray_image::encode;
use dotray_render::Options;
use dotray_render::PrepareOptions;
use dotray_render::Silent;
use dotray_render::World;
use dotray_render::estimate::check_memory;
use dotray_render::estimate::machine_memory;
use dotray_scene::Diagnostic;
use dotray_scene::Files;
use dotray_scene::Resolved;
use dotray_scene::Scene;
use dotray_scene::load::LoadOptions;
use dotray_scene::load::Loaded;
use dotray_scene::load::load;
use dotray_scene::model::Color;
use dotray_scene::report::render_text;
use dotray_scene::resolve::resolve;
use std::io;
use std::path::Path;
use std::path::PathBuf;

use crate::bent;
use crate::bent::Bend;
use crate::error::GradeError;
use crate::snapshot::Recorder;
use crate::snapshot::Snapshot;
use crate::suite::Suite;
use crate::suite::Test;
use crate::variants::Change;

/// A scene that no file can change any more.
#[derive(Debug)]
pub struct Case {
    /// All files of the scene.
    pub files: Snapshot,
    /// The picture that is wanted, as the suite's format stores it.
    pub truth: Image,
    /// The background's colour, stored likewise.
    pub background: [f32; 3],
    scene: PathBuf,
    options: Options,
    format: Format,
}

impl Case {
    /// Reads the scene of a test of the suite and makes the picture that is wanted.
    ///
    /// # Errors
    /// [`GradeError::Scene`] with the messages about the scene.
    pub fn new(suite: &Suite, test: &Test) -> Result<Self, GradeError> {
        let fault = |message: String| GradeError::Scene { test: test.name.clone(), message };
        let recorder = Recorder::new(&suite.folder);
        let mut background = Color::ZERO;
        let making = Making {
            files: &recorder,
            textures: &recorder,
            scene: &test.scene,
            options: &test.options,
            prepare: PrepareOptions { threads: Some(1), ..PrepareOptions::default() },
        };
        let truth = making.picture(|_| (), |resolved| background = resolved.background).map_err(fault)?;
        let background = background.to_array().map(|value| sample(value as f32, suite.format));
        Ok(Self {
            files: recorder.snapshot(),
            truth: stored(truth, suite.format),
            background,
            scene: test.scene.clone(),
            options: test.options.clone(),
            format: suite.format,
        })
    }

    /// The picture of a wrong variant, as the suite's format stores it.
    ///
    /// # Errors
    /// Why there is none: the change makes no sense in this scene.
    pub fn variant(&self, change: &Change) -> Result<Image, String> {
        let size = (self.options.width, self.options.height);
        let picture = match *change {
            Change::Scene(change) => self.making(&self.files, &self.options).picture(change, |_| ()),
            Change::Resolved(change) => {
                let change = |resolved: &mut Resolved| change(resolved, size);
                self.making(&self.files, &self.options).picture(|_| (), change)
            }
            Change::Options(change) => {
                let mut options = self.options.clone();
                change(&mut options);
                self.making(&self.files, &options).picture(|_| (), |_| ())
            }
            Change::Texture(change) => {
                let textures = Repainted { files: &self.files, change };
                self.making(&textures, &self.options).picture(|_| (), |_| ())
            }
            Change::Bend(bend) => self.making(&self.files, &self.options).bent(bend),
            Change::Picture(change) => Ok(change(&self.truth)),
            Change::Speckles => Err("it depends on the picture that is judged".to_owned()),
        };
        picture.map(|picture| stored(picture, self.format))
    }

    fn making<'a>(&'a self, textures: &'a dyn Files, options: &'a Options) -> Making<'a> {
        let prepare = PrepareOptions { threads: Some(1), ..PrepareOptions::default() };
        Making { files: &self.files, textures, scene: &self.scene, options, prepare }
    }
}

/// A picture as a format stores it, as far as comparing is concerned: between 0 and 1, what is no number black, and in
/// steps of 1/255 where the format holds whole numbers.
fn stored(mut image: Image, format: Format) -> Image {
    image.samples_mut().iter_mut().for_each(|value| *value = sample(*value, format));
    image
}

fn sample(value: f32, format: Format) -> f32 {
    let shown = clamped_sample(value);
    if format.is_float() { shown } else { (255.0 * shown).round() / 255.0 }
}

fn clamped_sample(value: f32) -> f32 {
    if value.is_nan() { 0.0 } else { value.clamp(0.0, 1.0) }
}

/// A picture of somebody else, brought to 0…1; what is no number becomes black.
pub fn clamped(mut image: Image) -> Image {
    image.samples_mut().iter_mut().for_each(|value| *value = clamped_sample(*value));
    image
}

/// The way from files to a picture, the same for the truth and for all that is wrong.
struct Making<'a> {
    files: &'a dyn Files,
    textures: &'a dyn Files,
    scene: &'a Path,
    options: &'a Options,
    prepare: PrepareOptions,
}

impl Making<'_> {
    fn picture(
        &self,
        change_scene: impl FnOnce(&mut Scene),
        change_resolved: impl FnOnce(&mut Resolved),
    ) -> Result<Image, String> {
        let world = self.world(change_scene, change_resolved)?;
        let rendering = dotray_render::render(&world, self.options, &Silent);
        rendering.map(|rendering| rendering.image).map_err(|error| error.to_string())
    }

    fn bent(&self, bend: Bend) -> Result<Image, String> {
        let mut materials = Vec::new();
        let world = self.world(|_| (), |resolved| materials.clone_from(&resolved.materials))?;
        bent::picture(&world, &materials, self.options, bend)
    }

    fn world(
        &self,
        change_scene: impl FnOnce(&mut Scene),
        change_resolved: impl FnOnce(&mut Resolved),
    ) -> Result<World, String> {
        let Loaded { scene, diagnostics, sources, .. } =
            load(self.scene, self.files, &LoadOptions::default());
        let text =
            |diagnostics: &[Diagnostic]| render_text(diagnostics, &sources, false).trim_end().to_owned();
        let mut scene = scene.ok_or_else(|| text(&diagnostics))?;
        change_scene(&mut scene);
        let outcome = resolve(scene);
        let mut resolved = outcome.resolved.ok_or_else(|| text(&outcome.diagnostics))?;
        change_resolved(&mut resolved);
        check_memory(&resolved, &self.prepare, Some(self.options), machine_memory())
            .map_err(|refused| refused.to_string())?;
        World::prepare(resolved, self.textures, &self.prepare).map_err(|faults| text(&faults))
    }
}

/// Files whose pictures are changed; in float, so that nothing else changes.
struct Repainted<'a> {
    files: &'a Snapshot,
    change: fn(&Image) -> Image,
}

impl Files for Repainted<'_> {
    fn read(&self, path: &Path) -> io::Result<Vec<u8>> {
        let bytes = self.files.read(path)?;
        let image =
            decode(&bytes, Format::from_path(path).ok(), &Limits::default()).map_err(io::Error::other)?;
        encode(&(self.change)(&image), Format::Pfm, &EncodeOptions::default()).map_err(io::Error::other)
    }

    fn identity(&self, path: &Path) -> PathBuf {
        self.files.identity(path)
    }
}

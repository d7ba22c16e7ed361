//! A scene under construction: the same typed lists that the reader of `.ray` text fills.

use crate::arrays::matrix;
use crate::files::Carried;
use crate::messages::Told;
use crate::messages::scene_error;
use crate::messages::told;
use crate::options::PrepareChoices;
use crate::signals::awaited;
use crate::view::CameraNumbers;
use crate::view::LightNumbers;
use crate::view::camera;
use crate::view::camera_numbers;
use crate::view::light;
use crate::view::light_numbers;
use crate::world::World as PyWorld;
use dotray_geometry::Vec3;
use dotray_render::World;
use dotray_scene::Diagnostic;
use dotray_scene::Dialect;
use dotray_scene::Files;
use dotray_scene::LoadOptions;
use dotray_scene::Scene;
use dotray_scene::Sources;
use dotray_scene::convert::convert;
use dotray_scene::lint::lint;
use dotray_scene::load_text;
use dotray_scene::model::Item;
use dotray_scene::model::Material;
use dotray_scene::model::Placed;
use dotray_scene::model::SceneFile;
use dotray_scene::resolve::resolve;
use dotray_scene::resolve::resolve_texture;
use dotray_scene::span::Span;
use dotray_scene::write::write_to;
use pyo3::exceptions::PyValueError;
use pyo3::prelude::*;
use pyo3::types::PyDict;
use std::collections::HashMap;
use std::path::Path;
use std::path::PathBuf;

/// A scene under construction.
#[pyclass(module = "dotray._dotray")]
#[derive(Default)]
pub struct Builder {
    pub(crate) scene: Scene,
    sources: Sources,
    /// What there was to say of the text.
    diagnostics: Vec<Diagnostic>,
    carried: Carried,
}

/// A material as the Python half describes it.
#[derive(FromPyObject)]
struct MaterialNumbers {
    ambient: [f64; 3],
    diffuse: [f64; 3],
    specular: [f64; 3],
    emissive: [f64; 3],
    k_specular: f64,
    k_transmission: f64,
    index_of_refraction: f64,
    text: String,
}

/// A value that no text says.
pub fn unplaced<T>(value: T) -> Placed<T> {
    Placed { value, span: Span::default() }
}

impl Builder {
    /// The file that things are added to.
    pub(crate) fn file(&mut self) -> &mut SceneFile {
        if self.scene.files.is_empty() {
            self.scene.files.push(SceneFile::default());
        }
        &mut self.scene.files[0]
    }

    /// Everything that there is to say, and the scene where it can be rendered.
    fn resolved(&mut self) -> (Vec<Diagnostic>, Option<dotray_scene::Resolved>) {
        let mut scene = std::mem::take(&mut self.scene);
        for file in &mut scene.files {
            file.colors.sort_by_key(|list| (list.kind as u8, list.first));
        }
        let outcome = resolve(scene);
        let mut diagnostics = std::mem::take(&mut self.diagnostics);
        diagnostics.extend(outcome.diagnostics);
        (diagnostics, outcome.resolved)
    }
}

impl Builder {
    /// The scene in the words of the slides, or what those cannot say.
    fn translated(&self, scene: &Scene) -> PyResult<String> {
        let folder = |file: &SceneFile| file.path.parent().map(Path::to_owned).unwrap_or_default();
        let main = scene.files.first().map(folder).unwrap_or_default();
        let texture = |file: &SceneFile, name: &str| {
            let path = folder(file).join(name);
            path.strip_prefix(&main).unwrap_or(&path).to_string_lossy().into_owned()
        };
        let converted = convert(scene, Dialect::Slides, &texture);
        let converted = converted.map_err(|error| PyValueError::new_err(error.to_string()))?;
        let Some(lost) = converted.lost.first() else { return Ok(converted.text) };
        let place = lost.span.map_or_else(String::new, |span| format!("{}: ", self.sources.place(span)));
        let dialect = scene.files.first().map_or(Dialect::Slides, |file| file.dialect);
        Err(PyValueError::new_err(format!(
            "{place}{}; a file of the dialect {dialect} with something added can be saved only in the slides' words",
            lost.message
        )))
    }
}

#[pymethods]
impl Builder {
    /// An empty scene, with files that it brings along.
    #[new]
    fn new(carried: HashMap<PathBuf, Vec<u8>>) -> Self {
        Self { carried: Carried { files: carried }, ..Self::default() }
    }

    /// Reads a file into the empty scene; gives the paths and contents of all files that were read.
    fn load(&mut self, path: &str, text: Vec<u8>) -> PyResult<Vec<(PathBuf, Vec<u8>)>> {
        let loaded = load_text(path, text, &self.carried, &LoadOptions::default());
        let Some(scene) = loaded.scene else {
            return Err(scene_error(loaded.diagnostics, &loaded.sources));
        };
        (self.scene, self.sources, self.diagnostics) = (scene, loaded.sources, loaded.diagnostics);
        let numbers = (0..self.sources.len() as u32).map(dotray_scene::span::FileId);
        let file = |number| (self.sources.path(number).to_owned(), self.sources.bytes(number).to_vec());
        Ok(numbers.map(file).collect())
    }

    /// The paths and contents of the textures that the files name, as far as they can be read.
    fn textures(&self) -> Vec<(PathBuf, Vec<u8>)> {
        let files = self.scene.files.iter();
        let textures = files.flat_map(|file| file.textures.iter().map(move |placed| (file, placed)));
        let read = |(file, placed): (&SceneFile, &Placed<String>)| {
            let candidates = resolve_texture(&file.path, file.dialect, placed).candidates;
            candidates.into_iter().find_map(|path| self.carried.read(&path).ok().map(|bytes| (path, bytes)))
        };
        textures.filter_map(read).collect()
    }

    /// Camera, background, ambient light and lights of the scene so far.
    fn view<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyDict>> {
        let nothing = SceneFile::default();
        let file = self.scene.files.first().unwrap_or(&nothing);
        let told = PyDict::new(py);
        let color = |placed: Option<Placed<Vec3>>| placed.map(|placed| placed.value.to_array());
        told.set_item("camera", file.camera.map(|placed| camera_numbers(&placed.value)))?;
        told.set_item("background", color(file.background))?;
        told.set_item("ambient", color(file.ambient))?;
        let lights = file.lights.iter().map(|placed| light_numbers(py, &placed.value));
        told.set_item("lights", lights.collect::<PyResult<Vec<_>>>()?)?;
        Ok(told)
    }

    fn clear_lights(&mut self) {
        self.file().lights.clear();
        self.file().tints.clear();
    }

    fn camera(&mut self, numbers: CameraNumbers) {
        self.file().camera = Some(unplaced(camera(numbers)));
    }

    fn background(&mut self, color: [f64; 3]) {
        self.file().background = Some(unplaced(Vec3::from_array(color)));
    }

    fn ambient(&mut self, color: [f64; 3]) {
        self.file().ambient = Some(unplaced(Vec3::from_array(color)));
    }

    #[pyo3(name = "light")]
    fn add_light(&mut self, numbers: LightNumbers) -> PyResult<()> {
        let light = light(&numbers)?;
        self.file().lights.push(unplaced(light));
        Ok(())
    }

    /// Names an image; gives its number.
    fn texture(&mut self, name: String) -> u32 {
        let textures = &mut self.file().textures;
        textures.push(unplaced(name));
        textures.len() as u32 - 1
    }

    /// Adds a material; gives its number.
    fn material(&mut self, numbers: MaterialNumbers, texture: Option<u32>) -> i32 {
        let materials = &mut self.file().materials;
        materials.push(unplaced(Material {
            ambient: Vec3::from_array(numbers.ambient),
            diffuse: Vec3::from_array(numbers.diffuse),
            specular: Vec3::from_array(numbers.specular),
            emissive: Vec3::from_array(numbers.emissive),
            k_specular: numbers.k_specular,
            k_transmission: numbers.k_transmission,
            index_of_refraction: numbers.index_of_refraction,
            texture,
            bump: None,
            text: numbers.text,
            weights: None,
        }));
        materials.len() as i32 - 1
    }

    /// Opens a group with a matrix, row by row.
    fn open_group(&mut self, rows: [f64; 16]) {
        let file = self.file();
        let number = file.groups.len() as u32;
        file.groups.push(unplaced(matrix(rows)));
        file.items.push(Item::Open(number));
    }

    fn close_group(&mut self) {
        self.file().items.push(Item::Close);
    }

    /// Everything that there is to say about the scene, which is then empty.
    fn check(&mut self) -> Vec<Told> {
        let (mut diagnostics, resolved) = self.resolved();
        if let Some(resolved) = &resolved {
            diagnostics.extend(lint(resolved));
        }
        told(&diagnostics, &self.sources)
    }

    /// The scene as `.ray` text; colours of single shapes become materials. What was added to a file of another dialect
    /// may have no words there: then all of it is said in those of the slides.
    fn text(&mut self, changed: bool) -> PyResult<String> {
        let mut scene = std::mem::take(&mut self.scene);
        if scene.files.is_empty() {
            scene.files.push(SceneFile::default());
        }
        let file = &mut scene.files[0];
        file.colors.sort_by_key(|list| (list.kind as u8, list.first));
        file.spell_out_colors();
        if changed && file.dialect != Dialect::Slides {
            return self.translated(&scene);
        }
        let file = &scene.files[0];
        let mut text = String::new();
        write_to(file, &mut text).map_err(|error| PyValueError::new_err(error.to_string()))?;
        Ok(text)
    }

    /// Builds what rays meet; the scene is then empty. Also gives the warnings.
    fn build(&mut self, py: Python<'_>, choices: PrepareChoices) -> PyResult<(PyWorld, Vec<Told>)> {
        let prepare = choices.options()?;
        let mut this = std::mem::take(self);
        let (world, diagnostics, sources) = awaited(py, move || {
            let (mut diagnostics, resolved) = this.resolved();
            let world = resolved.and_then(|resolved| {
                let world = World::prepare(resolved, &this.carried, &prepare);
                world.map_err(|faults| diagnostics.extend(faults)).ok()
            });
            (world, diagnostics, this.sources)
        })?;
        match world {
            Some(world) => Ok((PyWorld::new(world), told(&diagnostics, &sources))),
            None => Err(scene_error(diagnostics, &sources)),
        }
    }
}

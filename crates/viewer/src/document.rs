//! A scene that was read for the screen: its text, its tree, its shapes for the GPU, and its materials and lights as
//! they are edited.

use crate::draft::draft;
use crate::edit::Change;
use crate::edit::EditError;
use crate::edit::changed;
use crate::edit::light_values;
use crate::edit::material_values;
use crate::outline::NodeKind;
use crate::outline::Outline;
use crate::outline::Row;
use crate::pack::Packed;
use crate::pictures::Pictures;
use dotray_scene::Diagnostic;
use dotray_scene::Dialect;
use dotray_scene::Files;
use dotray_scene::Resolved;
use dotray_scene::Scene;
use dotray_scene::Severity;
use dotray_scene::Sources;
use dotray_scene::load::LoadOptions;
use dotray_scene::load::Loaded;
use dotray_scene::load::load;
use dotray_scene::model::Camera;
use dotray_scene::model::Color;
use dotray_scene::model::Light;
use dotray_scene::model::Material;
use dotray_scene::model::Placed;
use dotray_scene::model::SceneFile;
use dotray_scene::model::ShapeList;
use dotray_scene::report::render_text;
use dotray_scene::resolve::resolve;
use dotray_scene::resolved::Run;
use dotray_scene::span::FileId;
use dotray_scene::span::Span;
use std::collections::BTreeSet;
use std::path::Path;
use std::path::PathBuf;

/// A message about a scene.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Message {
    /// Whether the scene cannot be shown.
    pub error: bool,
    /// `file:line:column: error[code]: …` and the lines below it.
    pub text: String,
}

/// What of a file was edited.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
enum Edited {
    Material(usize, usize),
    Light(usize),
    Background,
    Ambient,
}

/// See the module.
#[derive(Debug)]
pub struct Document {
    /// The file asked for.
    pub path: PathBuf,
    /// The text.
    pub sources: Sources,
    /// The language.
    pub dialect: Dialect,
    /// The file's camera, or the one that frames a scene without.
    pub camera: Camera,
    /// The tree.
    pub outline: Outline,
    /// The shapes for the GPU.
    pub packed: Packed,
    /// The same with few shapes, where there are very many.
    pub draft: Option<Packed>,
    /// The textures for the GPU.
    pub pictures: Pictures,
    /// Warnings.
    pub messages: Vec<Message>,
    /// How many shapes there are.
    pub shape_count: u32,
    /// Materials, lights and colours as they are now.
    pub style: Resolved,
    /// The files without their shapes; lights and materials are those edited.
    files: Vec<SceneFile>,
    runs: Vec<Run>,
    edited: BTreeSet<Edited>,
}

/// A scene that was read: what the screen needs, and what the tracer does.
#[derive(Debug)]
pub struct Opened {
    /// For the screen.
    pub document: Document,
    /// For the tracer.
    pub resolved: Resolved,
}

/// Reads a scene.
///
/// # Errors
/// All that is wrong with it.
pub fn open(path: &Path, files: &dyn Files) -> Result<Opened, Vec<Message>> {
    let Loaded { scene, mut diagnostics, sources, dialect, .. } = load(path, files, &LoadOptions::default());
    let outcome = scene.map(resolve);
    let resolved = outcome.and_then(|outcome| {
        diagnostics.extend(outcome.diagnostics);
        outcome.resolved
    });
    let messages = messages(&diagnostics, &sources);
    let Some(resolved) = resolved else { return Err(messages) };
    let files_now: Vec<SceneFile> = resolved.files.iter().map(skeleton).collect();
    let style = style_of(&files_now).map_err(|_| messages.clone())?;
    let packed = Packed::new(&resolved);
    let document = Document {
        path: path.to_owned(),
        dialect,
        camera: resolved.camera,
        outline: Outline::new(&resolved),
        draft: draft(&packed),
        packed,
        pictures: Pictures::load(&resolved, files),
        messages,
        shape_count: resolved.shape_count,
        style,
        files: files_now,
        runs: resolved.runs.clone(),
        edited: BTreeSet::new(),
        sources,
    };
    Ok(Opened { document, resolved })
}

/// Diagnostics as messages.
pub fn messages(diagnostics: &[Diagnostic], sources: &Sources) -> Vec<Message> {
    let message = |diagnostic: &Diagnostic| Message {
        error: diagnostic.severity == Severity::Error,
        text: render_text(std::slice::from_ref(diagnostic), sources, false).trim_end().to_owned(),
    };
    diagnostics.iter().map(message).collect()
}

/// The file without its shapes, but with their places.
fn skeleton(file: &SceneFile) -> SceneFile {
    fn places<T>(list: &ShapeList<T>) -> ShapeList<T> {
        ShapeList { shapes: Vec::new(), materials: list.materials.clone(), starts: list.starts.clone() }
    }
    SceneFile {
        spheres: places(&file.spheres),
        cuboids: places(&file.cuboids),
        cylinders: places(&file.cylinders),
        cones: places(&file.cones),
        triangles: places(&file.triangles),
        indexed_triangles: places(&file.indexed_triangles),
        tori: places(&file.tori),
        open_sides: places(&file.open_sides),
        groups: file.groups.clone(),
        ..heads(file)
    }
}

/// What stands in the file besides its tree.
fn heads(file: &SceneFile) -> SceneFile {
    SceneFile {
        path: file.path.clone(),
        dialect: file.dialect,
        camera: file.camera,
        background: file.background,
        ambient: file.ambient,
        lights: file.lights.clone(),
        tints: file.tints.clone(),
        textures: file.textures.clone(),
        materials: file.materials.clone(),
        includes: file.includes.clone(),
        ..SceneFile::default()
    }
}

/// Lights, materials and colours, by the one resolver that there is.
fn style_of(files: &[SceneFile]) -> Result<Resolved, Vec<Diagnostic>> {
    let outcome = resolve(Scene { files: files.iter().map(heads).collect() });
    outcome.resolved.ok_or(outcome.diagnostics)
}

impl Document {
    /// The files, without their shapes.
    pub fn files(&self) -> &[SceneFile] {
        &self.files
    }

    /// Whether numbers can be changed here and written back: the arguments of other dialects mean other things.
    pub fn can_edit(&self) -> bool {
        self.dialect == Dialect::Slides
    }

    /// Whether there is anything to write back.
    pub fn is_edited(&self) -> bool {
        !self.edited.is_empty()
    }

    /// Changes a material.
    ///
    /// # Errors
    /// Why the scene does not allow it; it then stays as it was.
    pub fn set_material(&mut self, file: usize, index: usize, material: Material) -> Result<(), String> {
        self.edit(Edited::Material(file, index), |files| {
            if let Some(placed) = files.get_mut(file).and_then(|file| file.materials.get_mut(index)) {
                placed.value = material;
            }
        })
    }

    /// Changes a light.
    ///
    /// # Errors
    /// Why the scene does not allow it; it then stays as it was.
    pub fn set_light(&mut self, index: usize, light: Light) -> Result<(), String> {
        self.edit(Edited::Light(index), |files| {
            if let Some(placed) = files.first_mut().and_then(|file| file.lights.get_mut(index)) {
                placed.value = light;
            }
        })
    }

    /// Changes the background, where the file has one.
    ///
    /// # Errors
    /// Why the scene does not allow it; it then stays as it was.
    pub fn set_background(&mut self, color: Color) -> Result<(), String> {
        self.edit(Edited::Background, |files| set_color(files, |file| &mut file.background, color))
    }

    /// Changes the ambient light, where the file has one.
    ///
    /// # Errors
    /// Why the scene does not allow it; it then stays as it was.
    pub fn set_ambient(&mut self, color: Color) -> Result<(), String> {
        self.edit(Edited::Ambient, |files| set_color(files, |file| &mut file.ambient, color))
    }

    fn edit(&mut self, what: Edited, change: impl FnOnce(&mut [SceneFile])) -> Result<(), String> {
        let mut heads: Vec<SceneFile> = self.files.iter().map(heads).collect();
        change(&mut heads);
        match style_of(&heads) {
            Ok(style) => {
                for (file, new) in self.files.iter_mut().zip(heads) {
                    (file.lights, file.materials) = (new.lights, new.materials);
                    (file.background, file.ambient) = (new.background, new.ambient);
                }
                self.style = style;
                self.edited.insert(what);
                Ok(())
            }
            Err(faults) => Err(faults.first().map_or_else(String::new, |fault| fault.message.clone())),
        }
    }

    /// The files that were edited, with their new texts. Only the numbers that differ are other than before.
    ///
    /// # Errors
    /// [`EditError`] where the text is not as it was read.
    pub fn edited_texts(&self) -> Result<Vec<(FileId, Vec<u8>)>, EditError> {
        let mut changes: Vec<Vec<Change>> = vec![Vec::new(); self.files.len()];
        let mut add = |file: usize, span: Span, values: Vec<f64>| {
            if let Some(list) = changes.get_mut(file) {
                list.push(Change { span, values });
            }
        };
        for edited in &self.edited {
            match *edited {
                Edited::Material(file, index) => {
                    let placed = self.files.get(file).and_then(|file| file.materials.get(index));
                    placed.inspect(|placed| add(file, placed.span, material_values(&placed.value)));
                }
                Edited::Light(index) => {
                    let placed = self.files.first().and_then(|file| file.lights.get(index));
                    placed.inspect(|placed| add(0, placed.span, light_values(&placed.value)));
                }
                Edited::Background => {
                    let placed = self.files.first().and_then(|file| file.background);
                    placed.inspect(|placed| add(0, placed.span, placed.value.to_array().to_vec()));
                }
                Edited::Ambient => {
                    let placed = self.files.first().and_then(|file| file.ambient);
                    placed.inspect(|placed| add(0, placed.span, placed.value.to_array().to_vec()));
                }
            }
        }
        let files = changes.into_iter().enumerate().filter(|(_, changes)| !changes.is_empty());
        let text = |(file, changes): (usize, Vec<Change>)| {
            let file = FileId(file as u32);
            Ok((file, changed(self.sources.bytes(file), &changes)?))
        };
        files.map(text).collect()
    }

    /// `file:line` of a place, the file without its folders.
    pub fn place(&self, span: Span) -> String {
        let path = self.sources.path(span.file);
        let name = path.file_name().unwrap_or(path.as_os_str()).to_string_lossy();
        format!("{name}:{}", self.sources.position(span).line)
    }

    /// A shape's kind, such as `sphere`, and its directive's place.
    pub fn shape(&self, number: u32) -> Option<(&'static str, Span)> {
        let index = self.runs.partition_point(|run| run.first_shape <= number).checked_sub(1)?;
        let run = self.runs.get(index)?;
        let within = number.checked_sub(run.first_shape).filter(|within| *within < run.count)?;
        let file = self.files.get(run.file.0 as usize)?;
        let span = file.shape_span(run.file, run.kind, (run.first + within) as usize)?;
        Some((kind_name(run.kind.directive()), span))
    }

    /// `sphere 12 · scene.ray:34`
    pub fn shape_name(&self, number: u32) -> String {
        match self.shape(number) {
            Some((kind, span)) => format!("{kind} {number} · {}", self.place(span)),
            None => format!("shape {number}"),
        }
    }

    /// What a row of the tree says.
    pub fn row_name(&self, row: Row) -> String {
        if let Some(number) = row.shape {
            return self.shape_name(number);
        }
        let Some(node) = self.outline.nodes().get(row.node as usize) else { return String::new() };
        match node.kind {
            NodeKind::Group(file, group) => {
                let placed = self.files.get(file as usize).and_then(|file| file.groups.get(group as usize));
                let place = placed.map_or_else(String::new, |placed| self.place(placed.span));
                format!("group · {place} ({})", counted(&node.shapes))
            }
            NodeKind::Instance(file, include) => {
                let placed =
                    self.files.get(file as usize).and_then(|file| file.includes.get(include as usize));
                let name = placed.map_or("", |placed| placed.value.name.as_str());
                format!("{name} ({})", counted(&node.shapes))
            }
            NodeKind::Shapes(_) if node.shapes.len() == 1 => self.shape_name(node.shapes.start),
            NodeKind::Shapes(kind) => {
                let name = kind_name(kind.directive());
                format!("{} {name}{}", node.shapes.len(), if name == "box" { "es" } else { "s" })
            }
        }
    }

    /// Where a material of the resolved scene stands: its file and its number there; `None` for the default material.
    pub fn material(&self, resolved: u32) -> Option<(usize, usize)> {
        let mut left = resolved as usize;
        for (number, file) in self.files.iter().enumerate() {
            if left < file.materials.len() {
                return Some((number, left));
            }
            left -= file.materials.len();
        }
        None
    }

    /// Where the `#camera` line is.
    pub fn camera_span(&self) -> Option<Span> {
        self.files.first().and_then(|file| file.camera).map(|placed| placed.span)
    }
}

fn counted(shapes: &std::ops::Range<u32>) -> String {
    format!("{} shape{}", shapes.len(), if shapes.len() == 1 { "" } else { "s" })
}

fn set_color(files: &mut [SceneFile], pick: fn(&mut SceneFile) -> &mut Option<Placed<Color>>, color: Color) {
    if let Some(placed) = files.first_mut().and_then(|file| pick(file).as_mut()) {
        placed.value = color;
    }
}

fn kind_name(directive: &'static str) -> &'static str {
    directive.trim_start_matches('#').trim_start_matches("shape_")
}

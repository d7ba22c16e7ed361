//! What rays meet: the resolved scene baked into flat arrays, its textures and its accelerator.

use crate::light::Light;
use crate::options::PrepareOptions;
use crate::shapes;
use crate::shapes::Shapes;
use crate::stats::MemoryPart;
use crate::texture::Texture;
use dotray_accel::Accelerator;
use dotray_accel::Boxes;
use dotray_accel::GroupEvent;
use dotray_accel::MAX_ITEMS;
use dotray_accel::Settings;
use dotray_geometry::Aabb;
use dotray_geometry::Transform;
use dotray_geometry::Vec3;
use dotray_scene::Diagnostic;
use dotray_scene::Files;
use dotray_scene::Resolved;
use dotray_scene::Severity;
use dotray_scene::model;
use dotray_scene::model::SceneFile;
use dotray_scene::resolved::ResolvedMaterial;
use dotray_scene::resolved::ResolvedTexture;
use dotray_scene::resolved::Run;
use dotray_scene::resolved::TreeEvent;
use std::time::Instant;

/// A scene ready for tracing.
#[derive(Debug)]
pub struct World {
    pub(crate) camera: model::Camera,
    pub(crate) background: Vec3,
    pub(crate) ambient: Vec3,
    pub(crate) lights: Vec<Light>,
    pub(crate) materials: Vec<ResolvedMaterial>,
    pub(crate) textures: Vec<Texture>,
    pub(crate) shapes: Shapes,
    pub(crate) accelerator: Accelerator,
    pub(crate) ray_eps: f64,
    seconds: Vec<(&'static str, f64)>,
}

/// The smallest t that counts, as a fraction of the scene's size. Double precision places a point hit within a few
/// 1e-16 of that size; a factor of 10⁶ and more is left for grazing rays, and what lies closer than 1e-9 is too
/// close to be seen.
const RELATIVE_RAY_EPS: f64 = 1e-9;

/// The shapes' boxes in the world, by shape number.
struct ShapeBoxes<'a> {
    runs: &'a [Run],
    frames: &'a [Transform],
    files: &'a [SceneFile],
    count: u32,
}

impl Boxes for ShapeBoxes<'_> {
    fn len(&self) -> u32 {
        self.count
    }

    fn bounds(&self, item: u32) -> Aabb {
        let (_, run, shape) = shapes::written_shape(self.runs, self.files, item);
        shape.world_bounds(&self.frames[run.frame as usize].world_from_object)
    }
}

impl World {
    /// Loads the textures, builds the accelerator and bakes the shapes.
    ///
    /// # Errors
    /// A diagnostic for each texture that cannot be read or decoded, and for a scene beyond the limits.
    pub fn prepare(
        resolved: Resolved,
        files: &dyn Files,
        options: &PrepareOptions,
    ) -> Result<Self, Vec<Diagnostic>> {
        let mut seconds = Vec::new();
        let start = Instant::now();
        let textures = load_textures(&resolved.textures, files, &options.image_limits)?;
        seconds.push(("textures", start.elapsed().as_secs_f64()));
        if resolved.shape_count > MAX_ITEMS {
            return Err(vec![too_many_shapes(resolved.shape_count)]);
        }

        let start = Instant::now();
        let boxes = ShapeBoxes {
            runs: &resolved.runs,
            frames: &resolved.frames,
            files: &resolved.files,
            count: resolved.shape_count,
        };
        let groups = group_events(&resolved);
        let settings = Settings { quality: options.quality };
        let build = || Accelerator::build(options.accel, &boxes, &groups, &settings);
        let built = match options.threads.map(|n| rayon::ThreadPoolBuilder::new().num_threads(n).build()) {
            Some(Ok(pool)) => pool.install(build),
            Some(Err(_)) | None => build(),
        };
        let bounds = built.accelerator.bounds();
        seconds.push(("build", start.elapsed().as_secs_f64()));

        let start = Instant::now();
        let default_material = resolved.materials.len() as u32 - 1;
        let mut shapes = Shapes::new(resolved.runs, resolved.frames, resolved.files);
        shapes.reserve(resolved.shape_count as usize);
        let material = |run: &Run, written: i32| run.material(written).unwrap_or(default_material);
        match &built.order {
            Some(order) => order.iter().for_each(|&number| shapes.push(number, material)),
            None => (0..resolved.shape_count).for_each(|number| shapes.push(number, material)),
        }
        shapes.finish();
        seconds.push(("bake", start.elapsed().as_secs_f64()));

        let size = if bounds.is_empty() { 1.0 } else { bounds.min.abs().max(bounds.max.abs()).max_element() };
        Ok(Self {
            camera: resolved.camera,
            background: resolved.background,
            ambient: resolved.ambient,
            lights: resolved.lights.iter().map(Light::new).collect(),
            materials: resolved.materials,
            textures,
            shapes,
            accelerator: built.accelerator,
            ray_eps: RELATIVE_RAY_EPS * size,
            seconds,
        })
    }

    /// How many shapes there are, instances counted as often as they stand.
    pub fn shape_count(&self) -> usize {
        self.shapes.len()
    }

    /// The box around all shapes; empty without any.
    pub fn bounds(&self) -> Aabb {
        self.accelerator.bounds()
    }

    /// The smallest t of a hit that counts.
    pub fn ray_eps(&self) -> f64 {
        self.ray_eps
    }

    /// The bytes it holds, by part.
    pub fn memory(&self) -> Vec<MemoryPart> {
        let (baked, written) = self.shapes.memory();
        vec![
            MemoryPart { name: "shapes", bytes: baked },
            MemoryPart { name: "scene", bytes: written },
            MemoryPart { name: "accelerator", bytes: self.accelerator.memory() as u64 },
            MemoryPart { name: "textures", bytes: self.textures.iter().map(Texture::memory).sum() },
        ]
    }

    /// What preparing took, by stage.
    pub fn seconds(&self) -> &[(&'static str, f64)] {
        &self.seconds
    }
}

fn group_events(resolved: &Resolved) -> Vec<GroupEvent> {
    let event = |event: &TreeEvent| match *event {
        TreeEvent::Open => GroupEvent::Open,
        TreeEvent::Close => GroupEvent::Close,
        TreeEvent::Run(index) => {
            let run = &resolved.runs[index as usize];
            GroupEvent::Items { first: run.first_shape, count: run.count }
        }
    };
    resolved.tree.iter().map(event).collect()
}

fn too_many_shapes(count: u32) -> Diagnostic {
    Diagnostic {
        severity: Severity::Error,
        code: "too-many-shapes",
        message: format!("the scene holds {count} shapes; at most {MAX_ITEMS} can be rendered"),
        span: None,
        label: String::new(),
        notes: Vec::new(),
        help: Some("place fewer instances, or split the scene".to_owned()),
    }
}

fn load_textures(
    textures: &[ResolvedTexture],
    files: &dyn Files,
    limits: &dotray_image::Limits,
) -> Result<Vec<Texture>, Vec<Diagnostic>> {
    let mut loaded = Vec::new();
    let mut faults = Vec::new();
    for texture in textures {
        match load_texture(texture, files, limits) {
            Ok(texture) => loaded.push(texture),
            Err(fault) => faults.push(*fault),
        }
    }
    if faults.is_empty() { Ok(loaded) } else { Err(faults) }
}

fn load_texture(
    texture: &ResolvedTexture,
    files: &dyn Files,
    limits: &dotray_image::Limits,
) -> Result<Texture, Box<Diagnostic>> {
    let fault = |code, message, notes: Vec<String>, help: &str| {
        Box::new(Diagnostic {
            severity: Severity::Error,
            code,
            message,
            span: Some(texture.span),
            label: String::new(),
            notes: notes.into_iter().map(|note| (None, note)).collect(),
            help: Some(help.to_owned()),
        })
    };
    let mut tried = Vec::new();
    for path in &texture.candidates {
        match files.read(path) {
            Ok(bytes) => {
                let hint = dotray_image::Format::from_path(path).ok();
                return dotray_image::decode(&bytes, hint, limits).map(Texture::new).map_err(|error| {
                    fault(
                        "texture-unreadable",
                        format!("cannot decode the texture `{}`: {error}", path.display()),
                        Vec::new(),
                        "save it anew as BMP, PNG, JPEG, PPM, QOI, TIFF, HDR or EXR",
                    )
                });
            }
            Err(error) => tried.push(format!("tried {}: {error}", path.display())),
        }
    }
    Err(fault(
        "texture-not-found",
        format!("cannot read the texture `{}`", texture.name),
        tried,
        "a texture's name is relative to the folder of its .ray file",
    ))
}

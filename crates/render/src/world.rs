//! What rays meet: the resolved scene baked into flat arrays, its textures and its accelerator.

use crate::caster::Caster;
use crate::light::Light;
use crate::options::PrepareOptions;
use crate::stats::MemoryPart;
use crate::texture::Texture;
use dotray_accel::MAX_ITEMS;
use dotray_geometry::Aabb;
use dotray_geometry::Vec3;
use dotray_image::Image;
use dotray_image::ImageError;
use dotray_image::Limits;
use dotray_scene::Diagnostic;
use dotray_scene::Files;
use dotray_scene::Resolved;
use dotray_scene::model;
use dotray_scene::model::Tint;
use dotray_scene::resolved::ResolvedMaterial;
use dotray_scene::resolved::ResolvedTexture;
use dotray_scene::textures::Hints;
use dotray_scene::textures::not_found;
use dotray_scene::textures::unreadable;
use std::io::ErrorKind;
use web_time::Instant;

/// A scene ready for tracing.
#[derive(Debug)]
pub struct World {
    pub(crate) camera: model::Camera,
    pub(crate) background: Vec3,
    pub(crate) secondary_background: Vec3,
    pub(crate) ambient: Vec3,
    pub(crate) lights: Vec<Light>,
    pub(crate) tints: Vec<Tint>,
    /// The lights that have an ambient colour of their own, with it; none in most scenes.
    pub(crate) ambient_lights: Vec<(Light, Vec3)>,
    pub(crate) materials: Vec<ResolvedMaterial>,
    pub(crate) textures: Vec<Texture>,
    pub(crate) caster: Caster,
    pub(crate) ray_eps: f64,
    seconds: Vec<(&'static str, f64)>,
}

/// The smallest t that counts, as a fraction of the scene's size. Double precision places a point hit within a few
/// 1e-16 of that size; a factor of 10⁶ and more is left for grazing rays, and what lies closer than 1e-9 is too
/// close to be seen.
const RELATIVE_RAY_EPS: f64 = 1e-9;

/// The pictures that a scene's materials ask for.
#[derive(Debug, Default)]
pub struct Textures {
    textures: Vec<Texture>,
    seconds: f64,
}

impl Textures {
    /// Reads and decodes them.
    ///
    /// # Errors
    /// A diagnostic for each that cannot be read or decoded.
    pub fn load(
        resolved: &Resolved,
        files: &dyn Files,
        options: &PrepareOptions,
    ) -> Result<Self, Vec<Diagnostic>> {
        let start = Instant::now();
        let textures = load_textures(&resolved.textures, files, &options.image_limits)?;
        Ok(Self { textures, seconds: start.elapsed().as_secs_f64() })
    }

    /// The pictures by number.
    pub(crate) fn images(&self) -> impl Iterator<Item = &Image> {
        self.textures.iter().map(Texture::image)
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
        let textures = Textures::load(&resolved, files, options)?;
        Self::build(resolved, textures, options)
    }

    /// Builds the accelerator and bakes the shapes. Whatever can be said of a place in the text has been said before,
    /// so whoever is short of memory lets go of the text between the two.
    ///
    /// # Errors
    /// A diagnostic for a scene beyond the limits.
    pub fn build(
        resolved: Resolved,
        textures: Textures,
        options: &PrepareOptions,
    ) -> Result<Self, Vec<Diagnostic>> {
        Self::build_after(resolved, textures, options, None)
    }

    /// The same scene after groups have moved, its textures kept. With `refit` the accelerator is fitted to the shapes
    /// where they are now, which is quick; the picture is the same, but the further they have moved, the longer rays
    /// take. Without, or where the accelerator cannot be fitted, a new one is built.
    ///
    /// # Errors
    /// A diagnostic for a scene beyond the limits.
    pub fn moved(
        self,
        resolved: Resolved,
        options: &PrepareOptions,
        refit: bool,
    ) -> Result<Self, Vec<Diagnostic>> {
        let Self { textures, caster, .. } = self;
        Self::build_after(resolved, Textures { textures, seconds: 0.0 }, options, refit.then_some(caster))
    }

    /// Takes the scene apart again: its textures, and its shapes with their runs and transforms, which are put into
    /// `rest`, the scene that this was built of without its shapes. Whoever wants to build it otherwise need not keep
    /// the shapes a second time. The files' own trees, which nothing is built of, are gone.
    pub fn take_apart(self, rest: Resolved) -> (Resolved, Textures) {
        let shape_count = self.shape_count() as u32;
        let Self { textures, caster, .. } = self;
        let (runs, frames, files) = caster.into_shapes().into_written(rest.default_material());
        (Resolved { runs, frames, files, shape_count, ..rest }, Textures { textures, seconds: 0.0 })
    }

    fn build_after(
        resolved: Resolved,
        textures: Textures,
        options: &PrepareOptions,
        former: Option<Caster>,
    ) -> Result<Self, Vec<Diagnostic>> {
        if resolved.shape_count > MAX_ITEMS {
            return Err(vec![too_many_shapes(resolved.shape_count)]);
        }
        let Textures { textures, seconds } = textures;
        let mut seconds = vec![("textures", seconds)];
        // What only pictures need is taken out before the shapes are baked.
        let mut resolved = resolved;
        let default_material = resolved.default_material();
        let materials = std::mem::take(&mut resolved.materials);
        let (lights, tints) = (std::mem::take(&mut resolved.lights), std::mem::take(&mut resolved.tints));
        let secondary_background = resolved.secondary_background;
        let (camera, background, ambient) = (resolved.camera, resolved.background, resolved.ambient);
        let caster = Caster::with_default(resolved, default_material, options, former);
        seconds.extend_from_slice(caster.seconds());
        let bounds = caster.bounds();
        let size = if bounds.is_empty() { 1.0 } else { bounds.min.abs().max(bounds.max.abs()).max_element() };
        let mut world = Self {
            camera,
            background,
            secondary_background,
            ambient,
            lights: Vec::new(),
            tints: Vec::new(),
            ambient_lights: Vec::new(),
            materials,
            textures,
            caster,
            ray_eps: RELATIVE_RAY_EPS * size,
            seconds,
        };
        world.set_lights(&lights, tints);
        Ok(world)
    }

    /// Puts the lights, materials, background and ambient light of another resolution of the same scene in place of its
    /// own; the shapes stay, so this costs as much as there are lights and materials. Materials must be as many and
    /// name the same textures as before; otherwise nothing changes.
    pub fn restyle(&mut self, style: &Resolved) {
        let same_texture = |(a, b): (&ResolvedMaterial, &ResolvedMaterial)| {
            a.texture == b.texture && a.procedural.bump_textures().eq(b.procedural.bump_textures())
        };
        let fits = self.materials.len() == style.materials.len();
        if !fits || !self.materials.iter().zip(&style.materials).all(same_texture) {
            return;
        }
        self.materials.clone_from(&style.materials);
        (self.background, self.secondary_background) = (style.background, style.secondary_background);
        self.ambient = style.ambient;
        self.set_lights(&style.lights, style.tints.clone());
    }

    fn set_lights(&mut self, lights: &[model::Light], mut tints: Vec<Tint>) {
        // Whoever adds a light to a resolved scene need not know of tints.
        tints.resize(lights.len(), Tint::PLAIN);
        self.lights = lights.iter().map(Light::new).collect();
        let with_ambient = self.lights.iter().zip(&tints).filter(|(_, tint)| tint.ambient != Vec3::ZERO);
        self.ambient_lights = with_ambient.map(|(light, tint)| (*light, tint.ambient)).collect();
        self.tints = tints;
    }

    /// The camera, after defaults.
    pub fn camera(&self) -> &model::Camera {
        &self.camera
    }

    /// The same scene seen by another camera: nothing is built anew.
    pub fn set_camera(&mut self, camera: model::Camera) {
        self.camera = camera;
    }

    /// The same shapes under other light, as a scene in the slides' own dialect has it: nothing is built anew.
    pub fn set_light(&mut self, background: Vec3, ambient: Vec3, lights: &[model::Light]) {
        (self.background, self.secondary_background, self.ambient) = (background, background, ambient);
        self.set_lights(lights, Vec::new());
    }

    /// The lights, by number.
    pub fn lights(&self) -> &[Light] {
        &self.lights
    }

    /// The shapes, for rays of one's own.
    pub fn caster(&self) -> &Caster {
        &self.caster
    }

    /// How many shapes there are, instances counted as often as they stand.
    pub fn shape_count(&self) -> usize {
        self.caster.shape_count()
    }

    /// The box around all shapes; empty without any.
    pub fn bounds(&self) -> Aabb {
        self.caster.bounds()
    }

    /// The smallest t of a hit that counts.
    pub fn ray_eps(&self) -> f64 {
        self.ray_eps
    }

    /// The bytes it holds, by part.
    pub fn memory(&self) -> Vec<MemoryPart> {
        let (baked, written) = self.caster.shapes.memory();
        vec![
            MemoryPart { name: "shapes", bytes: baked },
            MemoryPart { name: "scene", bytes: written },
            MemoryPart { name: "accelerator", bytes: self.caster.accelerator.memory() as u64 },
            MemoryPart { name: "textures", bytes: self.textures.iter().map(Texture::memory).sum() },
        ]
    }

    /// What preparing took, by stage.
    pub fn seconds(&self) -> &[(&'static str, f64)] {
        &self.seconds
    }
}

fn too_many_shapes(count: u32) -> Diagnostic {
    let message = format!("the scene holds {count} shapes; at most {MAX_ITEMS} can be rendered");
    Diagnostic::error("too-many-shapes", message).help("place fewer instances, or split the scene")
}

fn load_textures(
    textures: &[ResolvedTexture],
    files: &dyn Files,
    limits: &Limits,
) -> Result<Vec<Texture>, Vec<Diagnostic>> {
    let mut loaded = Vec::new();
    let mut faults = Vec::new();
    let mut hints = Hints::new(files);
    // The limit on bytes is for all textures together.
    let mut left = limits.max_bytes;
    for texture in textures {
        match load_texture(texture, files, &mut hints, &Limits { max_bytes: left, ..*limits }) {
            Ok(texture) => {
                left = left.saturating_sub(texture.memory());
                loaded.push(texture);
            }
            Err(fault) => faults.push(*fault),
        }
    }
    if faults.is_empty() { Ok(loaded) } else { Err(faults) }
}

fn load_texture(
    texture: &ResolvedTexture,
    files: &dyn Files,
    hints: &mut Hints,
    limits: &Limits,
) -> Result<Texture, Box<Diagnostic>> {
    let mut refused = Vec::new();
    for path in &texture.candidates {
        // No picture of so many bytes in memory is larger on disk.
        match files.read_at_most(path, limits.max_bytes) {
            Ok(bytes) => {
                let hint = dotray_image::Format::from_path(path).ok();
                return dotray_image::decode(&bytes, hint, limits).map(Texture::new).map_err(|error| {
                    let fault = unreadable(texture, path, &error.to_string());
                    let too_large = matches!(error, ImageError::Size { .. } | ImageError::Memory { .. });
                    let help = "a smaller picture will do, or a higher limit (`--max-pixels`)";
                    Box::new(if too_large { fault.help(help) } else { fault })
                });
            }
            Err(error) if error.kind() == ErrorKind::NotFound => {}
            Err(error) => refused.push(format!("cannot read `{}`: {error}", path.display())),
        }
    }
    Err(Box::new(not_found(hints, texture, refused)))
}

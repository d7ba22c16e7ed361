//! The scene with nothing left to guess: what the renderer reads.

use crate::model::Camera;
use crate::model::Color;
use crate::model::Light;
use crate::model::SceneFile;
use crate::model::ShapeKind;
use crate::model::Tint;
use crate::procedural::Procedural;
use crate::span::FileId;
use crate::span::Span;
use dotray_geometry::Affine;
use dotray_geometry::Transform;
use std::path::PathBuf;

/// A material as the formula of SPEC 6 wants it.
#[derive(Clone, Debug, PartialEq)]
pub struct ResolvedMaterial {
    /// M_A
    pub ambient: Color,
    /// M_D
    pub diffuse: Color,
    /// M_S, the highlight's colour
    pub specular: Color,
    /// M_E
    pub emissive: Color,
    /// The highlight's exponent: 128 kSpec.
    pub shininess: f64,
    /// What a mirrored ray's colour is multiplied by: kSpec · M_S, unless the dialect gives it by itself.
    pub reflection: Color,
    /// What a refracted ray's colour is multiplied by: kTrans · M_S.
    pub transmission: Color,
    /// What a shadow ray's colour is multiplied by.
    pub shadow: Color,
    /// Whether a texture colours highlights and emission, too.
    pub texture_on_all_light: bool,
    /// ir; above 0 where `transmission` is not 0.
    pub index_of_refraction: f64,
    /// The number of a texture in [`Resolved::textures`].
    pub texture: Option<u32>,
    /// 3-D textures and bumps.
    pub procedural: Procedural,
}

/// An image that materials name.
#[derive(Clone, Debug, PartialEq)]
pub struct ResolvedTexture {
    /// The name as written.
    pub name: String,
    /// Where to look, in this order.
    pub candidates: Vec<PathBuf>,
    /// The `#texture` directive.
    pub span: Span,
}

/// Consecutive shapes of one kind, one file and one frame.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Run {
    /// The file whose lists hold the shapes.
    pub file: FileId,
    /// Which list.
    pub kind: ShapeKind,
    /// The first entry.
    pub first: u32,
    /// How many.
    pub count: u32,
    /// The number of their matrix in [`Resolved::frames`].
    pub frame: u32,
    /// What to add to a shape's own material number.
    pub material_base: u32,
    /// The scene-wide number of the first shape: file order, instances expanded. Ties go to the lower number.
    pub first_shape: u32,
    /// Where the shapes have colours of their own.
    pub colors: RunColors,
}

/// Colours that shapes have beside their materials.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum RunColors {
    /// None.
    No,
    /// One a shape, which multiplies the material's.
    Shapes {
        /// The number of the list in [`SceneFile::colors`].
        list: u32,
        /// The place there of the run's first shape.
        first: u32,
    },
    /// One a vertex, interpolated, in place of the material's: [`SceneFile::vertex_colors`].
    Vertices,
}

/// A step of the scene's tree with instances expanded, in file order.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum TreeEvent {
    /// A group (or an instance) begins.
    Open,
    /// It ends.
    Close,
    /// The shapes of a run: the number of the run.
    Run(u32),
}

/// The resolved scene.
#[derive(Clone, Debug)]
pub struct Resolved {
    /// The camera, after defaults.
    pub camera: Camera,
    /// What a ray that hits nothing returns.
    pub background: Color,
    /// What a mirrored or refracted ray that hits nothing returns.
    pub secondary_background: Color,
    /// L_G
    pub ambient: Color,
    /// The lights of the file asked for.
    pub lights: Vec<Light>,
    /// As many tints.
    pub tints: Vec<Tint>,
    /// All files' materials; the last one is the default material.
    pub materials: Vec<ResolvedMaterial>,
    /// All files' textures.
    pub textures: Vec<ResolvedTexture>,
    /// The matrices in use, world from object; number 0 is the identity. All have an inverse: see
    /// [`Resolved::transform`].
    pub frames: Vec<Affine>,
    /// The shapes.
    pub runs: Vec<Run>,
    /// The tree over the runs.
    pub tree: Vec<TreeEvent>,
    /// The number of shapes, instances counted as often as they stand.
    pub shape_count: u32,
    /// The files, with their lists of shapes.
    pub files: Vec<SceneFile>,
}

impl Run {
    /// The number in [`Resolved::materials`] of a shape's material as its file numbers it; `None` for -1, the default
    /// material.
    #[inline]
    pub fn material(&self, written: i32) -> Option<u32> {
        u32::try_from(written).ok().map(|number| self.material_base + number)
    }
}

impl Resolved {
    /// The matrix of this number in [`Resolved::frames`], with its inverse.
    pub fn transform(&self, frame: u32) -> Option<Transform> {
        match frame {
            0 => Some(Transform::IDENTITY),
            _ => self.frames.get(frame as usize).copied().map(Transform::again),
        }
    }

    /// The number in [`Resolved::materials`] of the default material.
    pub fn default_material(&self) -> u32 {
        self.materials.len().saturating_sub(1) as u32
    }

    /// The number in [`Resolved::materials`] of a shape's material as its file numbers it (-1: the default).
    #[inline]
    pub fn material_index(&self, run: &Run, written: i32) -> u32 {
        run.material(written).unwrap_or(self.default_material())
    }
}

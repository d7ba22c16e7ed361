//! The scene as written: plain data, the slides' names, the order of the file.

use crate::dialect::Dialect;
use crate::span::FileId;
use crate::span::PackedStarts;
use crate::span::Span;
use dotray_geometry::Cone;
use dotray_geometry::Cuboid;
use dotray_geometry::Cylinder;
use dotray_geometry::Mat4;
use dotray_geometry::OpenSide;
use dotray_geometry::Sphere;
use dotray_geometry::Torus;
use dotray_geometry::Triangle;
use dotray_geometry::Vec2;
use dotray_geometry::Vec3;
use std::path::PathBuf;

/// Red, green, blue; not clamped.
pub type Color = Vec3;

/// `#camera`.
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct Camera {
    /// The eye.
    pub position: Vec3,
    /// Where it looks; any length but 0.
    pub direction: Vec3,
    /// What is up in the picture; any length but 0, not parallel to the direction.
    pub up: Vec3,
    /// Half of the vertical view angle, in radians.
    pub half_angle: f64,
}

/// 1 / (constant + linear d + quadratic d²).
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct Attenuation {
    /// ca
    pub constant: f64,
    /// la
    pub linear: f64,
    /// qa
    pub quadratic: f64,
}

/// A light.
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub enum Light {
    /// `#light_point`
    Point {
        /// Colour.
        color: Color,
        /// Where it stands.
        position: Vec3,
        /// How it fades.
        attenuation: Attenuation,
    },
    /// `#light_spot`
    Spot {
        /// Colour.
        color: Color,
        /// Where it stands.
        position: Vec3,
        /// Its axis; any length but 0.
        direction: Vec3,
        /// How it fades.
        attenuation: Attenuation,
        /// sc: the angle between axis and edge, in radians.
        cutoff: f64,
        /// sd: the exponent is 128 sd.
        dropoff: f64,
    },
    /// `#light_dir`
    Directional {
        /// Colour.
        color: Color,
        /// Where the light travels; any length but 0.
        direction: Vec3,
    },
    /// `#light_area`: a disc.
    Area {
        /// Colour.
        color: Color,
        /// The disc's centre.
        position: Vec3,
        /// The normal of the side that emits; any length but 0.
        direction: Vec3,
        /// The disc's radius, above 0.
        radius: f64,
        /// How it fades.
        attenuation: Attenuation,
    },
}

/// What a light sends by kind of reflection, in a dialect that says so: channel by channel, as parts of the light's own
/// colour, which is the largest of the three.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Tint {
    /// What M_A reflects, whatever the normal and the shadows.
    pub ambient: Color,
    /// What M_D reflects.
    pub diffuse: Color,
    /// What M_S reflects.
    pub specular: Color,
}

impl Tint {
    /// A light of one colour.
    pub const PLAIN: Self = Self { ambient: Color::ZERO, diffuse: Color::ONE, specular: Color::ONE };
}

/// A material's weights where a dialect gives them by themselves instead of by ks and kt.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Weights {
    /// The highlight's exponent.
    pub shininess: f64,
    /// What a mirrored ray's colour is multiplied by.
    pub reflection: Color,
    /// What a refracted ray's colour is multiplied by.
    pub transmission: Color,
}

/// An image that leans a surface's normals, as the dialect `hmc` has it.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct BumpImage {
    /// The number of a texture in the same file.
    pub texture: u32,
    /// The slope of a texel that is 1 brighter than its neighbour.
    pub scale: f64,
}

/// `#material`.
#[derive(Clone, Debug, PartialEq)]
pub struct Material {
    /// M_A
    pub ambient: Color,
    /// M_D
    pub diffuse: Color,
    /// M_S
    pub specular: Color,
    /// M_E
    pub emissive: Color,
    /// ks, kSpec
    pub k_specular: f64,
    /// kt, kTrans
    pub k_transmission: f64,
    /// ir
    pub index_of_refraction: f64,
    /// tn: the number of a texture in the same file.
    pub texture: Option<u32>,
    /// An image whose brightness is the surface's height.
    pub bump: Option<BumpImage>,
    /// The text between the exclamation marks.
    pub text: String,
    /// Weights in place of ks and kt.
    pub weights: Option<Weights>,
}

impl Default for Material {
    /// Material -1.
    fn default() -> Self {
        Self {
            ambient: Color::splat(0.2),
            diffuse: Color::splat(0.8),
            specular: Color::splat(0.8),
            emissive: Color::ZERO,
            k_specular: 1.0,
            k_transmission: 0.0,
            index_of_refraction: 1.0,
            texture: None,
            bump: None,
            text: String::new(),
            weights: None,
        }
    }
}

/// `#vertex`.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Vertex {
    /// Where it is.
    pub position: Vec3,
    /// Its normal at the length given.
    pub normal: Vec3,
    /// (s, t)
    pub texcoord: Vec2,
}

/// Which kind of shape; also the name of the typed array that holds it.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum ShapeKind {
    /// `#shape_sphere`
    Sphere,
    /// `#shape_box`
    Cuboid,
    /// `#shape_cylinder`
    Cylinder,
    /// `#shape_cone`
    Cone,
    /// `#shape_triangle` of 24 numbers
    Triangle,
    /// `#shape_triangle` of three vertex numbers
    IndexedTriangle,
    /// A torus, which only some dialects have.
    Torus,
    /// A cylinder or cone without discs, which only some dialects have.
    Open,
}

/// The shapes of one kind of one file, in file order.
#[derive(Clone, Debug, PartialEq)]
pub struct ShapeList<T> {
    /// The shapes, in object coordinates.
    pub shapes: Vec<T>,
    /// The material of each; -1 is the default material.
    pub materials: Vec<i32>,
    /// Where each directive begins in its file.
    pub starts: PackedStarts,
}

impl<T> Default for ShapeList<T> {
    fn default() -> Self {
        Self { shapes: Vec::new(), materials: Vec::new(), starts: PackedStarts::default() }
    }
}

/// A colour for each of consecutive shapes, for scenes that come from arrays: it multiplies the ambient and the diffuse
/// colour of the shape's material.
#[derive(Clone, Debug, PartialEq)]
pub struct ShapeColors {
    /// Which list.
    pub kind: ShapeKind,
    /// The first entry that has a colour here.
    pub first: u32,
    /// The colours, entry by entry.
    pub colors: Vec<[f32; 3]>,
}

/// Something that has a place.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Placed<T> {
    /// The value.
    pub value: T,
    /// Its directive, from `#` to the last argument.
    pub span: Span,
}

/// What stands in the tree, in file order: groups open and close, shapes come in runs of one kind. Flat, so that
/// neither 10⁷ shapes nor 10⁵ nested groups need an allocation or a stack frame each.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Item {
    /// `#group_begin`: the number of its matrix in [`SceneFile::groups`].
    Open(u32),
    /// `#group_end`
    Close,
    /// Consecutive shapes of one kind: entries `first .. first + count` of the kind's list.
    Run {
        /// Which list.
        kind: ShapeKind,
        /// The first entry.
        first: u32,
        /// How many.
        count: u32,
    },
    /// `#ray_file_instance`: the number of the include in [`SceneFile::includes`].
    Instance(u32),
}

/// `#ray_file`.
#[derive(Clone, Debug, PartialEq)]
pub struct Include {
    /// The name as written.
    pub name: String,
    /// The file it names.
    pub file: FileId,
}

/// One `.ray` file as written.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct SceneFile {
    /// The path it was read from.
    pub path: PathBuf,
    /// What its words mean.
    pub dialect: Dialect,
    /// The first `#camera`.
    pub camera: Option<Placed<Camera>>,
    /// The first `#background`.
    pub background: Option<Placed<Color>>,
    /// The first `#ambient`.
    pub ambient: Option<Placed<Color>>,
    /// The lights.
    pub lights: Vec<Placed<Light>>,
    /// The lights' tints by their numbers; shorter than the list of lights where the last ones are plain.
    pub tints: Vec<Tint>,
    /// The names of the textures.
    pub textures: Vec<Placed<String>>,
    /// The materials.
    pub materials: Vec<Placed<Material>>,
    /// The vertices.
    pub vertices: Vec<Vertex>,
    /// The colours of vertices by their numbers, as the dialect `unisa` has them, where they show. A triangle whose
    /// corners all have one shows them, interpolated, in place of its material's ambient and diffuse colour.
    pub vertex_colors: Vec<Option<Color>>,
    /// The included files, in the order of `#ray_file`.
    pub includes: Vec<Placed<Include>>,
    /// The group matrices, in the order of `#group_begin`.
    pub groups: Vec<Placed<Mat4>>,
    /// The tree, flat and in file order.
    pub items: Vec<Item>,
    /// `#shape_sphere`
    pub spheres: ShapeList<Sphere>,
    /// `#shape_box`
    pub cuboids: ShapeList<Cuboid>,
    /// `#shape_cylinder`
    pub cylinders: ShapeList<Cylinder>,
    /// `#shape_cone`
    pub cones: ShapeList<Cone>,
    /// `#shape_triangle` with 24 numbers
    pub triangles: ShapeList<Triangle>,
    /// `#shape_triangle` with three vertex numbers, known to be in range
    pub indexed_triangles: ShapeList<[u32; 3]>,
    /// `#shape_torus`, `#torus`
    pub tori: ShapeList<Torus>,
    /// `#cylinder` and `#cone` without `-c`
    pub open_sides: ShapeList<OpenSide>,
    /// Colours of shapes beside their materials, by kind and then by entry, no two for the same shape. No text has
    /// them: see [`crate::colors`].
    pub colors: Vec<ShapeColors>,
}

/// A scene: the file asked for and all that it includes.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Scene {
    /// File 0 is the one asked for.
    pub files: Vec<SceneFile>,
}

impl SceneFile {
    /// The file without the places of its text, such that two texts that say the same give equal files.
    pub fn without_places(mut self) -> Self {
        fn clear<T>(placed: &mut Placed<T>) {
            placed.span = Span::default();
        }
        self.camera.iter_mut().for_each(clear);
        self.background.iter_mut().for_each(clear);
        self.ambient.iter_mut().for_each(clear);
        self.lights.iter_mut().for_each(clear);
        self.textures.iter_mut().for_each(clear);
        self.materials.iter_mut().for_each(clear);
        self.includes.iter_mut().for_each(clear);
        self.groups.iter_mut().for_each(clear);
        for starts in [
            &mut self.spheres.starts,
            &mut self.cuboids.starts,
            &mut self.cylinders.starts,
            &mut self.cones.starts,
            &mut self.triangles.starts,
            &mut self.indexed_triangles.starts,
            &mut self.tori.starts,
            &mut self.open_sides.starts,
        ] {
            *starts = PackedStarts::default();
        }
        self
    }
}

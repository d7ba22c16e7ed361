//! Materials and lights as rows of four numbers, which a shader reads from a texture: so their number has no limit.

use crate::pictures::Heights;
use dotray_geometry::Vec3;
use dotray_render::noise::PERMUTATION;
use dotray_scene::model::Attenuation;
use dotray_scene::model::Light;
use dotray_scene::model::Tint;
use dotray_scene::procedural::Bump;
use dotray_scene::procedural::Pattern;
use dotray_scene::procedural::Procedural;
use dotray_scene::resolved::ResolvedMaterial;
use std::collections::BTreeMap;

/// Texels a material takes.
pub const MATERIAL_TEXELS: usize = 4;

/// Texels a clause of a material's 3-D textures and bumps takes.
pub const CLAUSE_TEXELS: usize = 3;

/// Texels a light takes.
pub const LIGHT_TEXELS: usize = 7;

/// Texels a row of the table has.
pub const WIDTH: usize = 1024;

/// The frame that the GPU computes in: the scene's centre is its origin, and the scene reaches to about 1. So single
/// precision serves scenes of any size at any place.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ViewFrame {
    /// The scene's centre in the world.
    pub center: Vec3,
    /// The world's length of the view's 1.
    pub unit: f64,
}

impl ViewFrame {
    /// A point of the world.
    pub fn point(&self, world: Vec3) -> Vec3 {
        (world - self.center) / self.unit
    }
}

/// Three numbers and a fourth in single precision; none is infinite.
fn texel(v: Vec3, w: f64) -> [f32; 4] {
    v.extend(w).to_array().map(|x| x.clamp(-1e30, 1e30) as f32)
}

/// What is looked up besides materials and lights, in one table: the heights of images, four a texel; the colours of
/// triangles' corners, each with the number of its frame; the rows of frames, three each.
#[derive(Clone, Debug, Default)]
pub struct Places {
    /// The table.
    pub texels: Vec<[f32; 4]>,
    /// Where the colours begin.
    pub first_color: u32,
    /// Where the frames begin.
    pub first_frame: u32,
    /// By texture: where its heights begin and how many columns and rows there are; half a texel of its file.
    heights: BTreeMap<u32, [Vec3; 2]>,
}

impl Places {
    /// Of all these.
    pub fn new(heights: &[Heights], colors: &[[f32; 4]], frames: &[[[f32; 4]; 3]]) -> Self {
        let mut places = Self::default();
        for image in heights {
            let first = places.texels.len() as f64;
            let [columns, rows] = image.kept.map(|edge| edge as f64);
            let [width, height] = image.size.map(|edge| edge as f64);
            let half = Vec3::new(0.5 / width, 0.5 / height, 0.0);
            places.heights.insert(image.texture, [Vec3::new(first, columns, rows), half]);
            let four = |some: &[f32]| std::array::from_fn(|at| some.get(at).copied().unwrap_or(0.0));
            places.texels.extend(image.brightness.chunks(4).map(four));
        }
        places.first_color = places.texels.len() as u32;
        places.texels.extend_from_slice(colors);
        places.first_frame = places.texels.len() as u32;
        places.texels.extend(frames.iter().flatten());
        places
    }
}

/// The materials, each of [`MATERIAL_TEXELS`] texels, and behind them the clauses of their 3-D textures and bumps, each
/// of [`CLAUSE_TEXELS`]: its kind, scale, octaves and height; a colour, and whether another one follows; the other
/// colour. Of an image, whose place is not among `places` where it could not be read: its kind, and where its heights
/// are; half a texel, and whether another one follows; how far it leans.
pub fn materials(materials: &[ResolvedMaterial], places: &Places) -> Vec<[f32; 4]> {
    let mut clauses = Vec::new();
    let first = MATERIAL_TEXELS * materials.len();
    let mut row = |material: &ResolvedMaterial| {
        let texture = material.texture.map_or(-1.0, f64::from);
        let before = clauses.len();
        clauses.extend(clauses_of(&material.procedural, places));
        let carving = if clauses.len() == before { -1.0 } else { (first + before) as f64 };
        [
            texel(material.ambient, material.shininess),
            texel(material.diffuse, texture),
            texel(material.specular, carving),
            texel(material.emissive, f64::from(u8::from(material.texture_on_all_light))),
        ]
    };
    let mut texels: Vec<[f32; 4]> = materials.iter().flat_map(&mut row).collect();
    texels.append(&mut clauses);
    texels
}

fn clauses_of(procedural: &Procedural, places: &Places) -> Vec<[f32; 4]> {
    let head = |kind: f64, scale: f64, octaves: u32, height: f64| {
        texel(Vec3::new(kind, scale, f64::from(octaves)), height)
    };
    let solids = procedural.solids.iter().map(|solid| {
        let kind = match solid.pattern {
            Pattern::Noise => 0.0,
            Pattern::Marble => 1.0,
            Pattern::Wood => 2.0,
            Pattern::Checker => 3.0,
        };
        let colors = (texel(solid.color, 1.0), texel(solid.color2, 0.0));
        [head(kind, solid.scale, solid.octaves, 0.0), colors.0, colors.1]
    });
    let bumps = procedural.bumps.iter().filter_map(|bump| match *bump {
        Bump::Noise { scale, octaves, height } => {
            Some([head(4.0, scale, octaves, height), texel(Vec3::ZERO, 1.0), texel(Vec3::ZERO, 0.0)])
        }
        Bump::Image { texture, scale } => {
            let [heights, half] = *places.heights.get(&texture)?;
            let [first, columns, rows] = heights.to_array();
            let head = texel(Vec3::new(5.0, first, columns), rows);
            Some([head, texel(half, 1.0), texel(Vec3::ZERO.with_x(scale), 0.0)])
        }
    });
    let mut clauses: Vec<[[f32; 4]; CLAUSE_TEXELS]> = solids.chain(bumps).collect();
    if let Some([_, [_, _, _, more], _]) = clauses.last_mut() {
        *more = 0.0;
    }
    clauses.concat()
}

/// The permutation of the noise, four numbers a word.
pub fn permutation() -> [[u32; 4]; 16] {
    let number = |at: usize| PERMUTATION.get(at).copied().map_or(0, u32::from);
    let word = |at: usize| (0..4).fold(0, |word, byte| word | number(4 * at + byte) << (8 * byte));
    std::array::from_fn(|row| std::array::from_fn(|column| word(4 * row + column)))
}

/// The lights, each of [`LIGHT_TEXELS`] texels: colour and kind; place and cosine of the cut-off; axis and exponent;
/// fading; what M_A, M_D and M_S reflect of its colour.
pub fn lights(lights: &[Light], tints: &[Tint], frame: &ViewFrame) -> Vec<[f32; 4]> {
    let fading = |a: &Attenuation| texel(Vec3::new(a.constant, a.linear, a.quadratic), 0.0);
    let none = [1.0, 0.0, 0.0, 0.0];
    let row = |light: &Light| match light {
        Light::Point { color, position, attenuation } => {
            let place = texel(frame.point(*position), -2.0);
            [texel(*color, 0.0), place, texel(Vec3::ZERO, 0.0), fading(attenuation)]
        }
        Light::Spot { color, position, direction, attenuation, cutoff, dropoff } => {
            let cosine = libm::cos(cutoff.clamp(0.0, std::f64::consts::PI));
            let place = texel(frame.point(*position), cosine);
            [texel(*color, 1.0), place, texel(direction.normalize(), 128.0 * dropoff), fading(attenuation)]
        }
        Light::Directional { color, direction } => {
            [texel(*color, 2.0), texel(Vec3::ZERO, -2.0), texel(direction.normalize(), 0.0), none]
        }
        Light::Area { color, position, direction, attenuation, .. } => {
            let place = texel(frame.point(*position), -2.0);
            [texel(*color, 3.0), place, texel(direction.normalize(), 0.0), fading(attenuation)]
        }
    };
    let tints = tints.iter().chain(std::iter::repeat(&Tint::PLAIN));
    let tinted = |tint: &Tint| [tint.ambient, tint.diffuse, tint.specular].map(|color| texel(color, 0.0));
    lights.iter().zip(tints).flat_map(|(light, tint)| row(light).into_iter().chain(tinted(tint))).collect()
}

/// Fills the last row of a table, at least one.
pub fn padded(mut texels: Vec<[f32; 4]>) -> Vec<[f32; 4]> {
    let rows = texels.len().div_ceil(WIDTH).max(1);
    texels.resize(rows * WIDTH, [0.0; 4]);
    texels
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn lights_stand_in_the_views_frame() {
        let frame = ViewFrame { center: Vec3::X * 10.0, unit: 2.0 };
        let attenuation = Attenuation { constant: 1.0, linear: 2.0, quadratic: 3.0 };
        let light = Light::Spot {
            color: Vec3::ONE,
            position: Vec3::X * 14.0,
            direction: Vec3::Y * 7.0,
            attenuation,
            cutoff: 0.5,
            dropoff: 0.25,
        };
        let table = lights(&[light], &[], &frame);
        assert_eq!(table.len(), LIGHT_TEXELS);
        assert_eq!(table[4..], [[0.0; 4], [1.0, 1.0, 1.0, 0.0], [1.0, 1.0, 1.0, 0.0]]);
        assert_eq!(table[1], [2.0, 0.0, 0.0, libm::cos(0.5) as f32]);
        assert_eq!((table[2], table[3]), ([0.0, 1.0, 0.0, 32.0], [1.0, 2.0, 3.0, 0.0]));
        assert_eq!(padded(table).len(), WIDTH);
        assert_eq!(padded(Vec::new()).len(), WIDTH);
    }
}

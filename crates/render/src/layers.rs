//! Layers: what lies behind each pixel besides its colour (arbitrary output variables).
//!
//! A layer is a picture of numbers, of the ray through each pixel's centre: where it met something, on what, and what
//! each part of the formula gave there. Oversampling does not enter; a layer is data, and means of shape numbers mean
//! nothing.

use crate::camera::Camera;
use crate::options::Crop;
use crate::options::Options;
use crate::options::Shadows;
use crate::record::EyeRecord;
use crate::record::MetByEye;
use crate::sampler::Block;
use crate::trace::Tracer;
use crate::world::World;
use dotray_accel::simd::level;
use dotray_geometry::Vec3;
use std::cmp::Reverse;

/// One kind of layer.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Layer {
    /// The distance along the eye ray; infinite where nothing is met.
    Depth,
    /// The shading normal in the world, turned to the viewer; 0 where nothing is met.
    Normal,
    /// The point in the world.
    Position,
    /// The shape's number in file order, from 0; -1 where nothing is met.
    Shape,
    /// The material's number in the scene, from 0; -1 where nothing is met.
    Material,
    /// The texture coordinates (s, t).
    St,
    /// The point in the shape's own coordinates.
    Object,
    /// How much of the lights that face the point comes through, channel by channel: 1 in full light, 0 in shadow.
    Shadow,
    /// What the point gives off by itself and by the lights; the background where nothing is met.
    Direct,
    /// What the mirrored ray adds.
    Reflected,
    /// What the refracted ray adds.
    Transmitted,
    /// All rays that the pixel's ray led to, itself included.
    Rays,
    /// The boxes (or cells) that all these rays were tested against.
    BoxTests,
    /// The shapes that all these rays were tested against.
    ShapeTests,
}

impl Layer {
    /// All of them, in the order of the documentation.
    pub const ALL: [Self; 14] = [
        Self::Depth,
        Self::Normal,
        Self::Position,
        Self::Shape,
        Self::Material,
        Self::St,
        Self::Object,
        Self::Shadow,
        Self::Direct,
        Self::Reflected,
        Self::Transmitted,
        Self::Rays,
        Self::BoxTests,
        Self::ShapeTests,
    ];

    /// Its name on the command line and in files.
    pub const fn name(self) -> &'static str {
        match self {
            Self::Depth => "depth",
            Self::Normal => "normal",
            Self::Position => "position",
            Self::Shape => "shape",
            Self::Material => "material",
            Self::St => "st",
            Self::Object => "object",
            Self::Shadow => "shadow",
            Self::Direct => "direct",
            Self::Reflected => "reflected",
            Self::Transmitted => "transmitted",
            Self::Rays => "rays",
            Self::BoxTests => "boxtests",
            Self::ShapeTests => "shapetests",
        }
    }

    /// The names of its channels, as EXR files have them.
    pub const fn channels(self) -> &'static [&'static str] {
        match self {
            Self::Depth => &["Z"],
            Self::Normal | Self::Position | Self::Object => &["X", "Y", "Z"],
            Self::Shape | Self::Material => &["id"],
            Self::St => &["S", "T"],
            Self::Shadow | Self::Direct | Self::Reflected | Self::Transmitted => &["R", "G", "B"],
            Self::Rays | Self::BoxTests | Self::ShapeTests => &["count"],
        }
    }

    /// Whether lights and further rays have no part in it.
    const fn is_geometric(self) -> bool {
        match self {
            Self::Depth
            | Self::Normal
            | Self::Position
            | Self::Shape
            | Self::Material
            | Self::St
            | Self::Object => true,
            Self::Shadow
            | Self::Direct
            | Self::Reflected
            | Self::Transmitted
            | Self::Rays
            | Self::BoxTests
            | Self::ShapeTests => false,
        }
    }

    /// Whether it tells what rays cost.
    const fn is_cost(self) -> bool {
        matches!(self, Self::Rays | Self::BoxTests | Self::ShapeTests)
    }

    /// Appends the layer's numbers of one pixel.
    fn append(self, eye: &EyeRecord, samples: &mut Vec<f32>) {
        let met = eye.met.as_ref();
        let vector = |samples: &mut Vec<f32>, v: Vec3| samples.extend(v.to_array().map(|x| x as f32));
        let of_point = |value: fn(&MetByEye) -> Vec3| met.map_or(Vec3::ZERO, value);
        match self {
            Self::Depth => samples.push(met.map_or(f32::INFINITY, |met| met.nearest.hit.t as f32)),
            Self::Normal => vector(samples, of_point(|met| met.normal)),
            Self::Position => vector(samples, of_point(|met| met.surface.point)),
            // Singles hold whole numbers up to 2^24 exactly; beyond, the nearest one they hold.
            Self::Shape => samples.push(met.map_or(-1.0, |met| met.nearest.number as f32)),
            Self::Material => samples.push(met.map_or(-1.0, |met| met.material as f32)),
            Self::St => {
                let st = met.map_or([0.0; 2], |met| met.surface.in_object.texcoord.get().to_array());
                samples.extend(st.map(|x| x as f32));
            }
            Self::Object => vector(samples, of_point(|met| met.surface.in_object.point)),
            Self::Shadow => vector(samples, eye.light_share()),
            Self::Direct => vector(samples, eye.direct),
            Self::Reflected => vector(samples, eye.reflected),
            Self::Transmitted => vector(samples, eye.transmitted),
            Self::Rays => samples.push(eye.rays as f32),
            Self::BoxTests => samples.push(eye.tests.boxes as f32),
            Self::ShapeTests => samples.push(eye.tests.shapes as f32),
        }
    }
}

/// A layer of a picture.
#[derive(Clone, Debug, PartialEq)]
pub struct LayerPicture {
    /// Which.
    pub layer: Layer,
    /// Columns.
    pub width: usize,
    /// Rows.
    pub height: usize,
    /// The numbers, pixel by pixel from the upper left, as many a pixel as [`Layer::channels`].
    pub samples: Vec<f32>,
}

/// The layers' numbers of some rows: pixel by pixel from the upper left, of each pixel one layer after the other.
pub(crate) fn samples_of(world: &World, options: &Options, wanted: &[Layer], rows: Crop) -> Vec<f32> {
    let camera = Camera::new(&world.camera, options.width, options.height);
    let alone = wanted.iter().any(|layer| layer.is_cost());
    let mut tracer = Tracer::new(world, options, level());
    let below = options.height - rows.y - rows.height;
    // Neighbouring rays travel together, and are put back into rows afterwards.
    let pixels = Block { x: rows.x, y: below, width: rows.width, height: rows.height }.pixels();
    let rays: Vec<_> =
        pixels.iter().map(|&(i, j)| camera.ray(f64::from(i) + 0.5, f64::from(j) + 0.5)).collect();
    let records = tracer.record(&rays, alone);
    let mut places: Vec<_> = (0..pixels.len()).collect();
    places.sort_unstable_by_key(|&place| (Reverse(pixels[place].1), pixels[place].0));
    let mut samples = Vec::with_capacity(places.len() * numbers_a_pixel(wanted));
    for &place in &places {
        wanted.iter().for_each(|layer| layer.append(&records[place], &mut samples));
    }
    samples
}

/// How many numbers a pixel has in all of these layers.
pub(crate) fn numbers_a_pixel(wanted: &[Layer]) -> usize {
    wanted.iter().map(|layer| layer.channels().len()).sum()
}

/// The options with which these layers are traced: where they lie on first hits alone, nothing else is.
pub fn options_of(wanted: &[Layer], options: &Options) -> Options {
    if wanted.iter().all(|layer| layer.is_geometric()) {
        Options { recursion: 0, shadows: Shadows::Off, light_samples: 1, ..options.clone() }
    } else {
        options.clone()
    }
}

//! Layers: what lies behind each pixel besides its colour (arbitrary output variables).
//!
//! A layer is a picture of numbers, of the ray through each pixel's centre: where it met something, on what, and what
//! each part of the formula gave there. Oversampling does not enter; a layer is data, and means of shape numbers mean
//! nothing.

use crate::camera::Camera;
use crate::error::RenderError;
use crate::observer::Observer;
use crate::observer::Progress;
use crate::options::Crop;
use crate::options::Options;
use crate::options::Shadows;
use crate::record::EyeRecord;
use crate::record::MetByEye;
use crate::sampler::Block;
use crate::threads::on_threads;
use crate::trace::Tracer;
use crate::world::World;
use dotray_accel::simd::level;
use dotray_geometry::Vec3;
use rayon::prelude::*;
use std::cmp::Reverse;
use std::sync::atomic::AtomicU64;
use std::sync::atomic::Ordering;

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

/// Computes layers of the window of the picture that `options` describe; `None` where the observer cancelled it.
///
/// # Errors
/// Options that make no sense; threads that cannot be started.
pub fn render_layers(
    world: &World,
    options: &Options,
    wanted: &[Layer],
    observer: &dyn Observer,
) -> Result<Option<Vec<LayerPicture>>, RenderError> {
    options.validate()?;
    let geometric = wanted.iter().all(|layer| layer.is_geometric());
    let first_hits = Options { recursion: 0, shadows: Shadows::Off, light_samples: 1, ..options.clone() };
    let options = if geometric { &first_hits } else { options };
    let window = options.window();
    let (width, height) = (window.width as usize, window.height as usize);
    let finished = AtomicU64::new(0);
    let total_pixels = width as u64 * height as u64;
    let bands = window.height.div_ceil(BAND);
    let band = |number: u32| -> Option<Vec<Vec<f32>>> {
        if observer.cancelled() {
            return None;
        }
        let from = window.y + number * BAND;
        let rows = Crop { y: from, height: BAND.min(window.y + window.height - from), ..window };
        let samples = samples_of(world, options, wanted, rows);
        let pixels = u64::from(rows.width) * u64::from(rows.height);
        let finished_pixels = finished.fetch_add(pixels, Ordering::Relaxed) + pixels;
        observer.tile_finished(&Progress { finished_pixels, total_pixels });
        Some(samples)
    };
    let run = || (0..bands).into_par_iter().with_max_len(1).map(band).collect::<Option<Vec<_>>>();
    let Some(bands) = on_threads(options.threads, run)? else { return Ok(None) };
    let picture = |(index, &layer): (usize, &Layer)| {
        let mut samples = Vec::with_capacity(width * height * layer.channels().len());
        bands.iter().for_each(|band| samples.extend_from_slice(&band[index]));
        LayerPicture { layer, width, height, samples }
    };
    Ok(Some(wanted.iter().enumerate().map(picture).collect()))
}

/// The rows that are traced together: as many as a brick of pixels has.
const BAND: u32 = 4;

/// The layers' numbers of some rows, the upper one first.
fn samples_of(world: &World, options: &Options, wanted: &[Layer], rows: Crop) -> Vec<Vec<f32>> {
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
    let numbers = |layer: &Layer| {
        let mut samples = Vec::with_capacity(places.len() * layer.channels().len());
        places.iter().for_each(|&place| layer.append(&records[place], &mut samples));
        samples
    };
    wanted.iter().map(numbers).collect()
}

//! What the caller chooses, by name.

use dotray_accel::Kind;
use dotray_accel::Quality;
use dotray_render::Antialias;
use dotray_render::Crop;
use dotray_render::Options;
use dotray_render::PrepareOptions;
use dotray_render::Shadows;
use dotray_render::TextureFilter;
use pyo3::exceptions::PyValueError;
use pyo3::prelude::*;

/// Threads where none are named: one for each core that the process may use. A number is always passed on, because the
/// common pool of threads does not survive a fork, and Python's worker processes are forks.
pub fn threads(asked: Option<usize>) -> usize {
    asked.unwrap_or_else(|| std::thread::available_parallelism().map_or(1, usize::from))
}

fn no_such(option: &str, value: &str, known: &str) -> PyErr {
    PyValueError::new_err(format!("{option} is {value:?}; expected {known}"))
}

/// How the accelerator is built.
#[derive(FromPyObject)]
#[pyo3(from_item_all)]
pub struct PrepareChoices {
    accel: String,
    quality: String,
    threads: Option<usize>,
}

impl PrepareChoices {
    /// As the renderer has them.
    pub fn options(&self) -> PyResult<PrepareOptions> {
        let accel = Kind::ALL.into_iter().find(|kind| kind.name() == self.accel);
        let quality = match self.quality.as_str() {
            "fast" => Quality::Fast,
            "balanced" => Quality::Balanced,
            "best" => Quality::Best,
            other => return Err(no_such("build", other, "'fast', 'balanced' or 'best'")),
        };
        Ok(PrepareOptions {
            accel: accel
                .ok_or_else(|| no_such("accel", &self.accel, "'bvh', 'boxes', 'octree', 'bsp' or 'brute'"))?,
            quality,
            threads: Some(threads(self.threads)),
            ..PrepareOptions::default()
        })
    }
}

/// What a picture is made by.
#[derive(FromPyObject)]
#[pyo3(from_item_all)]
pub struct Choices {
    width: u32,
    height: u32,
    crop: Option<(u32, u32, u32, u32)>,
    recursion: u32,
    cutoff: f64,
    aa: String,
    aa_grid: u32,
    aa_threshold: f64,
    aa_depth: u32,
    shadows: String,
    texture_filter: String,
    light_samples: u32,
    transparent: bool,
    threads: Option<usize>,
}

impl Choices {
    /// As the renderer has them.
    pub fn options(&self) -> PyResult<Options> {
        let antialias = match self.aa.as_str() {
            "none" => Antialias::None,
            "grid" => Antialias::Grid(self.aa_grid),
            "adaptive" => Antialias::Adaptive { threshold: self.aa_threshold, depth: self.aa_depth },
            other => return Err(no_such("aa", other, "'none', 'adaptive' or a number")),
        };
        let shadows = match self.shadows.as_str() {
            "filtered" => Shadows::Filtered,
            "opaque" => Shadows::Opaque,
            "off" => Shadows::Off,
            other => return Err(no_such("shadows", other, "'filtered', 'opaque' or 'off'")),
        };
        let texture_filter = match self.texture_filter.as_str() {
            "bilinear" => TextureFilter::Bilinear,
            "nearest" => TextureFilter::Nearest,
            other => return Err(no_such("texture_filter", other, "'bilinear' or 'nearest'")),
        };
        let options = Options {
            width: self.width,
            height: self.height,
            crop: self.crop.map(|(x, y, width, height)| Crop { x, y, width, height }),
            recursion: self.recursion,
            threshold: self.cutoff,
            antialias,
            shadows,
            texture_filter,
            light_samples: self.light_samples,
            transparent: self.transparent,
            threads: Some(threads(self.threads)),
            ..Options::default()
        };
        options.validate().map_err(|error| PyValueError::new_err(error.to_string()))?;
        Ok(options)
    }
}

//! What the caller chooses.

use crate::error::RenderError;
use dotray_accel::Kind;
use dotray_accel::Quality;

/// How a pixel's colour is sampled (SPEC 3 and 4).
#[derive(Clone, Copy, Debug, PartialEq, Default)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub enum Antialias {
    /// One ray through the pixel's centre.
    #[default]
    None,
    /// n × n rays through the centres of as many sub-pixels.
    Grid(u32),
    /// The slides' adaptive oversampling: rays through the corners, divided where they differ.
    Adaptive {
        /// The largest channel difference that passes.
        threshold: f64,
        /// How often a pixel may be divided.
        depth: u32,
    },
}

impl Antialias {
    /// Adaptive oversampling with the defaults of SPEC 4.
    pub const ADAPTIVE: Self = Self::Adaptive { threshold: 0.1, depth: 3 };
}

/// What lies between a point and a light (SPEC 6, S_i).
#[derive(Clone, Copy, Debug, PartialEq, Eq, Default)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub enum Shadows {
    /// Each surface crossed multiplies by kTrans · M_S.
    #[default]
    Filtered,
    /// Every surface blocks.
    Opaque,
    /// Nothing blocks.
    Off,
}

/// How a texture is read between its texels.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Default)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub enum TextureFilter {
    /// Between the centres of the four texels around.
    #[default]
    Bilinear,
    /// The texel that holds the point.
    Nearest,
}

/// In which order a picture comes into being.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Default)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub enum Order {
    /// Tile by tile along a Morton curve, which keeps caches warm.
    #[default]
    Morton,
    /// First two coarse looks at the whole picture, of a square of 16 and of 4 pixels a ray, then tile by tile: for
    /// somebody who watches. The looks cost a sixteenth of one ray a pixel.
    CoarseToFine,
}

/// A part of the picture: pixels counted from the upper left.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct Crop {
    /// The first column.
    pub x: u32,
    /// The first row from above.
    pub y: u32,
    /// Columns.
    pub width: u32,
    /// Rows.
    pub height: u32,
}

/// What the picture depends on besides the scene, and how it is computed.
#[derive(Clone, Debug, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct Options {
    /// Columns of the whole picture.
    pub width: u32,
    /// Rows of the whole picture.
    pub height: u32,
    /// Only this part is computed and stored.
    pub crop: Option<Crop>,
    /// Secondary rays are traced while their parent's depth is below.
    pub recursion: u32,
    /// The contribution threshold.
    pub threshold: f64,
    /// Samples a pixel.
    pub antialias: Antialias,
    /// Shadows.
    pub shadows: Shadows,
    /// Texture lookups.
    pub texture_filter: TextureFilter,
    /// Point lights that stand for one `#light_area`.
    pub light_samples: u32,
    /// The picture has an alpha channel: the share of a pixel's samples whose eye rays meet something. Eye rays that
    /// meet nothing then give no colour; mirrored and refracted ones see the background as ever.
    pub transparent: bool,
    /// The most pixels that the part which is computed may have.
    pub max_pixels: u64,
    /// Threads; `None` for one a core. The picture does not depend on it.
    pub threads: Option<usize>,
    /// The edge of a tile in pixels. The picture does not depend on it.
    pub tile_size: u32,
    /// The order of the tiles. The picture does not depend on it.
    pub order: Order,
}

impl Default for Options {
    fn default() -> Self {
        Self {
            width: 640,
            height: 480,
            crop: None,
            recursion: 5,
            threshold: 0.002,
            antialias: Antialias::None,
            shadows: Shadows::Filtered,
            texture_filter: TextureFilter::Bilinear,
            light_samples: 64,
            transparent: false,
            max_pixels: dotray_image::Limits::default().max_pixels,
            threads: None,
            tile_size: 32,
            order: Order::Morton,
        }
    }
}

/// The deepest recursion that may be asked for.
pub const MAX_RECURSION: u32 = 1000;
/// The finest grid that may be asked for.
pub const MAX_GRID: u32 = 64;
/// The most divisions that may be asked for.
pub const MAX_AA_DEPTH: u32 = 10;
/// The largest edge of a picture.
pub const MAX_EDGE: u32 = 1 << 20;

impl Options {
    /// The part of the picture that is computed: the crop or the whole.
    pub fn window(&self) -> Crop {
        self.crop.unwrap_or(Crop { x: 0, y: 0, width: self.width, height: self.height })
    }

    /// Whether the values make sense together.
    ///
    /// # Errors
    /// [`RenderError::Option`] that names the option, its value and what was expected.
    pub fn validate(&self) -> Result<(), RenderError> {
        let expect = |fine: bool, option: &'static str, value: String, expected: String| {
            if fine { Ok(()) } else { Err(RenderError::Option { option, value, expected }) }
        };
        let edge = format!("1 to {MAX_EDGE} pixels");
        expect((1..=MAX_EDGE).contains(&self.width), "width", self.width.to_string(), edge.clone())?;
        expect((1..=MAX_EDGE).contains(&self.height), "height", self.height.to_string(), edge)?;
        expect(
            self.recursion <= MAX_RECURSION,
            "recursion",
            self.recursion.to_string(),
            format!("0 to {MAX_RECURSION}"),
        )?;
        let threshold = self.threshold;
        expect(threshold.is_finite(), "cutoff", threshold.to_string(), "a finite number".to_owned())?;
        expect(
            (1..=1 << 16).contains(&self.light_samples),
            "light-samples",
            self.light_samples.to_string(),
            "1 to 65536".to_owned(),
        )?;
        expect(
            (8..=1024).contains(&self.tile_size),
            "tile-size",
            self.tile_size.to_string(),
            "8 to 1024".to_owned(),
        )?;
        match self.antialias {
            Antialias::None => {}
            Antialias::Grid(n) => {
                expect((1..=MAX_GRID).contains(&n), "aa grid", n.to_string(), format!("1 to {MAX_GRID}"))?;
            }
            Antialias::Adaptive { threshold, depth } => {
                expect(threshold >= 0.0, "aa-threshold", threshold.to_string(), "0 or more".to_owned())?;
                expect(depth <= MAX_AA_DEPTH, "aa-depth", depth.to_string(), format!("0 to {MAX_AA_DEPTH}"))?;
            }
        }
        if let Some(crop) = self.crop {
            let right = u64::from(crop.x) + u64::from(crop.width);
            let bottom = u64::from(crop.y) + u64::from(crop.height);
            let inside = crop.width > 0
                && crop.height > 0
                && right <= u64::from(self.width)
                && bottom <= u64::from(self.height);
            let value = format!("{},{},{},{}", crop.x, crop.y, crop.width, crop.height);
            let expected = format!("x,y,width,height inside the picture of {}x{}", self.width, self.height);
            expect(inside, "crop", value, expected)?;
        }
        Ok(())
    }
}

/// What is chosen before any ray is traced.
#[derive(Clone, Debug, PartialEq, Default)]
pub struct PrepareOptions {
    /// The accelerator. The picture does not depend on it.
    pub accel: Kind,
    /// Building time against tracing time.
    pub quality: Quality,
    /// Threads for baking and building; `None` for one a core.
    pub threads: Option<usize>,
    /// Limits of the textures' images.
    pub image_limits: dotray_image::Limits,
}

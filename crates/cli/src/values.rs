//! The kinds of values that options take.

use clap::ValueEnum;
use std::str::FromStr;

/// How pixels are sampled.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Default)]
pub enum Aa {
    /// One ray.
    #[default]
    None,
    /// N x N rays.
    Grid(u32),
    /// The slides' adaptive oversampling.
    Adaptive,
}

impl FromStr for Aa {
    type Err = String;

    fn from_str(text: &str) -> Result<Self, String> {
        match text {
            "none" => Ok(Self::None),
            "adaptive" => Ok(Self::Adaptive),
            grid => match grid.strip_prefix("grid=").map(str::parse) {
                Some(Ok(n)) => Ok(Self::Grid(n)),
                Some(Err(_)) | None => Err("expected none, grid=N (such as grid=3) or adaptive".to_owned()),
            },
        }
    }
}

/// A number of bytes.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct ByteCount(pub u64);

impl FromStr for ByteCount {
    type Err = String;

    fn from_str(text: &str) -> Result<Self, String> {
        const UNITS: [(&str, u32); 4] = [("K", 10), ("M", 20), ("G", 30), ("T", 40)];
        let upper = text.trim().to_ascii_uppercase();
        let plain = upper.strip_suffix("IB").or(upper.strip_suffix('B')).unwrap_or(&upper);
        let unit = UNITS.into_iter().find_map(|(unit, shift)| Some((plain.strip_suffix(unit)?, shift)));
        let (digits, shift) = unit.unwrap_or((plain, 0));
        let bytes = digits.trim().parse::<u64>().ok().and_then(|count| count.checked_mul(1 << shift));
        bytes.map(Self).ok_or_else(|| "expected a number of bytes, such as 1000000, 500M or 4G".to_owned())
    }
}

/// Columns and rows.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Size(pub u32, pub u32);

impl FromStr for Size {
    type Err = String;

    fn from_str(text: &str) -> Result<Self, String> {
        let parts = text.split_once(['x', 'X']).map(|(width, height)| (width.parse(), height.parse()));
        match parts {
            Some((Ok(width), Ok(height))) => Ok(Self(width, height)),
            Some((Ok(_) | Err(_), _)) | None => Err("expected WIDTHxHEIGHT, such as 800x600".to_owned()),
        }
    }
}

/// Four numbers: the upper left pixel, columns and rows.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct CropArg(pub [u32; 4]);

impl FromStr for CropArg {
    type Err = String;

    fn from_str(text: &str) -> Result<Self, String> {
        let numbers: Option<Vec<u32>> = text.split(',').map(|part| part.trim().parse().ok()).collect();
        let four: Option<[u32; 4]> = numbers.and_then(|numbers| numbers.try_into().ok());
        four.map(Self).ok_or_else(|| "expected x,y,width,height in pixels, such as 100,50,64,64".to_owned())
    }
}

/// The picture formats by name.
#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
pub enum FormatName {
    /// Windows bitmap, 24 bits
    Bmp,
    /// PNG, 8 bits a channel
    Png,
    /// PNG, 16 bits a channel
    Png16,
    /// JPEG
    #[value(alias = "jpg")]
    Jpeg,
    /// Portable pixmap
    #[value(alias = "pnm")]
    Ppm,
    /// Quite OK Image
    Qoi,
    /// TIFF
    #[value(alias = "tif")]
    Tiff,
    /// OpenEXR, floats
    Exr,
    /// Radiance HDR, floats
    Hdr,
    /// Portable float map
    Pfm,
}

/// Bits a channel.
#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
pub enum Depth {
    /// 256 steps
    #[value(name = "8")]
    Eight,
    /// 65536 steps
    #[value(name = "16")]
    Sixteen,
}

/// Shadow modes.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Default, ValueEnum)]
pub enum ShadowMode {
    /// Glass colours the light that passes
    #[default]
    Filtered,
    /// Every surface blocks
    Opaque,
    /// No shadows
    Off,
}

/// Texture filters.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Default, ValueEnum)]
pub enum Filter {
    /// Between the four nearest
    #[default]
    Bilinear,
    /// The one that holds the point
    Nearest,
}

/// What becomes of a texture whose file is nowhere.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Default, ValueEnum)]
pub enum MissingTexture {
    /// No picture is made
    #[default]
    Error,
    /// White takes its place
    White,
}

/// What a comparison forgives.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Default, ValueEnum)]
pub enum ProfileName {
    /// The rounding to 8 bits
    Exact,
    /// Single pixels on edges besides
    #[default]
    Strict,
    /// Noise and other oversampling besides
    Lenient,
}

/// Accelerators.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Default, ValueEnum)]
pub enum Accel {
    /// Every shape is tested
    Brute,
    /// Bounding boxes along the scene's groups
    Boxes,
    /// Octree
    Octree,
    /// Binary space partition
    Bsp,
    /// Bounding-volume hierarchy
    #[default]
    Bvh,
}

/// Building effort.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Default, ValueEnum)]
pub enum Build {
    /// The quickest build
    Fast,
    /// For one picture
    #[default]
    Balanced,
    /// For large pictures
    Best,
}

impl Build {
    /// As it is typed.
    pub fn word(self) -> &'static str {
        match self {
            Self::Fast => "fast",
            Self::Balanced => "balanced",
            Self::Best => "best",
        }
    }
}

/// Text for people, JSON for programs.
#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
pub enum TextOrJson {
    /// For people.
    Text,
    /// One JSON object.
    Json,
}

/// When to use colour.
#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
pub enum When {
    /// On a terminal, unless NO_COLOR is set.
    Auto,
    /// Also into files and pipes.
    Always,
    /// Not at all.
    Never,
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn words_become_values() {
        assert_eq!("grid=3".parse(), Ok(Aa::Grid(3)));
        assert_eq!("adaptive".parse(), Ok(Aa::Adaptive));
        for wrong in ["grid", "grid=", "grid=-1", "grid=x", "Adaptive", ""] {
            assert!(wrong.parse::<Aa>().is_err(), "{wrong}");
        }
        assert_eq!("800x600".parse(), Ok(Size(800, 600)));
        for wrong in ["800", "800x", "x600", "800x600x2", "-1x2", "99999999999x2"] {
            assert!(wrong.parse::<Size>().is_err(), "{wrong}");
        }
        for (text, bytes) in [("17", 17), ("4G", 4 << 30), ("3 mib", 3 << 20), ("1kB", 1024), ("0", 0)] {
            assert_eq!(text.parse(), Ok(ByteCount(bytes)));
        }
        for wrong in ["", "G", "-1", "1.5G", "4X", "99999999999T"] {
            assert!(wrong.parse::<ByteCount>().is_err(), "{wrong}");
        }
        assert_eq!("1, 2,3,4".parse(), Ok(CropArg([1, 2, 3, 4])));
        for wrong in ["1,2,3", "1,2,3,4,5", "1,2,3,-4", "a,b,c,d", ""] {
            assert!(wrong.parse::<CropArg>().is_err(), "{wrong}");
        }
    }
}

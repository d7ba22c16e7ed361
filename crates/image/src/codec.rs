//! Bytes of a file to a picture and back, whatever the format.

use crate::bmp;
use crate::error::ImageError;
use crate::format::Format;
use crate::hdr;
use crate::image::Image;
use crate::limits::Limits;
#[cfg(feature = "formats")]
use crate::openexr;
use crate::pfm;
use crate::pnm;
#[cfg(feature = "formats")]
use crate::raster;
#[cfg(feature = "formats")]
use crate::raster::Raster;

/// How a picture is stored.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct EncodeOptions {
    /// Applies the sRGB curve before values are made whole numbers; float formats ignore it.
    pub srgb: bool,
    /// From 1 (small) to 100 (good).
    pub jpeg_quality: u8,
}

impl Default for EncodeOptions {
    /// Values as they are, JPEG quality 95.
    fn default() -> Self {
        EncodeOptions { srgb: false, jpeg_quality: 95 }
    }
}

/// Makes a picture of the bytes of a file. What the bytes begin with tells the format; only if that says nothing, the
/// `hint` (from the file name) counts.
///
/// Whole numbers become fractions of the greatest one (value/255, value/65535), floats stay as they are, grey becomes
/// three equal channels, and an alpha channel is kept.
///
/// # Errors
/// An [`ImageError`] that names what is wrong in the file and where, or the limit that it passes.
///
/// ```
/// use dotray_image::{Limits, decode};
///
/// let image = decode(b"P3 1 1 255  255 0 51", None, &Limits::default())?;
/// assert_eq!(image.samples(), [1.0, 0.0, 0.2]);
/// let message = decode(b"P3 1 1 255  255 0", None, &Limits::default()).unwrap_err().to_string();
/// assert_eq!(message, "PPM file ends at byte 17, too early for a sample: 1 bytes from byte 17 on");
/// # Ok::<(), dotray_image::ImageError>(())
/// ```
pub fn decode(bytes: &[u8], hint: Option<Format>, limits: &Limits) -> Result<Image, ImageError> {
    let Some(format) = Format::sniff(bytes).or(hint) else {
        return Err(unknown_content(bytes));
    };
    match format {
        Format::Bmp => bmp::decode(bytes, limits),
        Format::Ppm => pnm::decode(bytes, limits),
        Format::Hdr => hdr::decode(bytes, limits),
        Format::Pfm => pfm::decode(bytes, limits),
        #[cfg(feature = "formats")]
        Format::Png | Format::Png16 => raster::decode(bytes, Raster::Png, limits),
        #[cfg(feature = "formats")]
        Format::Jpeg => raster::decode(bytes, Raster::Jpeg, limits),
        #[cfg(feature = "formats")]
        Format::Qoi => raster::decode(bytes, Raster::Qoi, limits),
        #[cfg(feature = "formats")]
        Format::Tiff => raster::decode(bytes, Raster::Tiff, limits),
        #[cfg(feature = "formats")]
        Format::Exr => openexr::decode(bytes, limits),
        #[cfg(not(feature = "formats"))]
        Format::Png | Format::Png16 | Format::Jpeg | Format::Qoi | Format::Tiff | Format::Exr => {
            Err(ImageError::NotBuilt { format: format.name() })
        }
    }
}

fn unknown_content(bytes: &[u8]) -> ImageError {
    let first: Vec<String> = bytes.iter().take(8).map(|byte| format!("{byte:02x}")).collect();
    let found = if first.is_empty() { "nothing".to_string() } else { first.join(" ") };
    let known = Format::ALL.into_iter().map(Format::name).collect::<Vec<_>>().join(", ");
    ImageError::UnknownContent { found, known }
}

/// Makes the bytes of a file of a picture; the same picture always gives the same bytes.
///
/// Formats of whole numbers get round(255·clamp(c, 0, 1)), float formats the values as they are. PNG, QOI, TIFF and
/// OpenEXR keep an alpha channel, the others leave it out. In OpenEXR colours are multiplied by alpha, as its readers
/// expect; in the others they are not.
///
/// # Errors
/// [`ImageError::Encoder`] if the format cannot hold the picture, [`ImageError::JpegQuality`] for a quality outside 1
/// to 100, [`ImageError::NotBuilt`] for a format that is left out of this build.
pub fn encode(image: &Image, format: Format, options: &EncodeOptions) -> Result<Vec<u8>, ImageError> {
    if format == Format::Jpeg && !(1..=100).contains(&options.jpeg_quality) {
        return Err(ImageError::JpegQuality { quality: options.jpeg_quality });
    }
    #[cfg(feature = "formats")]
    let through_crate = |raster| raster::encode(image, raster, options.srgb, options.jpeg_quality);
    match format {
        Format::Bmp => bmp::encode(image, options.srgb),
        Format::Ppm => Ok(pnm::encode(image, options.srgb)),
        Format::Hdr => Ok(hdr::encode(image)),
        Format::Pfm => Ok(pfm::encode(image)),
        #[cfg(feature = "formats")]
        Format::Png => through_crate(Raster::Png),
        #[cfg(feature = "formats")]
        Format::Png16 => through_crate(Raster::Png16),
        #[cfg(feature = "formats")]
        Format::Jpeg => through_crate(Raster::Jpeg),
        #[cfg(feature = "formats")]
        Format::Qoi => through_crate(Raster::Qoi),
        #[cfg(feature = "formats")]
        Format::Tiff => through_crate(Raster::Tiff),
        #[cfg(feature = "formats")]
        Format::Exr => openexr::encode(image),
        #[cfg(not(feature = "formats"))]
        Format::Png | Format::Png16 | Format::Jpeg | Format::Qoi | Format::Tiff | Format::Exr => {
            Err(ImageError::NotBuilt { format: format.name() })
        }
    }
}

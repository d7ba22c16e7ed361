//! PNG, JPEG, QOI and TIFF through the `image` crate.

use std::io::Cursor;

use image::ColorType;
use image::ExtendedColorType;
use image::ImageDecoder;
use image::ImageEncoder;
use image::codecs::jpeg::JpegDecoder;
use image::codecs::jpeg::JpegEncoder;
use image::codecs::png::CompressionType;
use image::codecs::png::FilterType;
use image::codecs::png::PngDecoder;
use image::codecs::png::PngEncoder;
use image::codecs::qoi::QoiDecoder;
use image::codecs::qoi::QoiEncoder;
use image::codecs::tiff::TiffDecoder;
use image::codecs::tiff::TiffEncoder;

use crate::error::ImageError;
use crate::guard::guarded;
use crate::image::Channels;
use crate::image::Image;
use crate::limits::Limits;
use crate::quantise::to_srgb_u8;
use crate::quantise::to_srgb_u16;
use crate::quantise::to_u8;
use crate::quantise::to_u16;

/// The formats of this module.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum Raster {
    Png,
    Png16,
    Jpeg,
    Qoi,
    Tiff,
}

impl Raster {
    fn name(self) -> &'static str {
        match self {
            Raster::Png => "PNG",
            Raster::Png16 => "PNG-16",
            Raster::Jpeg => "JPEG",
            Raster::Qoi => "QOI",
            Raster::Tiff => "TIFF",
        }
    }

    /// No file of this format holds more pixels than this for each of its bytes: a header that claims more lies.
    fn most_pixels_per_byte(self) -> Option<u64> {
        match self {
            // One bit a pixel, and deflate cannot shrink by more than 1032.
            Raster::Png | Raster::Png16 => Some(8 * 1032),
            // The longest run in a byte.
            Raster::Qoi => Some(62),
            // Progressive scans and nested codes shrink without a simple bound; the limits alone count.
            Raster::Jpeg | Raster::Tiff => None,
        }
    }
}

/// Reads a file of one of these formats.
pub(crate) fn decode(file: &[u8], raster: Raster, limits: &Limits) -> Result<Image, ImageError> {
    let mut refused = None;
    let crate_limits = crate_limits(limits);
    let decoded = guarded(|| {
        let source = Cursor::new(file);
        let mut read =
            |decoder: Box<dyn ImageDecoder + '_>| read(decoder, file, raster, limits, &mut refused);
        let text = |error: image::ImageError| error.to_string();
        match raster {
            Raster::Png | Raster::Png16 => {
                read(Box::new(PngDecoder::with_limits(source, crate_limits).map_err(text)?))
            }
            Raster::Jpeg => read(Box::new(JpegDecoder::new(source).map_err(text)?)),
            Raster::Qoi => read(Box::new(QoiDecoder::new(source).map_err(text)?)),
            Raster::Tiff => read(Box::new(TiffDecoder::new(source).map_err(text)?)),
        }
    });
    decoded.map_err(|message| refused.unwrap_or(ImageError::Decoder { format: raster.name(), message }))
}

fn crate_limits(limits: &Limits) -> image::Limits {
    let mut crate_limits = image::Limits::no_limits();
    crate_limits.max_alloc = Some(limits.max_bytes);
    crate_limits
}

/// Checks the size and reads the pixels; a refusal of ours is left in `refused`.
fn read(
    mut decoder: Box<dyn ImageDecoder + '_>,
    file: &[u8],
    raster: Raster,
    limits: &Limits,
    refused: &mut Option<ImageError>,
) -> Result<Image, String> {
    let colour = decoder.color_type();
    let checked = || {
        let (width, height) = decoder.dimensions();
        let channels = if colour.has_alpha() { Channels::Rgba } else { Channels::Rgb };
        // Our samples, and the decoder's bytes beside them.
        let bytes_per_pixel = 4 * channels.count() as u64 + u64::from(colour.bytes_per_pixel());
        let (columns, rows) = limits.check(width.into(), height.into(), bytes_per_pixel)?;
        let pixels = u64::from(width) * u64::from(height);
        if let Some(most) = raster.most_pixels_per_byte()
            && pixels > most.saturating_mul(file.len() as u64)
        {
            let length = file.len() as u64;
            let needed = pixels.div_ceil(most);
            return Err(ImageError::Truncated {
                format: raster.name(),
                what: "the picture of that size",
                offset: 0,
                needed,
                length,
            });
        }
        Ok((columns, rows, channels))
    };
    let (width, height, channels) = checked().map_err(|error| {
        let message = error.to_string();
        *refused = Some(error);
        message
    })?;
    decoder.set_limits(crate_limits(limits)).map_err(|error| error.to_string())?;
    let bytes = usize::try_from(decoder.total_bytes()).map_err(|error| error.to_string())?;
    let mut buffer = Vec::new();
    buffer.try_reserve_exact(bytes).map_err(|error| error.to_string())?;
    buffer.resize(bytes, 0);
    decoder.read_image(&mut buffer).map_err(|error| error.to_string())?;
    let samples = samples_of(&buffer, colour)?;
    Image::from_samples(width, height, channels, samples).map_err(|error| error.to_string())
}

/// The decoder's bytes as samples, greys as three equal ones.
fn samples_of(buffer: &[u8], colour: ColorType) -> Result<Vec<f32>, String> {
    let of_u8 = |&byte: &u8| f32::from(byte) / 255.0;
    let of_u16 = |&pair: &[u8; 2]| f32::from(u16::from_ne_bytes(pair)) / 65535.0;
    let of_f32 = |&four: &[u8; 4]| f32::from_ne_bytes(four);
    let samples = match colour {
        ColorType::L8 => buffer.iter().map(of_u8).flat_map(|grey| [grey; 3]).collect(),
        ColorType::La8 => {
            let pixels = buffer.as_chunks::<2>().0.iter();
            pixels.map(|[grey, alpha]| [of_u8(grey), of_u8(alpha)]).flat_map(|[l, a]| [l, l, l, a]).collect()
        }
        ColorType::Rgb8 | ColorType::Rgba8 => buffer.iter().map(of_u8).collect(),
        ColorType::L16 => buffer.as_chunks::<2>().0.iter().map(of_u16).flat_map(|grey| [grey; 3]).collect(),
        ColorType::La16 => {
            let pixels = buffer.as_chunks::<2>().0.as_chunks::<2>().0.iter();
            pixels
                .map(|[grey, alpha]| [of_u16(grey), of_u16(alpha)])
                .flat_map(|[l, a]| [l, l, l, a])
                .collect()
        }
        ColorType::Rgb16 | ColorType::Rgba16 => buffer.as_chunks::<2>().0.iter().map(of_u16).collect(),
        ColorType::Rgb32F | ColorType::Rgba32F => buffer.as_chunks::<4>().0.iter().map(of_f32).collect(),
        // The crate's list is open, so a rest cannot be avoided here.
        other => return Err(format!("its pixels are of the kind {other:?}, which is not read here")),
    };
    Ok(samples)
}

/// The bytes of a file; JPEG leaves alpha out, the others keep it.
pub(crate) fn encode(
    image: &Image,
    raster: Raster,
    srgb: bool,
    jpeg_quality: u8,
) -> Result<Vec<u8>, ImageError> {
    let failed = |message: String| ImageError::Encoder {
        format: raster.name(),
        width: image.width(),
        height: image.height(),
        message,
    };
    let width = u32::try_from(image.width()).map_err(|error| failed(error.to_string()))?;
    let height = u32::try_from(image.height()).map_err(|error| failed(error.to_string()))?;
    let mut file = Vec::new();
    let written = guarded(|| {
        let (eight, sixteen) = match image.channels() {
            Channels::Rgb => (ExtendedColorType::Rgb8, ExtendedColorType::Rgb16),
            Channels::Rgba => (ExtendedColorType::Rgba8, ExtendedColorType::Rgba16),
        };
        // Measured: adaptive filters take 2.5 ms a megapixel, a fixed one 1.7 to 2.1 and up to twice the bytes.
        let png = |file| PngEncoder::new_with_quality(file, CompressionType::Fast, FilterType::Adaptive);
        // The encoders write a few bytes at a time, which a vector takes much faster than a cursor on it.
        let sink = &mut file;
        let result = match raster {
            Raster::Png => png(sink).write_image(&bytes_of(image, srgb), width, height, eight),
            Raster::Png16 => png(sink).write_image(&words_of(image, srgb), width, height, sixteen),
            Raster::Jpeg => JpegEncoder::new_with_quality(sink, jpeg_quality).write_image(
                &image.to_rgb8(srgb),
                width,
                height,
                ExtendedColorType::Rgb8,
            ),
            Raster::Qoi => QoiEncoder::new(sink).write_image(&bytes_of(image, srgb), width, height, eight),
            Raster::Tiff => {
                TiffEncoder::new(Cursor::new(sink)).write_image(&bytes_of(image, srgb), width, height, eight)
            }
        };
        result.map_err(|error| error.to_string())
    });
    written.map_err(failed)?;
    Ok(file)
}

/// All channels as bytes; the curve never touches alpha.
fn bytes_of(image: &Image, srgb: bool) -> Vec<u8> {
    match image.channels() {
        Channels::Rgb => image.to_rgb8(srgb),
        Channels::Rgba => {
            let colour = if srgb { to_srgb_u8 } else { to_u8 };
            let pixels = image.samples().as_chunks::<4>().0.iter();
            pixels.flat_map(|&[r, g, b, a]| [colour(r), colour(g), colour(b), to_u8(a)]).collect()
        }
    }
}

/// All channels as 16-bit words in the machine's byte order, which the encoder wants.
fn words_of(image: &Image, srgb: bool) -> Vec<u8> {
    let colour = if srgb { to_srgb_u16 } else { to_u16 };
    let count = image.channels().count();
    let mut words = vec![0; image.samples().len() * 2];
    let stored = words.as_chunks_mut::<2>().0.chunks_exact_mut(count);
    for (stored, pixel) in stored.zip(image.samples().chunks_exact(count)) {
        for (channel, (stored, &sample)) in stored.iter_mut().zip(pixel).enumerate() {
            let word = if channel < 3 { colour(sample) } else { to_u16(sample) };
            *stored = word.to_ne_bytes();
        }
    }
    words
}

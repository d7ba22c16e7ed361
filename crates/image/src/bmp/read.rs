//! BMP pixels to a picture.

use crate::bmp::header;
use crate::bmp::header::Header;
use crate::bmp::header::Masks;
use crate::bmp::header::Pixels;
use crate::bmp::rle;
use crate::bytes::Bytes;
use crate::error::ImageError;
use crate::image::Channels;
use crate::image::Image;
use crate::limits::Limits;

/// Reads a BMP file of any kind.
pub(crate) fn decode(file: &[u8], limits: &Limits) -> Result<Image, ImageError> {
    let header = header::read(file)?;
    let channels = match header.pixels {
        Pixels::Masked { masks, .. } if masks.alpha != 0 => Channels::Rgba,
        Pixels::Masked { .. } | Pixels::Indexed { .. } | Pixels::Rle8 | Pixels::Rle4 | Pixels::Bgr => {
            Channels::Rgb
        }
    };
    // One byte more a pixel for the palette entries of run-length codes.
    let bytes_per_pixel = 4 * channels.count() as u64 + 1;
    let (width, height) = limits.check(u64::from(header.width), u64::from(header.height), bytes_per_pixel)?;
    let bytes = Bytes::new(file, "BMP").at(header.data_offset);
    let samples = match header.pixels {
        Pixels::Indexed { bits } => indexed(&bytes, &header, width, height, bits)?,
        Pixels::Rle8 => run_length(bytes, &header, width, height, rle::Depth::Eight)?,
        Pixels::Rle4 => run_length(bytes, &header, width, height, rle::Depth::Four)?,
        Pixels::Bgr => {
            let rows = Rows::new(&bytes, &header, width, height, 24)?;
            let value = |&byte: &u8| f32::from(byte) / 255.0;
            rows.samples(3, |row, out| {
                out.extend(row.as_chunks::<3>().0.iter().flat_map(|[b, g, r]| [r, g, b]).map(value))
            })
        }
        Pixels::Masked { bits, masks } => {
            let rows = Rows::new(&bytes, &header, width, height, bits)?;
            rows.samples(channels.count(), |row, out| masked_row(row, bits, masks, out))
        }
    };
    Image::from_samples(width, height, channels, samples)
}

/// The rows of uncompressed pixels, padded to four bytes each in the file.
struct Rows<'a> {
    /// From the first row to the last without the padding behind it, which some programs leave out.
    stored: &'a [u8],
    used_bytes: usize,
    padded_bytes: usize,
    width: usize,
    height: usize,
    top_down: bool,
}

impl<'a> Rows<'a> {
    fn new(
        bytes: &Bytes<'a>,
        header: &Header,
        width: usize,
        height: usize,
        bits: u32,
    ) -> Result<Self, ImageError> {
        // In 64 bits, because the product may pass usize where that has 32.
        let used_bytes = (width as u64 * u64::from(bits)).div_ceil(8);
        let padded_bytes = used_bytes.next_multiple_of(4);
        let needed = padded_bytes * (height as u64 - 1) + used_bytes;
        let stored = match usize::try_from(needed) {
            Ok(needed) => bytes.clone().take(needed, "the pixels")?,
            Err(_) => return Err(bytes.truncated("the pixels", needed)),
        };
        let (used_bytes, padded_bytes) = (used_bytes as usize, padded_bytes as usize);
        Ok(Rows { stored, used_bytes, padded_bytes, width, height, top_down: header.top_down })
    }

    /// The row that stands `y` rows below the upper one, without padding, and its offset among the pixels.
    fn row(&self, y: usize) -> (&'a [u8], usize) {
        let stored_row = if self.top_down { y } else { self.height - 1 - y };
        let start = stored_row * self.padded_bytes;
        (self.stored.get(start..start + self.used_bytes).unwrap_or_default(), start)
    }

    /// The samples of all rows, the upper one first; `convert` appends those of one row.
    fn samples(&self, per_pixel: usize, mut convert: impl FnMut(&[u8], &mut Vec<f32>)) -> Vec<f32> {
        let mut samples = Vec::with_capacity(self.width * self.height * per_pixel);
        (0..self.height).for_each(|y| convert(self.row(y).0, &mut samples));
        samples
    }
}

/// Pixels of 16 or 32 bits: each channel's bits as a share of the greatest number they can hold.
fn masked_row(row: &[u8], bits: u32, masks: Masks, out: &mut Vec<f32>) {
    let pixels: &mut dyn Iterator<Item = u32> = if bits == 16 {
        &mut row.as_chunks::<2>().0.iter().map(|&pixel| u32::from(u16::from_le_bytes(pixel)))
    } else {
        &mut row.as_chunks::<4>().0.iter().map(|&pixel| u32::from_le_bytes(pixel))
    };
    let channel = |pixel: u32, mask: u32| {
        let shift = mask.trailing_zeros() & 31;
        // In double precision, because a channel may have more bits than an f32 holds exactly.
        (f64::from((pixel & mask) >> shift) / f64::from((mask >> shift).max(1))) as f32
    };
    for pixel in pixels {
        out.extend([masks.red, masks.green, masks.blue].map(|mask| channel(pixel, mask)));
        if masks.alpha != 0 {
            out.push(channel(pixel, masks.alpha));
        }
    }
}

/// Uncompressed palette entries, the leftmost pixel in the highest bits of a byte.
fn indexed(
    bytes: &Bytes<'_>,
    header: &Header,
    width: usize,
    height: usize,
    bits: u32,
) -> Result<Vec<f32>, ImageError> {
    let rows = Rows::new(bytes, header, width, height, bits)?;
    let mut samples = Vec::with_capacity(width * height * 3);
    let per_byte = 8 / bits as usize;
    let low_bits = 0xff_u8 >> (8 - bits);
    for y in 0..height {
        let (row, row_start) = rows.row(y);
        let entries = row.iter().flat_map(|&byte| {
            (1..=per_byte).map(move |place| (byte >> (8 - place as u32 * bits)) & low_bits)
        });
        for (x, entry) in entries.take(width).enumerate() {
            match header.palette.get(usize::from(entry)) {
                Some(colour) => samples.extend(colour),
                None => return Err(no_entry(bytes, header, row_start + x / per_byte, entry)),
            }
        }
    }
    Ok(samples)
}

/// The error for a palette entry that is not there, `place` bytes behind the first pixel.
fn no_entry(bytes: &Bytes<'_>, header: &Header, place: usize, entry: u8) -> ImageError {
    let expected = format!("less than {}, the length of the palette", header.palette.len());
    bytes.invalid(header.data_offset + place, "a pixel's palette entry", entry, expected)
}

fn run_length(
    mut bytes: Bytes<'_>,
    header: &Header,
    width: usize,
    height: usize,
    depth: rle::Depth,
) -> Result<Vec<f32>, ImageError> {
    let entries = rle::decode(&mut bytes, depth, width, height)?;
    let mut samples = Vec::with_capacity(width * height * 3);
    let mut append = |row: &[u8]| {
        row.iter().try_for_each(|&entry| match header.palette.get(usize::from(entry)) {
            Some(colour) => {
                samples.extend(colour);
                Ok(())
            }
            // The code has no fixed place for a pixel, so the message names where the pixels begin.
            None => Err(no_entry(&bytes, header, 0, entry)),
        })
    };
    if header.top_down {
        entries.chunks_exact(width).try_for_each(&mut append)?;
    } else {
        entries.chunks_exact(width).rev().try_for_each(&mut append)?;
    }
    Ok(samples)
}

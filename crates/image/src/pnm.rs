//! Netpbm: `P1` to `P6` in, `P6` out.

use crate::bytes::Bytes;
use crate::bytes::shown;
use crate::error::ImageError;
use crate::image::Channels;
use crate::image::Image;
use crate::limits::Limits;

/// What one sample means and how it is stored.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum Kind {
    /// 0 is white, 1 is black.
    Bitmap,
    Grey,
    Colour,
}

/// The bytes of a binary pixmap with 8 bits a channel; alpha is left out.
pub(crate) fn encode(image: &Image, srgb: bool) -> Vec<u8> {
    let mut file = format!("P6\n{} {}\n255\n", image.width(), image.height()).into_bytes();
    file.extend(image.to_rgb8(srgb));
    file
}

/// Reads a bitmap, grey map or pixmap, as text or binary.
pub(crate) fn decode(file: &[u8], limits: &Limits) -> Result<Image, ImageError> {
    let mut bytes = Bytes::new(file, "PPM");
    let magic = bytes.take(2, "the signature `P1` to `P6`")?;
    let (kind, binary) = match magic {
        b"P1" => (Kind::Bitmap, false),
        b"P2" => (Kind::Grey, false),
        b"P3" => (Kind::Colour, false),
        b"P4" => (Kind::Bitmap, true),
        b"P5" => (Kind::Grey, true),
        b"P6" => (Kind::Colour, true),
        other => return Err(bytes.invalid(0, "the signature", shown(other), "`P1` to `P6`")),
    };
    let width = bytes.decimal("the width", u32::MAX)?;
    let height = bytes.decimal("the height", u32::MAX)?;
    let max = match kind {
        Kind::Bitmap => 1,
        Kind::Grey | Kind::Colour => bytes.decimal("the greatest value", 65535)?,
    };
    // Grey samples stand beside the three that they become.
    let (width, height) = limits.check(u64::from(width), u64::from(height), 16)?;
    let per_pixel = if kind == Kind::Colour { 3 } else { 1 };
    let values = width * height * per_pixel;
    let samples = match (binary, kind) {
        (true, Kind::Bitmap) => binary_bits(&mut bytes, width, height)?,
        (true, Kind::Grey | Kind::Colour) => binary_values(&mut bytes, values, max)?,
        (false, _) => text_values(&mut bytes, values, kind, max)?,
    };
    let samples = match kind {
        Kind::Colour => samples,
        Kind::Grey | Kind::Bitmap => samples.into_iter().flat_map(|grey| [grey; 3]).collect(),
    };
    Image::from_samples(width, height, Channels::Rgb, samples)
}

fn binary_values(bytes: &mut Bytes<'_>, values: usize, max: u32) -> Result<Vec<f32>, ImageError> {
    bytes.take(1, "the white space after the header")?;
    let start = bytes.position();
    let width = if max < 256 { 1 } else { 2 };
    let needed = values as u64 * width as u64;
    let stored = match usize::try_from(needed) {
        Ok(needed) => bytes.take(needed, "the pixels")?,
        Err(_) => return Err(bytes.truncated("the pixels", needed)),
    };
    let samples = match width {
        1 => scaled(stored.iter().copied().map(u32::from), max),
        // The most significant byte comes first.
        _ => scaled(stored.as_chunks::<2>().0.iter().map(|&pair| u16::from_be_bytes(pair).into()), max),
    };
    samples.map_err(|(place, value)| {
        bytes.invalid(start + place * width, "a sample", value, format!("at most {max}"))
    })
}

/// The values as shares of the greatest one, or the first that is greater than that, with its place.
fn scaled(values: impl Iterator<Item = u32> + Clone, max: u32) -> Result<Vec<f32>, (usize, u32)> {
    match values.clone().enumerate().find(|(_, value)| *value > max) {
        Some(fault) => Err(fault),
        None => Ok(values.map(|value| value as f32 / max as f32).collect()),
    }
}

/// One bit a pixel, the leftmost in the highest bit, rows filled up to whole bytes.
fn binary_bits(bytes: &mut Bytes<'_>, width: usize, height: usize) -> Result<Vec<f32>, ImageError> {
    bytes.take(1, "the white space after the header")?;
    let row_bytes = width.div_ceil(8);
    let stored = bytes.take(row_bytes * height, "the pixels")?;
    let mut samples = Vec::with_capacity(width * height);
    for row in stored.chunks_exact(row_bytes) {
        let bits = row.iter().flat_map(|&byte| (0..8).map(move |bit| byte >> (7 - bit) & 1));
        samples.extend(bits.take(width).map(|bit| f32::from(1 - bit)));
    }
    Ok(samples)
}

fn text_values(bytes: &mut Bytes<'_>, values: usize, kind: Kind, max: u32) -> Result<Vec<f32>, ImageError> {
    // Digits of bitmaps may touch, other numbers have white space between them.
    let least = if kind == Kind::Bitmap { values } else { values.saturating_mul(2) - 1 };
    if bytes.remaining() < least {
        return Err(bytes.truncated("the pixels", least as u64));
    }
    let mut samples = Vec::with_capacity(values);
    while samples.len() < values {
        let word = bytes.word("a sample")?;
        let offset = bytes.position() - word.len();
        if kind == Kind::Bitmap {
            for (place, &digit) in word.iter().enumerate().take(values - samples.len()) {
                match digit {
                    b'0' => samples.push(1.0),
                    b'1' => samples.push(0.0),
                    other => return Err(bytes.invalid(offset + place, "a pixel", shown(&[other]), "0 or 1")),
                }
            }
            continue;
        }
        let value = std::str::from_utf8(word).ok().and_then(|text| text.parse::<u32>().ok());
        match value {
            Some(value) if value <= max => samples.push(value as f32 / max as f32),
            Some(_) | None => {
                let expected = format!("a whole number up to {max}");
                return Err(bytes.invalid(offset, "a sample", shown(word), expected));
            }
        }
    }
    Ok(samples)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn read(file: &[u8]) -> Result<Image, ImageError> {
        decode(file, &Limits::default())
    }

    #[test]
    fn all_six_kinds() {
        let black_white = [0.0, 0.0, 0.0, 1.0, 1.0, 1.0];
        assert_eq!(read(b"P1 2 1 10").unwrap().samples(), black_white);
        assert_eq!(read(b"P4\n2 1\n\x80").unwrap().samples(), black_white);
        assert_eq!(read(b"P2 # grey\n2 1 4 0 4").unwrap().samples(), black_white);
        assert_eq!(read(b"P5 2 1 4\n\x00\x04").unwrap().samples(), black_white);
        assert_eq!(read(b"P3\n1 1\n10\n0 5 10\n").unwrap().samples(), [0.0, 0.5, 1.0]);
        assert_eq!(read(b"P6 1 1 1000\n\x00\x00\x01\xf4\x03\xe8").unwrap().samples(), [0.0, 0.5, 1.0]);
    }

    #[test]
    fn faults_are_named() {
        let message = |file: &[u8]| read(file).unwrap_err().to_string();
        assert_eq!(
            message(b"P3 1 1 10 0 11 1"),
            "PPM file, byte 12: a sample is `11`, expected a whole number up to 10"
        );
        assert_eq!(message(b"P5 1 1 4\n\x05"), "PPM file, byte 9: a sample is 5, expected at most 4");
        assert_eq!(message(b"P1 2 1 12"), "PPM file, byte 8: a pixel is `2`, expected 0 or 1");
        assert!(message(b"P6 0 1 255\n").contains("the width is `0`"));
        assert!(message(b"P6 60000 60000 255\n").starts_with("picture size 60000 x 60000 refused"));
        assert!(message(b"P3 9000 9000 255\n1 2 3").contains("the pixels: 485999999 bytes"));
    }
}

//! Radiance pictures: three mantissas and a common exponent a pixel, run-length coded.
//!
//! Written here rather than by a crate because the exponent must come from the bits of the number: a logarithm of the
//! platform's would make the bytes differ between systems.

use crate::bytes::Bytes;
use crate::bytes::shown;
use crate::error::ImageError;
use crate::image::Channels;
use crate::image::Image;
use crate::limits::Limits;

/// Rows of other widths are not run-length coded.
const CODED_WIDTHS: std::ops::RangeInclusive<usize> = 8..=0x7fff;

/// The bytes of a Radiance picture; alpha is left out.
pub(crate) fn encode(image: &Image) -> Vec<u8> {
    let (width, height) = (image.width(), image.height());
    let header = format!("#?RADIANCE\nFORMAT=32-bit_rle_rgbe\n\n-Y {height} +X {width}\n");
    let mut file = header.into_bytes();
    let count = image.channels().count();
    for row in image.samples().chunks_exact(width * count) {
        let pixels: Vec<[u8; 4]> = row.chunks_exact(count).map(rgbe_of).collect();
        if CODED_WIDTHS.contains(&width) {
            file.extend([2, 2, (width >> 8) as u8, width as u8]);
            (0..4).for_each(|part| encode_part(&pixels, part, &mut file));
        } else {
            file.extend(pixels.iter().flatten());
        }
    }
    file
}

/// A colour as mantissas and exponent; negative values and NaN become 0, what is too large the greatest number.
fn rgbe_of(pixel: &[f32]) -> [u8; 4] {
    let mut rgb = [0.0_f64; 3];
    for (value, &sample) in rgb.iter_mut().zip(pixel) {
        // `max` turns NaN into 0, and the bound is just below what the greatest exponent holds.
        *value = f64::from(sample.max(0.0)).min(255.0 * power_of_two(255 - 136));
    }
    let [red, green, blue] = rgb;
    let greatest = red.max(green).max(blue);
    if greatest < 1e-32 {
        return [0; 4];
    }
    // The exponent e for which the greatest mantissa lies from 128 up to 256.
    let binary_exponent = ((greatest.to_bits() >> 52) & 0x7ff) as i32 - 1023;
    let mut exponent = binary_exponent + 129;
    // Rounding up to 256 needs the next exponent.
    if greatest * power_of_two(136 - exponent) >= 255.5 {
        exponent += 1;
    }
    // The conversion cuts off: adding a half makes it round.
    let unit = power_of_two(136 - exponent);
    let [red, green, blue] = rgb.map(|value| (value * unit + 0.5) as u8);
    [red, green, blue, exponent as u8]
}

/// The colour of mantissas and exponent.
fn colour_of([red, green, blue, exponent]: [u8; 4]) -> [f32; 3] {
    if exponent == 0 {
        return [0.0; 3];
    }
    let unit = power_of_two(i32::from(exponent) - 136);
    [red, green, blue].map(|mantissa| (f64::from(mantissa) * unit) as f32)
}

/// 2^exponent for exponents of normal doubles, exactly.
fn power_of_two(exponent: i32) -> f64 {
    f64::from_bits(((exponent + 1023) as u64) << 52)
}

/// One of the four parts of a row: runs of four and more equal bytes, and stretches of others.
fn encode_part(pixels: &[[u8; 4]], part: usize, file: &mut Vec<u8>) {
    let values: Vec<u8> = pixels.iter().filter_map(|pixel| pixel.get(part)).copied().collect();
    let mut literal: Vec<u8> = Vec::new();
    for run in values.chunk_by(|a, b| a == b) {
        if run.len() < 4 {
            literal.extend(run);
            continue;
        }
        flush_literal(&mut literal, file);
        for piece in run.chunks(127) {
            file.push(128 + piece.len() as u8);
            file.extend(piece.first());
        }
    }
    flush_literal(&mut literal, file);
}

fn flush_literal(literal: &mut Vec<u8>, file: &mut Vec<u8>) {
    for piece in literal.chunks(128) {
        file.push(piece.len() as u8);
        file.extend(piece);
    }
    literal.clear();
}

/// Reads a Radiance picture of the RGBE kind.
pub(crate) fn decode(file: &[u8], limits: &Limits) -> Result<Image, ImageError> {
    let mut bytes = Bytes::new(file, "Radiance HDR");
    if bytes.take(2, "the signature `#?`")? != b"#?" {
        return Err(bytes.invalid(0, "the signature", shown(file.get(..2).unwrap_or_default()), "`#?`"));
    }
    loop {
        let offset = bytes.position();
        let line = bytes.line("a header line")?.trim_ascii();
        if line.is_empty() {
            break;
        }
        if line.starts_with(b"FORMAT=") && line != b"FORMAT=32-bit_rle_rgbe" {
            return Err(bytes.invalid(offset, "the format", shown(line), "`FORMAT=32-bit_rle_rgbe`"));
        }
    }
    let size = resolution(&mut bytes)?;
    // Four bytes of the row being read beside the samples.
    let (width, height) = limits.check(size.width, size.height, 16)?;
    if bytes.remaining() < 4 * height {
        return Err(bytes.truncated("the pixels", 4 * height as u64));
    }
    // The rows are appended as they come: a short file cannot make the program take the memory it claims to need.
    let mut samples = Vec::new();
    let mut row = Vec::new();
    for _ in 0..height {
        decode_row(&mut bytes, width, &mut row)?;
        if size.right_to_left {
            row.reverse();
        }
        samples.extend(row.iter().flat_map(|&pixel| colour_of(pixel)));
    }
    if size.bottom_up {
        samples = samples.chunks_exact(width * 3).rev().flatten().copied().collect();
    }
    Image::from_samples(width, height, Channels::Rgb, samples)
}

/// The resolution line.
struct Resolution {
    width: u64,
    height: u64,
    bottom_up: bool,
    right_to_left: bool,
}

fn resolution(bytes: &mut Bytes<'_>) -> Result<Resolution, ImageError> {
    let offset = bytes.position();
    let line = bytes.line("the resolution line")?;
    let words: Vec<&[u8]> = line.split(u8::is_ascii_whitespace).filter(|word| !word.is_empty()).collect();
    let number = |word: &[u8]| std::str::from_utf8(word).ok().and_then(|text| text.parse::<u32>().ok());
    if let &[y @ (b"-Y" | b"+Y"), height, x @ (b"+X" | b"-X"), width] = words.as_slice()
        && let (Some(height), Some(width)) = (number(height), number(width))
    {
        let (bottom_up, right_to_left) = (y == b"+Y", x == b"-X");
        return Ok(Resolution { width: width.into(), height: height.into(), bottom_up, right_to_left });
    }
    Err(bytes.invalid(offset, "the resolution line", shown(line), "`-Y height +X width`"))
}

fn decode_row(bytes: &mut Bytes<'_>, width: usize, row: &mut Vec<[u8; 4]>) -> Result<(), ImageError> {
    row.clear();
    let offset = bytes.position();
    let first = bytes.rgbe("a row of pixels")?;
    match first {
        [2, 2, high @ 0..128, low] if CODED_WIDTHS.contains(&width) => {
            let coded = usize::from(high) << 8 | usize::from(low);
            if coded != width {
                return Err(bytes.invalid(offset, "the length of a row", coded, width));
            }
            decode_parts(bytes, width, row)
        }
        first => decode_old_row(bytes, first, width, row),
    }
}

/// Four run-length coded parts: red, green, blue, exponent.
fn decode_parts(bytes: &mut Bytes<'_>, width: usize, row: &mut Vec<[u8; 4]>) -> Result<(), ImageError> {
    row.resize(width, [0; 4]);
    for part in 0..4 {
        let mut slots = row.iter_mut().filter_map(|pixel| pixel.get_mut(part));
        let mut left = width;
        while left > 0 {
            let offset = bytes.position();
            let code = bytes.u8("a run")?;
            let run = if code > 128 { code - 128 } else { code };
            let length = usize::from(run);
            // A run of nothing would be no fault of the row, but no program writes it.
            if length == 0 || length > left {
                return Err(bytes.invalid(offset, "the length of a run", length, format!("1 to {left}")));
            }
            if code > 128 {
                let value = bytes.u8("the value of a run")?;
                slots.by_ref().take(length).for_each(|slot| *slot = value);
            } else {
                let values = bytes.take(length, "a run")?;
                // The values come first in the zip: the other way round it would lose a slot at the end.
                values.iter().zip(slots.by_ref()).for_each(|(&value, slot)| *slot = value);
            }
            left -= length;
        }
    }
    Ok(())
}

/// Plain pixels, where (1, 1, 1, n) repeats the pixel before it n times; repeats that follow each other count in
/// powers of 256.
fn decode_old_row(
    bytes: &mut Bytes<'_>,
    first: [u8; 4],
    width: usize,
    row: &mut Vec<[u8; 4]>,
) -> Result<(), ImageError> {
    let mut pixel = first;
    let mut shift = 0;
    loop {
        let offset = bytes.position() - 4;
        match (pixel, row.last().copied()) {
            ([1, 1, 1, repeats], Some(last)) => {
                let repeats = usize::from(repeats).checked_shl(shift).unwrap_or(usize::MAX);
                let left = width - row.len();
                if shift > 24 || repeats > left {
                    let expected = format!("at most {left}");
                    return Err(bytes.invalid(offset, "the length of a run", repeats, expected));
                }
                row.resize(row.len() + repeats, last);
                shift += 8;
            }
            ([1, 1, 1, _], None) => {
                return Err(bytes.invalid(offset, "the first pixel of a row", "a repeat", "a colour"));
            }
            (colour, _) => {
                row.push(colour);
                shift = 0;
            }
        }
        if row.len() >= width {
            return Ok(());
        }
        pixel = bytes.rgbe("a row of pixels")?;
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn colours_keep_seven_bits() {
        assert_eq!(rgbe_of(&[1.0, 0.5, 0.25]), [128, 64, 32, 129]);
        assert_eq!(rgbe_of(&[255.75, 0.0, 0.0]), [128, 0, 0, 137]);
        assert_eq!(rgbe_of(&[-1.0, f32::NAN, 0.0]), [0; 4]);
        assert_eq!(rgbe_of(&[f32::INFINITY, f32::MAX, 0.0]), [255, 255, 0, 255]);
        assert_eq!(colour_of([128, 64, 32, 129]), [1.0, 0.5, 0.25]);
        for step in 1..10_000 {
            let value = step as f32 * 0.013;
            let [back, ..] = colour_of(rgbe_of(&[value, 0.0, 0.0]));
            assert!((back - value).abs() <= value / 256.0, "{value} {back}");
        }
    }

    #[test]
    fn old_runs_and_orientations() {
        let mut file = b"#?RGBE\nEXPOSURE=1\n\n+Y 2 -X 3\n".to_vec();
        file.extend([128, 0, 0, 129, 1, 1, 1, 2]);
        file.extend([0, 128, 0, 129, 0, 0, 128, 129, 0, 0, 0, 0]);
        let image = decode(&file, &Limits::default()).unwrap();
        let expected = [0.0, 0.0, 0.0, 0.0, 0.0, 1.0, 0.0, 1.0, 0.0];
        assert_eq!(image.samples(), [&expected[..], &[1.0, 0.0, 0.0].repeat(3)].concat());
    }

    #[test]
    fn faults_are_named() {
        let message = |file: &[u8]| decode(file, &Limits::default()).unwrap_err().to_string();
        assert!(
            message(b"#?RADIANCE\n\n-Y 65535 +X 65535\n").starts_with("picture size 65535 x 65535 refused")
        );
        assert!(
            message(b"#?RADIANCE\nFORMAT=32-bit_rle_xyze\n\n").contains("expected `FORMAT=32-bit_rle_rgbe`")
        );
        assert!(message(b"#?RADIANCE\n\n+X 2 -Y 2\n").contains("expected `-Y height +X width`"));
        assert_eq!(
            message(b"#?RADIANCE\n\n-Y 1 +X 3\n\x01\x02\x03\x04\x01\x01\x01\x09"),
            "Radiance HDR file, byte 26: the length of a run is 9, expected at most 2"
        );
        assert_eq!(
            message(b"#?RADIANCE\n\n-Y 1 +X 8\n\x02\x02\x00\x08\x89\x00"),
            "Radiance HDR file, byte 26: the length of a run is 9, expected 1 to 8"
        );
    }
}

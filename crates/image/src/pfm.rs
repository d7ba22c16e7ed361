//! Portable float maps: a short text header, then 32-bit floats, the lowest row first.

use crate::bytes::Bytes;
use crate::bytes::shown;
use crate::error::ImageError;
use crate::image::Channels;
use crate::image::Image;
use crate::limits::Limits;

/// The bytes of a colour float map, little endian; alpha is left out.
pub(crate) fn encode(image: &Image) -> Vec<u8> {
    let mut file = format!("PF\n{} {}\n-1.0\n", image.width(), image.height()).into_bytes();
    let count = image.channels().count();
    let header = file.len();
    file.resize(header + image.width() * image.height() * 12, 0);
    let stored = file.get_mut(header..).unwrap_or_default().as_chunks_mut::<12>().0;
    let rows = image.samples().chunks_exact(image.width() * count).rev();
    for (stored, pixel) in stored.iter_mut().zip(rows.flat_map(|row| row.chunks_exact(count))) {
        let stored = stored.as_chunks_mut::<4>().0.iter_mut();
        stored.zip(pixel).for_each(|(stored, sample)| *stored = sample.to_le_bytes());
    }
    file
}

/// Reads a colour (`PF`) or grey (`Pf`) float map of either byte order.
pub(crate) fn decode(file: &[u8], limits: &Limits) -> Result<Image, ImageError> {
    let mut bytes = Bytes::new(file, "PFM");
    let stored = match bytes.word("the signature `PF` or `Pf`")? {
        b"PF" => 3,
        b"Pf" => 1,
        other => return Err(bytes.invalid(0, "the signature", shown(other), "`PF` or `Pf`")),
    };
    let width = bytes.decimal("the width", u32::MAX)?;
    let height = bytes.decimal("the height", u32::MAX)?;
    let little_endian = is_little_endian(&mut bytes)?;
    bytes.take(1, "the line feed after the header")?;
    let (width, height) = limits.check(u64::from(width), u64::from(height), 12)?;
    let row_bytes = width * stored * 4;
    let needed = row_bytes as u64 * height as u64;
    let pixels = match usize::try_from(needed) {
        Ok(needed) => bytes.take(needed, "the pixels")?,
        Err(_) => return Err(bytes.truncated("the pixels", needed)),
    };
    let mut samples = Vec::with_capacity(width * height * 3);
    for row in pixels.chunks_exact(row_bytes).rev() {
        let values = row.as_chunks::<4>().0.iter();
        let values =
            values.map(|&c| if little_endian { f32::from_le_bytes(c) } else { f32::from_be_bytes(c) });
        match stored {
            1 => samples.extend(values.flat_map(|grey| [grey; 3])),
            _ => samples.extend(values),
        }
    }
    Image::from_samples(width, height, Channels::Rgb, samples)
}

/// The sign of the scale tells the byte order; its size is a unit that programs leave alone.
fn is_little_endian(bytes: &mut Bytes<'_>) -> Result<bool, ImageError> {
    let word = bytes.word("the scale")?;
    let scale = std::str::from_utf8(word).ok().and_then(|text| text.parse::<f32>().ok());
    match scale {
        Some(scale) if scale.is_finite() && scale != 0.0 => Ok(scale < 0.0),
        Some(_) | None => {
            let expected = "a number below 0 (little endian) or above 0 (big endian)";
            Err(bytes.invalid(bytes.position() - word.len(), "the scale", shown(word), expected))
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn both_byte_orders_and_grey() {
        let mut file = b"Pf\n# grey\n1 2\n1.0\n".to_vec();
        [0.25_f32, -3.0].iter().for_each(|value| file.extend(value.to_be_bytes()));
        let image = decode(&file, &Limits::default()).unwrap();
        assert_eq!(image.samples(), [-3.0, -3.0, -3.0, 0.25, 0.25, 0.25]);
    }

    #[test]
    fn hostile_sizes_are_refused() {
        let huge = decode(b"PF\n65535 65535\n-1.0\n", &Limits::default());
        assert!(matches!(huge, Err(ImageError::Size { .. })));
        let short = decode(b"PF\n9999 9999\n-1.0\n1234", &Limits::default()).unwrap_err().to_string();
        assert_eq!(
            short,
            "PFM file ends at byte 22, too early for the pixels: 1199760012 bytes from byte 18 on"
        );
        let scale = decode(b"PF\n9 9\nnan\n", &Limits::default()).unwrap_err().to_string();
        assert!(
            scale.starts_with("PFM file, byte 7: the scale is `nan`, expected a number below 0"),
            "{scale}"
        );
    }
}

//! BMP as the course's `bmp.c` writes it: 24 bits a pixel, uncompressed, the lowest row first.

use crate::error::ImageError;
use crate::image::Image;

const HEADER_BYTES: u32 = 14 + 40;
/// 72 dots an inch.
const PIXELS_PER_METRE: u32 = 2834;

/// The bytes of a BMP file; alpha is left out.
pub(crate) fn encode(image: &Image, srgb: bool) -> Result<Vec<u8>, ImageError> {
    let row_bytes = 3 * image.width();
    let padded_bytes = row_bytes.next_multiple_of(4);
    let refused = || ImageError::Encoder {
        format: "BMP",
        width: image.width(),
        height: image.height(),
        message: "its file would pass 4 GiB, which the format's 32-bit sizes cannot hold".to_string(),
    };
    let width = i32::try_from(image.width()).map_err(|_| refused())?;
    let height = i32::try_from(image.height()).map_err(|_| refused())?;
    let pixel_bytes = padded_bytes.checked_mul(image.height()).and_then(|bytes| u32::try_from(bytes).ok());
    let pixel_bytes = pixel_bytes.ok_or_else(refused)?;
    let file_bytes = pixel_bytes.checked_add(HEADER_BYTES).ok_or_else(refused)?;

    let mut file = Vec::with_capacity(file_bytes as usize);
    file.extend(b"BM");
    [file_bytes, 0, HEADER_BYTES].iter().for_each(|field| file.extend(field.to_le_bytes()));
    file.extend(40_u32.to_le_bytes());
    [width, height].iter().for_each(|field| file.extend(field.to_le_bytes()));
    // One plane of 24 bits.
    [1_u16, 24].iter().for_each(|field| file.extend(field.to_le_bytes()));
    [0, pixel_bytes, PIXELS_PER_METRE, PIXELS_PER_METRE, 0, 0]
        .iter()
        .for_each(|field| file.extend(field.to_le_bytes()));

    let rgb = image.to_rgb8(srgb);
    for row in rgb.chunks_exact(row_bytes).rev() {
        file.extend(row.as_chunks::<3>().0.iter().flat_map(|&[red, green, blue]| [blue, green, red]));
        file.resize(file.len() + padded_bytes - row_bytes, 0);
    }
    Ok(file)
}

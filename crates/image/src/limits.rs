//! How large a picture may be: checked before memory is taken.

use crate::error::ImageError;

/// Limits on what a picture file may make the program do.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Limits {
    /// Most pixels of a picture.
    pub max_pixels: u64,
    /// Most bytes of memory for decoding a picture, its samples and the decoder's buffers together.
    pub max_bytes: u64,
}

impl Default for Limits {
    /// 2^28 pixels (16384 x 16384) and 4 GiB.
    fn default() -> Self {
        Limits { max_pixels: 1 << 28, max_bytes: 4 << 30 }
    }
}

impl Limits {
    /// Checks a size claimed by a file; `bytes_per_pixel` is what decoding takes in memory, buffers included.
    ///
    /// # Errors
    /// [`ImageError::Size`] for zero or too many pixels, [`ImageError::Memory`] for too many bytes.
    pub fn check(&self, width: u64, height: u64, bytes_per_pixel: u64) -> Result<(usize, usize), ImageError> {
        let refused = ImageError::Size { width, height, max_pixels: self.max_pixels };
        let pixels = match width.checked_mul(height) {
            Some(pixels) if pixels >= 1 && pixels <= self.max_pixels => pixels,
            Some(_) | None => return Err(refused),
        };
        let needed = pixels.saturating_mul(bytes_per_pixel);
        // The sample count must fit memory addresses too, which matters where usize has 32 bits.
        if needed > self.max_bytes || usize::try_from(needed).is_err() {
            return Err(ImageError::Memory { width, height, needed, max_bytes: self.max_bytes });
        }
        match (usize::try_from(width), usize::try_from(height)) {
            (Ok(width), Ok(height)) => Ok((width, height)),
            (Ok(_) | Err(_), _) => Err(refused),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn sizes_are_checked_without_overflow() {
        let limits = Limits::default();
        assert_eq!(limits.check(3, 4, 12), Ok((3, 4)));
        assert_eq!(limits.check(1 << 14, 1 << 14, 16), Ok((1 << 14, 1 << 14)));
        assert!(matches!(limits.check(1 << 14, (1 << 14) + 1, 12), Err(ImageError::Size { .. })));
        assert!(matches!(limits.check(0, 4, 12), Err(ImageError::Size { .. })));
        assert!(matches!(limits.check(u64::MAX, u64::MAX, 12), Err(ImageError::Size { .. })));
        assert!(matches!(limits.check(1 << 14, 1 << 14, 17), Err(ImageError::Memory { .. })));
    }
}

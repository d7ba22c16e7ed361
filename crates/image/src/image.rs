//! A picture in memory.

use crate::error::ImageError;
use crate::limits::Limits;
use crate::quantise::to_srgb_u8;
use crate::quantise::to_u8;

/// Which channels a picture has.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
pub enum Channels {
    /// Red, green, blue.
    Rgb,
    /// Red, green, blue, alpha (not premultiplied).
    Rgba,
}

impl Channels {
    /// Samples a pixel: 3 or 4.
    pub fn count(self) -> usize {
        match self {
            Channels::Rgb => 3,
            Channels::Rgba => 4,
        }
    }
}

/// A picture: f32 samples, pixel by pixel, upper row first, display values, unclamped.
#[derive(Debug, Clone, PartialEq)]
pub struct Image {
    width: usize,
    height: usize,
    channels: Channels,
    samples: Vec<f32>,
}

impl Image {
    /// A black picture (and, with an alpha channel, a transparent one).
    ///
    /// # Errors
    /// [`ImageError::Size`] or [`ImageError::Memory`] for a size of zero or one over the default [`Limits`].
    pub fn new(width: usize, height: usize, channels: Channels) -> Result<Image, ImageError> {
        Image::new_within(width, height, channels, &Limits::default())
    }

    /// The same within other limits.
    ///
    /// # Errors
    /// [`ImageError::Size`] or [`ImageError::Memory`] for a size of zero or one over the limits.
    pub fn new_within(
        width: usize,
        height: usize,
        channels: Channels,
        limits: &Limits,
    ) -> Result<Image, ImageError> {
        let bytes_per_pixel = 4 * channels.count() as u64;
        let (width, height) = limits.check(width as u64, height as u64, bytes_per_pixel)?;
        let samples = zeroed(width, height, channels)?;
        Ok(Image { width, height, channels, samples })
    }

    /// A picture of given samples, pixel by pixel, upper row first.
    ///
    /// # Errors
    /// [`ImageError::Size`] for a size of zero, [`ImageError::SampleCount`] for a wrong number of samples.
    pub fn from_samples(
        width: usize,
        height: usize,
        channels: Channels,
        samples: Vec<f32>,
    ) -> Result<Image, ImageError> {
        if width == 0 || height == 0 {
            let max_pixels = Limits::default().max_pixels;
            return Err(ImageError::Size { width: width as u64, height: height as u64, max_pixels });
        }
        let expected = width as u128 * height as u128 * channels.count() as u128;
        if expected != samples.len() as u128 {
            let expected = u64::try_from(expected).unwrap_or(u64::MAX);
            return Err(ImageError::SampleCount { expected, found: samples.len() as u64 });
        }
        Ok(Image { width, height, channels, samples })
    }

    /// Columns.
    pub fn width(&self) -> usize {
        self.width
    }

    /// Rows.
    pub fn height(&self) -> usize {
        self.height
    }

    /// Which channels there are.
    pub fn channels(&self) -> Channels {
        self.channels
    }

    /// All samples, pixel by pixel, upper row first.
    pub fn samples(&self) -> &[f32] {
        &self.samples
    }

    /// All samples for writing, pixel by pixel, upper row first.
    pub fn samples_mut(&mut self) -> &mut [f32] {
        &mut self.samples
    }

    /// Gives the samples away.
    pub fn into_samples(self) -> Vec<f32> {
        self.samples
    }

    /// The pixel in column `x` from the left and row `y` from above; alpha is 1 in a picture without it.
    pub fn pixel(&self, x: usize, y: usize) -> Option<[f32; 4]> {
        let start = self.start_of(x, y)?;
        match (self.channels, self.samples.get(start..start + self.channels.count())?) {
            (Channels::Rgb, &[r, g, b]) => Some([r, g, b, 1.0]),
            (Channels::Rgba, &[r, g, b, a]) => Some([r, g, b, a]),
            (Channels::Rgb | Channels::Rgba, _) => None,
        }
    }

    /// Sets a pixel, the alpha only where the picture has it; false if there is no such pixel.
    pub fn set_pixel(&mut self, x: usize, y: usize, rgba: [f32; 4]) -> bool {
        let count = self.channels.count();
        let pixel = self.start_of(x, y).and_then(|start| self.samples.get_mut(start..start + count));
        match pixel {
            Some(pixel) => {
                pixel.iter_mut().zip(rgba).for_each(|(sample, value)| *sample = value);
                true
            }
            None => false,
        }
    }

    fn start_of(&self, x: usize, y: usize) -> Option<usize> {
        (x < self.width && y < self.height).then(|| (y * self.width + x) * self.channels.count())
    }

    /// The part of `width` x `height` pixels whose upper left pixel is (`x`, `y`); None if it is empty or reaches
    /// outside.
    pub fn crop(&self, x: usize, y: usize, width: usize, height: usize) -> Option<Image> {
        let fits = |start: usize, size: usize, all: usize| {
            size > 0 && start.checked_add(size).is_some_and(|end| end <= all)
        };
        if !fits(x, width, self.width) || !fits(y, height, self.height) {
            return None;
        }
        let count = self.channels.count();
        let rows = self.samples.chunks_exact(self.width * count).skip(y).take(height);
        let samples =
            rows.filter_map(|row| row.get(x * count..(x + width) * count)).flatten().copied().collect();
        Some(Image { width, height, channels: self.channels, samples })
    }

    /// Red, green and blue as bytes, round(255·clamp(c, 0, 1)), pixel by pixel, upper row first; with `srgb` the sRGB
    /// curve is applied first. Alpha is left out.
    pub fn to_rgb8(&self, srgb: bool) -> Vec<u8> {
        let to_byte = if srgb { to_srgb_u8 } else { to_u8 };
        match self.channels {
            // Two loops, so that the usual one can be vectorised.
            Channels::Rgb if !srgb => self.samples.iter().map(|&sample| to_u8(sample)).collect(),
            Channels::Rgb => self.samples.iter().map(|&sample| to_byte(sample)).collect(),
            Channels::Rgba => self
                .samples
                .chunks_exact(4)
                .flat_map(|pixel| pixel.iter().take(3))
                .map(|&sample| to_byte(sample))
                .collect(),
        }
    }
}

/// A pixel's samples as formats have them whose colours are multiplied by alpha.
pub(crate) fn premultiplied(pixel: &[f32]) -> [f32; 4] {
    match *pixel {
        // Where alpha is 1 the colour stays, even an infinite one.
        [r, g, b, a] if a != 1.0 => [r * a, g * a, b * a, a],
        [r, g, b, ..] => [r, g, b, 1.0],
        _ => [0.0; 4],
    }
}

/// The other way; a colour without alpha, which only glows, stays as it is.
#[cfg(feature = "formats")]
pub(crate) fn straight([r, g, b, a]: [f32; 4]) -> [f32; 4] {
    if a > 0.0 && a != 1.0 { [r / a, g / a, b / a, a] } else { [r, g, b, a] }
}

/// Zeroes for a picture whose size has been checked; an error instead of an abort where memory has run out.
pub(crate) fn zeroed(width: usize, height: usize, channels: Channels) -> Result<Vec<f32>, ImageError> {
    let count = width * height * channels.count();
    let mut samples = Vec::new();
    if samples.try_reserve_exact(count).is_err() {
        let (width, height) = (width as u64, height as u64);
        return Err(ImageError::Memory { width, height, needed: 4 * count as u64, max_bytes: 0 });
    }
    samples.resize(count, 0.0);
    Ok(samples)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn sizes_are_refused_before_memory_is_taken() {
        for (width, height) in [(0, 5), (5, 0), (usize::MAX, 2), (1 << 20, 1 << 20), (usize::MAX, usize::MAX)]
        {
            assert!(matches!(Image::new(width, height, Channels::Rgb), Err(ImageError::Size { .. })));
        }
        let wrong = Image::from_samples(2, 2, Channels::Rgb, vec![0.0; 11]);
        assert_eq!(wrong, Err(ImageError::SampleCount { expected: 12, found: 11 }));
        assert!(Image::from_samples(usize::MAX, usize::MAX, Channels::Rgba, vec![]).is_err());
        assert!(Image::from_samples(0, 0, Channels::Rgba, vec![]).is_err());
    }

    #[test]
    fn pixels_and_crops() {
        let mut image = Image::new(3, 2, Channels::Rgb).unwrap();
        assert!(image.set_pixel(2, 1, [1.0, 2.0, 3.0, 0.5]));
        assert!(!image.set_pixel(3, 1, [1.0; 4]));
        assert_eq!(image.pixel(2, 1), Some([1.0, 2.0, 3.0, 1.0]));
        assert_eq!(image.pixel(0, 2), None);
        let part = image.crop(1, 1, 2, 1).unwrap();
        assert_eq!(part.samples(), [0.0, 0.0, 0.0, 1.0, 2.0, 3.0]);
        assert_eq!(image.crop(2, 0, 2, 1), None);
        assert_eq!(image.crop(usize::MAX, 0, 2, 1), None);
        assert_eq!(image.crop(0, 0, 0, 1), None);
    }

    #[test]
    fn bytes_leave_alpha_out() {
        let image = Image::from_samples(1, 1, Channels::Rgba, vec![0.5, 2.0, -1.0, 0.3]).unwrap();
        assert_eq!(image.to_rgb8(false), [128, 255, 0]);
        assert_eq!(image.to_rgb8(true), [188, 255, 0]);
    }
}

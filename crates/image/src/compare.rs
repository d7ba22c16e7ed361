//! How far two pictures are apart: differences of samples, of blocks, and as the eye sees them.

mod filter;

mod flip_color;

pub mod flip;

pub mod ssim;

pub mod histogram;

pub mod profile;

use crate::error::ImageError;
use crate::image::Channels;
use crate::image::Image;
use crate::quantise::to_u8;

/// Figures on two pictures of the same size.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Comparison {
    /// Mean of the absolute differences over all channels of all pixels.
    pub mean: f64,
    /// Greatest absolute difference.
    pub max: f64,
    /// Column and row of the first pixel that differs most.
    pub max_at: (usize, usize),
    /// Root of the mean squared difference.
    pub rmse: f64,
    /// Peak signal-to-noise ratio in decibels for a peak of 1; infinite for equal pictures.
    pub psnr: f64,
    /// Pixels of which some channel differs by more than the tolerance.
    pub pixels_over: u64,
    /// All pixels.
    pub pixels: u64,
}

/// Compares red, green and blue, and alpha where at least one picture has it (the other's then is 1). Values that are
/// not finite are equal to themselves and infinitely far from everything else.
///
/// # Errors
/// [`ImageError::SizesDiffer`] if the sizes differ.
///
/// ```
/// use dotray_image::{Channels, Image, compare::compare};
///
/// let black = Image::new(2, 1, Channels::Rgb)?;
/// let mut other = black.clone();
/// other.set_pixel(1, 0, [0.5, 0.0, 0.0, 1.0]);
/// let figures = compare(&black, &other, 0.1)?;
/// assert_eq!((figures.max, figures.max_at, figures.pixels_over), (0.5, (1, 0), 1));
/// # Ok::<(), dotray_image::ImageError>(())
/// ```
pub fn compare(a: &Image, b: &Image, tolerance: f64) -> Result<Comparison, ImageError> {
    if let Some(error) = sizes_differ(a, b) {
        return Err(error);
    }
    let has_alpha = a.channels() == Channels::Rgba || b.channels() == Channels::Rgba;
    let channels = if has_alpha { 4 } else { 3 };
    let (mut sum, mut squares, mut max, mut max_at, mut pixels_over) = (0.0, 0.0, 0.0, (0, 0), 0);
    for (place, (pixel_a, pixel_b)) in rgba_pixels(a).zip(rgba_pixels(b)).enumerate() {
        let mut greatest = 0.0_f64;
        for (value_a, value_b) in pixel_a.into_iter().zip(pixel_b).take(channels) {
            let difference = distance(value_a, value_b);
            sum += difference;
            squares += difference * difference;
            greatest = greatest.max(difference);
        }
        if greatest > max {
            (max, max_at) = (greatest, (place % a.width(), place / a.width()));
        }
        pixels_over += u64::from(greatest > tolerance);
    }
    let pixels = a.width() as u64 * a.height() as u64;
    let samples = (pixels * channels as u64) as f64;
    let mean_square: f64 = squares / samples;
    Ok(Comparison {
        mean: sum / samples,
        max,
        max_at,
        rmse: mean_square.sqrt(),
        psnr: if mean_square == 0.0 { f64::INFINITY } else { -10.0 * libm::log10(mean_square) },
        pixels_over,
        pixels,
    })
}

fn sizes_differ(a: &Image, b: &Image) -> Option<ImageError> {
    ((a.width(), a.height()) != (b.width(), b.height())).then_some(ImageError::SizesDiffer {
        expected_width: a.width(),
        expected_height: a.height(),
        width: b.width(),
        height: b.height(),
    })
}

/// A sample as a screen shows it: between 0 and 1, and black where it is no number.
fn shown(sample: f32) -> f64 {
    let sample = f64::from(sample);
    if sample.is_nan() { 0.0 } else { sample.clamp(0.0, 1.0) }
}

/// The differences of red, green and blue, pixel by pixel.
fn channel_distances(a: &Image, b: &Image) -> impl Iterator<Item = [f64; 3]> {
    let pairs = rgba_pixels(a).zip(rgba_pixels(b));
    pairs.map(|([r, g, b, _], [r2, g2, b2, _])| [distance(r, r2), distance(g, g2), distance(b, b2)])
}

fn rgba_pixels(image: &Image) -> impl Iterator<Item = [f32; 4]> {
    image.samples().chunks_exact(image.channels().count()).map(|pixel| {
        let mut rgba = [1.0; 4];
        rgba.iter_mut().zip(pixel).for_each(|(value, &sample)| *value = sample);
        rgba
    })
}

fn distance(a: f32, b: f32) -> f64 {
    if a == b || (a.is_nan() && b.is_nan()) {
        return 0.0;
    }
    let difference = (f64::from(a) - f64::from(b)).abs();
    if difference.is_nan() { f64::INFINITY } else { difference }
}

/// An 8x8 block and how far it is off.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Block {
    /// The mean absolute difference of its pixels in the channel where that is greatest.
    pub difference: f64,
    /// Column and row of its upper left pixel.
    pub at: (usize, usize),
}

/// The 8x8 block that differs most in red, green or blue. Small pictures are one block; the last blocks of a row and
/// of a column are pushed inwards, so that all are of full size.
///
/// # Errors
/// [`ImageError::SizesDiffer`] if the sizes differ.
pub fn largest_block(a: &Image, b: &Image) -> Result<Block, ImageError> {
    if let Some(error) = sizes_differ(a, b) {
        return Err(error);
    }
    let pixels = channel_distances(a, b).collect();
    let differences = Differences { width: a.width(), height: a.height(), pixels };
    let blocks: Vec<_> =
        differences.blocks(|d| d).into_iter().map(|(mean, at)| (greatest_channel(mean), at)).collect();
    let (difference, at) = worst_block(&blocks);
    Ok(Block { difference, at })
}

/// What a picture must fulfil to count as equal to a reference.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Class {
    /// At least 99.5 % of the pixels differ by at most 2/255 in every channel, the mean absolute difference is at most
    /// 0.5/255, and no 8x8 block has, in any channel, a mean absolute difference above 0.08.
    Exact,
    /// For soft shadows, on the means of 8x8 blocks: at least 98 % of them within 0.025 in every channel, none further
    /// off than 0.07, and the mean of their differences at most 2/255.
    Statistical,
}

/// Figures and verdict of a comparison with a reference; figures of NaN were not taken.
#[derive(Debug, Clone, PartialEq)]
pub struct Conformance {
    /// Share of the pixels that differ by at most 2/255 in every channel.
    pub share: f64,
    /// Mean absolute difference.
    pub mean: f64,
    /// Greatest absolute difference.
    pub worst: f64,
    /// The figure of the worst 8x8 block.
    pub block: f64,
    /// Column and row of that block's upper left pixel.
    pub block_at: (usize, usize),
    /// [`Class::Statistical`]: share of the blocks within 0.025.
    pub block_share: f64,
    /// [`Class::Statistical`]: mean of the blocks' differences.
    pub block_mean: f64,
    /// One sentence for each thing that failed; empty if the picture passed.
    pub failures: Vec<String>,
}

impl Conformance {
    /// True if nothing failed.
    pub fn passed(&self) -> bool {
        self.failures.is_empty()
    }

    fn refused(reason: String) -> Conformance {
        let nan = f64::NAN;
        Conformance {
            share: nan,
            mean: nan,
            worst: nan,
            block: nan,
            block_at: (0, 0),
            block_share: nan,
            block_mean: nan,
            failures: vec![reason],
        }
    }
}

/// Compares red, green and blue of a picture with a reference. `clamp` brings both to 0…1 first: for a picture that
/// was stored in a format of whole numbers. Another size or a value that is not finite fails.
pub fn conformance(expected: &Image, actual: &Image, class: Class, clamp: bool) -> Conformance {
    if sizes_differ(expected, actual).is_some() {
        return Conformance::refused(format!(
            "size {}x{}, wanted {}x{}",
            actual.width(),
            actual.height(),
            expected.width(),
            expected.height()
        ));
    }
    let not_finite = rgba_pixels(actual).filter(|pixel| pixel.iter().take(3).any(|c| !c.is_finite())).count();
    if not_finite > 0 {
        return Conformance::refused(format!("{not_finite} pixels are not finite"));
    }
    let differences = Differences::new(expected, actual, clamp);
    let mut figures = differences.pixel_figures();
    match class {
        Class::Exact => exact(&differences, &mut figures),
        Class::Statistical => statistical(&differences, &mut figures),
    }
    figures
}

/// Expected minus actual, pixel by pixel.
struct Differences {
    width: usize,
    height: usize,
    pixels: Vec<[f64; 3]>,
}

impl Differences {
    fn new(expected: &Image, actual: &Image, clamp: bool) -> Differences {
        let value = |sample: f32| {
            let sample = f64::from(sample);
            if clamp { sample.clamp(0.0, 1.0) } else { sample }
        };
        let pixels = rgba_pixels(expected)
            .zip(rgba_pixels(actual))
            .map(|([r, g, b, _], [r2, g2, b2, _])| {
                [value(r) - value(r2), value(g) - value(g2), value(b) - value(b2)]
            })
            .collect();
        Differences { width: expected.width(), height: expected.height(), pixels }
    }

    fn pixel_figures(&self) -> Conformance {
        let (mut agreeing, mut sum, mut worst) = (0_u64, 0.0, 0.0_f64);
        for pixel in &self.pixels {
            let [r, g, b] = pixel.map(f64::abs);
            let greatest = r.max(g).max(b);
            agreeing += u64::from(greatest <= 2.0 / 255.0 + 1e-9);
            worst = worst.max(greatest);
            sum += r + g + b;
        }
        let count = self.pixels.len() as f64;
        let mut figures = Conformance::refused(String::new());
        figures.failures.clear();
        (figures.share, figures.mean, figures.worst) = (agreeing as f64 / count, sum / (3.0 * count), worst);
        figures
    }

    /// For every 8x8 block, the mean over its pixels of `of` applied to each difference, and its place.
    fn blocks(&self, of: impl Fn(f64) -> f64) -> Vec<([f64; 3], (usize, usize))> {
        let mut blocks = Vec::new();
        for y in block_starts(self.height) {
            for x in block_starts(self.width) {
                let rows = self.pixels.chunks_exact(self.width).skip(y).take(8);
                let (mut sums, mut count) = ([0.0; 3], 0.0);
                for pixel in rows.flat_map(|row| row.iter().skip(x).take(8)) {
                    sums.iter_mut().zip(pixel).for_each(|(sum, &difference)| *sum += of(difference));
                    count += 1.0;
                }
                blocks.push((sums.map(|sum| sum / count), (x, y)));
            }
        }
        blocks
    }
}

/// Every eighth pixel; the last block is pushed inwards, so that all are of full size (or the picture is smaller).
fn block_starts(size: usize) -> Vec<usize> {
    let mut starts: Vec<usize> = (0..size.saturating_sub(7).max(1)).step_by(8).collect();
    let last = size.saturating_sub(8);
    if starts.last() != Some(&last) {
        starts.push(last);
    }
    starts
}

/// The greatest figure of a block, and among equal ones the place with the greatest column, then row.
fn worst_block(blocks: &[(f64, (usize, usize))]) -> (f64, (usize, usize)) {
    let order =
        |a: &&(f64, (usize, usize)), b: &&(f64, (usize, usize))| a.0.total_cmp(&b.0).then(a.1.cmp(&b.1));
    blocks.iter().max_by(order).copied().unwrap_or((0.0, (0, 0)))
}

fn greatest_channel([r, g, b]: [f64; 3]) -> f64 {
    r.abs().max(g.abs()).max(b.abs())
}

fn exact(differences: &Differences, figures: &mut Conformance) {
    let blocks: Vec<_> =
        differences.blocks(f64::abs).into_iter().map(|(mean, at)| (greatest_channel(mean), at)).collect();
    (figures.block, figures.block_at) = worst_block(&blocks);
    if figures.share < 0.995 {
        let share = 100.0 * figures.share;
        figures.failures.push(format!("{share:.2} % of the pixels agree, 99.5 wanted"));
    }
    if figures.mean > 0.5 / 255.0 {
        let mean = 255.0 * figures.mean;
        figures.failures.push(format!("mean difference {mean:.3}/255, at most 0.5 allowed"));
    }
    if figures.block > 0.08 {
        let (at, block) = (figures.block_at, figures.block);
        figures.failures.push(format!("block at {at:?} differs by {block:.3}, at most 0.08 allowed"));
    }
}

fn statistical(differences: &Differences, figures: &mut Conformance) {
    let blocks: Vec<_> =
        differences.blocks(|d| d).into_iter().map(|(mean, at)| (greatest_channel(mean), at)).collect();
    (figures.block, figures.block_at) = worst_block(&blocks);
    let count = blocks.len() as f64;
    figures.block_share = blocks.iter().filter(|(figure, _)| *figure <= 0.025).count() as f64 / count;
    figures.block_mean = blocks.iter().map(|(figure, _)| figure).sum::<f64>() / count;
    if figures.block_share < 0.98 {
        let share = 100.0 * figures.block_share;
        figures.failures.push(format!("{share:.1} % of the blocks agree, 98 wanted"));
    }
    if figures.block > 0.07 {
        let (at, block) = (figures.block_at, figures.block);
        figures.failures.push(format!("block at {at:?} is off by {block:.3}, at most 0.07 allowed"));
    }
    if figures.block_mean > 2.0 / 255.0 {
        let mean = 255.0 * figures.block_mean;
        figures.failures.push(format!("block means differ by {mean:.2}/255 on average, at most 2 allowed"));
    }
}

/// How much the middle part of a difference picture exaggerates.
const AMPLIFICATION: f64 = 8.0;

/// Three parts side by side: expected, eight times the absolute difference, actual. Where only one of the pictures has
/// a pixel, the difference is white.
///
/// # Errors
/// [`ImageError::Size`] or [`ImageError::Memory`] if three parts are too large.
pub fn difference_picture(expected: &Image, actual: &Image) -> Result<Image, ImageError> {
    let width = expected.width().max(actual.width());
    let height = expected.height().max(actual.height());
    let mut picture = Image::new(width.saturating_mul(3), height, Channels::Rgb)?;
    let shown = |pixel: [f32; 4]| pixel.map(|sample| f32::from(to_u8(sample)) / 255.0);
    for y in 0..height {
        for x in 0..width {
            let (left, right) = (expected.pixel(x, y), actual.pixel(x, y));
            let middle = match (left, right) {
                (Some(left), Some(right)) => difference_of(left, right),
                (None, None) => [0.0; 4],
                (Some(_), None) | (None, Some(_)) => [1.0; 4],
            };
            picture.set_pixel(x, y, left.map_or([0.0; 4], shown));
            picture.set_pixel(width + x, y, middle);
            picture.set_pixel(2 * width + x, y, right.map_or([0.0; 4], shown));
        }
    }
    Ok(picture)
}

fn difference_of(left: [f32; 4], right: [f32; 4]) -> [f32; 4] {
    let mut amplified = [1.0; 4];
    let pairs = left.into_iter().zip(right).take(3);
    amplified.iter_mut().zip(pairs).for_each(|(value, (left, right))| {
        *value = (AMPLIFICATION * distance(left, right)).min(1.0) as f32;
    });
    amplified
}

#[cfg(test)]
pub(crate) mod tests {
    use super::*;

    /// Two pictures of smooth colours and of a shifted disc.
    pub(crate) fn gradient(width: usize, height: usize) -> (Image, Image) {
        let picture = |shift: f32| {
            let pixels = (0..width * height).flat_map(|place| {
                let (x, y) = ((place % width) as f32, (place / width) as f32);
                let (cx, cy) = (x - 0.5 * width as f32 - shift, y - 0.5 * height as f32);
                let inside = cx * cx + cy * cy < 64.0;
                let step = |value: f32| (255.0 * value).round() / 255.0;
                if inside {
                    [0.9, 0.2, 0.1].map(step)
                } else {
                    [x / width as f32, 0.4, y / height as f32].map(step)
                }
            });
            Image::from_samples(width, height, Channels::Rgb, pixels.collect()).unwrap()
        };
        (picture(0.0), picture(3.0))
    }

    fn grey(width: usize, height: usize, value: f32) -> Image {
        Image::from_samples(width, height, Channels::Rgb, vec![value; width * height * 3]).unwrap()
    }

    #[test]
    fn the_last_block_is_pushed_inwards() {
        assert_eq!(block_starts(1), [0]);
        assert_eq!(block_starts(8), [0]);
        assert_eq!(block_starts(9), [0, 1]);
        assert_eq!(block_starts(15), [0, 7]);
        assert_eq!(block_starts(16), [0, 8]);
        assert_eq!(block_starts(20), [0, 8, 12]);
    }

    #[test]
    fn figures_of_a_comparison() {
        let (a, mut b) = (grey(2, 2, 0.5), grey(2, 2, 0.5));
        let equal = compare(&a, &b, 0.0).unwrap();
        assert_eq!((equal.mean, equal.max, equal.rmse, equal.psnr), (0.0, 0.0, 0.0, f64::INFINITY));
        b.set_pixel(0, 1, [0.5, 0.75, 0.0, 1.0]);
        let figures = compare(&a, &b, 0.3).unwrap();
        assert_eq!((figures.max, figures.max_at, figures.pixels_over, figures.pixels), (0.5, (0, 1), 1, 4));
        assert_eq!(figures.mean, 0.0625);
        assert_eq!(figures.rmse, (0.3125_f64 / 12.0).sqrt());
        assert!((figures.psnr - 15.843_312_243_675_307).abs() < 1e-12, "{}", figures.psnr);
        assert_eq!(compare(&a, &b, 0.5).unwrap().pixels_over, 0);
        assert!(matches!(compare(&a, &grey(2, 3, 0.0), 0.0), Err(ImageError::SizesDiffer { .. })));
        let nan = grey(2, 2, f32::NAN);
        assert_eq!(compare(&nan, &nan, 0.0).unwrap().max, 0.0);
        assert_eq!(compare(&a, &nan, 0.0).unwrap().max, f64::INFINITY);
        let clear = Image::new(2, 2, Channels::Rgba).unwrap();
        assert_eq!(compare(&grey(2, 2, 0.0), &clear, 0.0).unwrap().mean, 0.25);
    }

    #[test]
    fn exact_class_finds_pixels_means_and_blocks() {
        let reference = grey(100, 20, 0.5);
        let check = |actual: &Image| conformance(&reference, actual, Class::Exact, false);
        assert!(check(&reference).passed());
        // Ten of 2000 pixels may be off, eleven may not.
        let mut actual = reference.clone();
        (0..10).for_each(|i| assert!(actual.set_pixel(i * 9, 0, [0.51, 0.5, 0.5, 1.0])));
        assert!(check(&actual).passed(), "{:?}", check(&actual));
        actual.set_pixel(99, 19, [0.51, 0.5, 0.5, 1.0]);
        assert_eq!(check(&actual).failures, ["99.45 % of the pixels agree, 99.5 wanted"]);
        assert_eq!(check(&grey(100, 20, 0.503)).failures, ["mean difference 0.765/255, at most 0.5 allowed"]);
        // One bad block in the corner, which only the pushed-in block covers wholly.
        let mut actual = reference.clone();
        (94..100).for_each(|x| assert!(actual.set_pixel(x, 19, [1.5, 0.5, 0.5, 1.0])));
        let found = check(&actual);
        assert_eq!(found.block_at, (92, 12));
        assert_eq!(found.failures, ["block at (92, 12) differs by 0.094, at most 0.08 allowed"]);
    }

    #[test]
    fn statistical_class_averages_noise() {
        let reference = grey(80, 80, 0.5);
        let check = |actual: &Image| conformance(&reference, actual, Class::Statistical, false);
        let mut actual = reference.clone();
        for (place, sample) in actual.samples_mut().iter_mut().enumerate() {
            *sample += if place / 3 % 2 == 0 { 0.2 } else { -0.2 };
        }
        assert!(check(&actual).passed(), "{:?}", check(&actual));
        assert!(!conformance(&reference, &actual, Class::Exact, false).passed());
        let mut actual = reference.clone();
        (0..8).for_each(|x| (0..8).for_each(|y| assert!(actual.set_pixel(x, y, [0.6, 0.5, 0.5, 1.0]))));
        assert_eq!(check(&actual).failures, ["block at (0, 0) is off by 0.100, at most 0.07 allowed"]);
        assert_eq!(
            check(&grey(80, 80, 0.51)).failures,
            ["block means differ by 2.55/255 on average, at most 2 allowed"]
        );
        let mut actual = reference.clone();
        (0..24).for_each(|x| (0..8).for_each(|y| assert!(actual.set_pixel(x, y, [0.53, 0.5, 0.5, 1.0]))));
        assert_eq!(check(&actual).failures, ["97.0 % of the blocks agree, 98 wanted"]);
    }

    #[test]
    fn sizes_infinities_and_clamping() {
        let reference = grey(9, 9, 3.0);
        let failures =
            |actual: &Image, clamp| conformance(&reference, actual, Class::Exact, clamp).failures.join("; ");
        assert_eq!(failures(&grey(9, 8, 3.0), false), "size 9x8, wanted 9x9");
        assert_eq!(failures(&grey(9, 9, f32::NAN), false), "81 pixels are not finite");
        assert_eq!(failures(&grey(9, 9, 1.0), true), "");
        assert_ne!(failures(&grey(9, 9, 1.0), false), "");
    }

    #[test]
    fn three_parts_side_by_side() {
        let picture = difference_picture(&grey(2, 1, 0.2), &grey(1, 2, 0.3)).unwrap();
        assert_eq!((picture.width(), picture.height()), (6, 2));
        let red = |x, y| picture.pixel(x, y).unwrap()[0];
        assert_eq!([red(0, 0), red(1, 0), red(0, 1)], [0.2, 0.2, 0.0]);
        assert!((red(2, 0) - 0.8).abs() < 1e-6);
        assert_eq!([red(3, 0), red(2, 1), red(3, 1)], [1.0, 1.0, 0.0]);
        assert!((red(4, 0) - 0.3).abs() < 0.002 && red(5, 0) == 0.0);
    }
}

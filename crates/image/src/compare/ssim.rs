//! The structural similarity of two pictures.

use crate::compare::filter::Plane;
use crate::compare::filter::in_bands;
use crate::compare::filter::kernel;
use crate::compare::filter::mean;
use crate::compare::filter::of_sum_one;
use crate::compare::shown;
use crate::compare::sizes_differ;
use crate::error::ImageError;
use crate::image::Image;

/// The weights of red, green and blue in the luma of ITU-R BT.601, as in the authors' own program.
const LUMA: [f64; 3] = [0.299, 0.587, 0.114];
/// (K·L)² of the paper, for values from 0 to 1 (L = 1) and its K₁ = 0.01, K₂ = 0.03.
const C1: f64 = 0.01 * 0.01;
const C2: f64 = 0.03 * 0.03;
const WINDOW_RADIUS: usize = 5;
const WINDOW_SIGMA: f64 = 1.5;

/// The mean structural similarity of Wang, Bovik, Sheikh and Simoncelli ("Image quality assessment: from error
/// visibility to structural similarity", 2004): a Gaussian window of 11 x 11 pixels with sigma 1.5, wherever it lies
/// inside the picture, on the luma (BT.601) of the display values clamped to 0…1. 1 for equal pictures. Where the
/// picture is smaller than the window, the window is cut down to it.
///
/// # Errors
/// [`ImageError::SizesDiffer`] if the sizes differ.
pub fn ssim(a: &Image, b: &Image) -> Result<f64, ImageError> {
    if let Some(error) = sizes_differ(a, b) {
        return Err(error);
    }
    let (row, column) = (window(a.width()), window(a.height()));
    let width = a.width() + 1 - row.len();
    let height = a.height() + 1 - column.len();
    let map = in_bands(width, height, |first, rows| {
        let luma = |image: &Image| luma_of_rows(image, first, rows + column.len() - 1);
        similarity(&luma(a), &luma(b), &row, &column)
    });
    Ok(mean(&map))
}

/// The window's row for an edge of the picture: its middle part where the edge is short.
fn window(edge: usize) -> Vec<f64> {
    let whole = kernel(WINDOW_RADIUS, |x| libm::exp(-x * x / (2.0 * WINDOW_SIGMA * WINDOW_SIGMA)));
    let excess = whole.len().saturating_sub(edge);
    of_sum_one(whole.into_iter().skip(excess / 2).take(edge).collect())
}

fn luma_of_rows(image: &Image, first: usize, rows: usize) -> Plane {
    let row = image.width() * image.channels().count();
    let samples = image.samples().chunks_exact(row).skip(first).take(rows).flatten();
    let samples: Vec<f64> = samples.map(|&sample| shown(sample)).collect();
    let luma = |pixel: &[f64]| pixel.iter().zip(LUMA).map(|(value, weight)| value * weight).sum();
    Plane { width: image.width(), values: samples.chunks_exact(image.channels().count()).map(luma).collect() }
}

fn similarity(a: &Plane, b: &Plane, row: &[f64], column: &[f64]) -> Vec<f64> {
    let [mean_a, mean_b, squares_a, squares_b, products] =
        [a, b, &a.times(a), &b.times(b), &a.times(b)].map(|plane| plane.filtered(row, column).values);
    let means = mean_a.into_iter().zip(mean_b);
    let moments = squares_a.into_iter().zip(squares_b).zip(products);
    let similarity =
        |((mean_a, mean_b), ((square_a, square_b), product)): ((f64, f64), ((f64, f64), f64))| {
            let variances = square_a - mean_a * mean_a + (square_b - mean_b * mean_b);
            let covariance = product - mean_a * mean_b;
            (2.0 * mean_a * mean_b + C1) * (2.0 * covariance + C2)
                / ((mean_a * mean_a + mean_b * mean_b + C1) * (variances + C2))
        };
    means.zip(moments).map(similarity).collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::compare::tests::gradient;
    use crate::image::Channels;

    #[test]
    fn equal_pictures_are_similar_by_one() {
        let (a, _) = gradient(20, 15);
        assert!((ssim(&a, &a).unwrap() - 1.0).abs() < 1e-9);
        for (width, height) in [(1, 1), (3, 30), (30, 3), (11, 11), (10, 12)] {
            let grey = Image::from_samples(width, height, Channels::Rgb, vec![0.3; width * height * 3]);
            assert!((ssim(&grey.clone().unwrap(), &grey.unwrap()).unwrap() - 1.0).abs() < 1e-9);
        }
        assert!(ssim(&a, &gradient(20, 16).0).is_err());
    }

    #[test]
    fn constant_pictures_follow_the_formula() {
        let grey = |value| Image::from_samples(12, 13, Channels::Rgb, vec![value; 468]).unwrap();
        let expected = (2.0 * 0.2 * 0.6 + C1) / (0.2 * 0.2 + 0.6 * 0.6 + C1);
        assert!((ssim(&grey(0.2), &grey(0.6)).unwrap() - expected).abs() < 1e-6);
        // What is darker than black or brighter than white is not seen.
        assert_eq!(ssim(&grey(-3.0), &grey(0.0)).unwrap(), 1.0);
        assert_eq!(ssim(&grey(f32::NAN), &grey(0.0)).unwrap(), 1.0);
    }

    /// What `structural_similarity` of scikit-image 0.26 gives for the same luma, with `gaussian_weights=True`,
    /// `sigma=1.5`, `use_sample_covariance=False`, `data_range=1`: the mean without the margin of 5 pixels.
    #[test]
    fn a_known_pair_has_the_known_similarity() {
        let (a, b) = gradient(48, 36);
        let found = ssim(&a, &b).unwrap();
        assert!((found - KNOWN).abs() < 1e-6, "{found}");
    }

    const KNOWN: f64 = 0.914_742_601_428_7;
}

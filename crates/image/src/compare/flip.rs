//! How far two pictures look apart to somebody who flips between them.

use std::f64::consts::PI;

use crate::compare::filter::Plane;
use crate::compare::filter::in_bands;
use crate::compare::filter::kernel;
use crate::compare::filter::mean;
use crate::compare::filter::of_sum_one;
use crate::compare::flip_color::distance;
use crate::compare::flip_color::greatest_distance;
use crate::compare::flip_color::lab_of_opponent;
use crate::compare::flip_color::opponent_of_display;
use crate::compare::shown;
use crate::compare::sizes_differ;
use crate::error::ImageError;
use crate::image::Channels;
use crate::image::Image;

/// Pixels a degree of the viewer's eye: 0.7 m before a screen that is 0.7 m wide and has 3840 columns.
pub const PIXELS_PER_DEGREE: f64 = 3840.0 * PI / 180.0;

/// What a viewer would see of the difference of two pictures.
#[derive(Debug, Clone, PartialEq)]
pub struct Flip {
    /// The mean over all pixels: 0 for pictures that look the same, at most 1.
    pub mean: f64,
    /// The greatest value of a pixel.
    pub max: f64,
    /// The value of every pixel, row by row from above.
    pub map: Vec<f32>,
}

/// LDR-FLIP of Andersson, Nilsson, Akenine-Möller, Oskarsson, Åström and Fairchild ("FLIP: A Difference Evaluator for
/// Alternating Images", High Performance Graphics 2020), with the paper's constants and [`PIXELS_PER_DEGREE`], on the
/// display values (sRGB) clamped to 0…1. Alpha does not count. Both pictures continue beyond their edges as at them.
///
/// # Errors
/// [`ImageError::SizesDiffer`] if the sizes differ.
pub fn flip(a: &Image, b: &Image) -> Result<Flip, ImageError> {
    if let Some(error) = sizes_differ(a, b) {
        return Err(error);
    }
    let filters = Filters::new(PIXELS_PER_DEGREE);
    let greatest = redistribution();
    let map = in_bands(a.width(), a.height(), |first, rows| {
        let (seen_a, seen_b) = (filters.see(a, first, rows), filters.see(b, first, rows));
        let pixels = seen_a.into_iter().zip(seen_b);
        pixels.map(|(a, b)| error(&a, &b, greatest)).collect()
    });
    let max = map.iter().fold(0.0_f32, |max, &value| max.max(value));
    Ok(Flip { mean: mean(&map), max: f64::from(max), map })
}

impl Flip {
    /// The map as a grey picture of the given width: black where nothing is seen, white at 1.
    ///
    /// # Errors
    /// [`ImageError::SampleCount`] if the width does not divide the map.
    pub fn picture(&self, width: usize) -> Result<Image, ImageError> {
        let samples = self.map.iter().flat_map(|&value| [value; 3]).collect();
        Image::from_samples(width, self.map.len() / width.max(1), Channels::Rgb, samples)
    }
}

/// What the eye takes up of one pixel.
struct Seen {
    /// In Hunt-adjusted CIELAB, after the eye's blurring.
    lab: [f64; 3],
    /// How strong an edge and a point stand here.
    edge: f64,
    point: f64,
}

/// The contrast sensitivity of the three opponent channels, each a weighted sum of Gaussians, and the detectors of
/// edges and points. All kernels have one radius, so that all planes keep one size.
struct Filters {
    radius: usize,
    /// For each channel, weight and row of each Gaussian.
    sensitivity: [Vec<(f64, Vec<f64>)>; 3],
    gaussian: Vec<f64>,
    /// First and second derivative of that Gaussian.
    slope: Vec<f64>,
    bend: Vec<f64>,
}

/// a and b of the Gaussians a·√(π/b)·exp(−π²d²/b), d in degrees: of lightness, red–green and blue–yellow.
const SENSITIVITY: [&[(f64, f64)]; 3] = [&[(1.0, 0.0047)], &[(1.0, 0.0053)], &[(34.1, 0.04), (13.5, 0.025)]];
const WIDEST: f64 = 0.04;
/// The width of the lines and points that the detectors look for, in degrees.
const FEATURE_WIDTH: f64 = 0.082;

impl Filters {
    fn new(pixels_per_degree: f64) -> Filters {
        let color_radius = (3.0 * (WIDEST / (2.0 * PI * PI)).sqrt() * pixels_per_degree).ceil();
        let sigma = 0.5 * FEATURE_WIDTH * pixels_per_degree;
        let feature_radius = (3.0 * sigma).ceil();
        let radius = color_radius.max(feature_radius) as usize;
        let gaussians = |list: &&[(f64, f64)]| {
            let whole: Vec<(f64, Vec<f64>)> = list
                .iter()
                .map(|&(a, b)| {
                    let row = cut(radius, color_radius, |x| {
                        let degrees = x / pixels_per_degree;
                        libm::exp(-PI * PI * degrees * degrees / b)
                    });
                    let sum: f64 = row.iter().sum();
                    (a * (PI / b).sqrt() * sum * sum, of_sum_one(row))
                })
                .collect();
            let total: f64 = whole.iter().map(|(weight, _)| weight).sum();
            whole.into_iter().map(|(weight, row)| (weight / total, row)).collect()
        };
        let [y, x, z] = SENSITIVITY.each_ref().map(gaussians);
        let bell = |x: f64| libm::exp(-x * x / (2.0 * sigma * sigma));
        Filters {
            radius,
            sensitivity: [y, x, z],
            gaussian: of_sum_one(cut(radius, feature_radius, bell)),
            slope: balanced(cut(radius, feature_radius, |x| -x * bell(x))),
            bend: balanced(cut(radius, feature_radius, |x| (x * x / (sigma * sigma) - 1.0) * bell(x))),
        }
    }

    /// What is seen of each pixel of some rows.
    fn see(&self, image: &Image, first: usize, rows: usize) -> Vec<Seen> {
        let opponent = opponent_planes(image, first, rows, self.radius);
        let [lightness, _, _] = &opponent;
        let detect = |row: &[f64], column: &[f64]| lightness.map(unit).filtered(row, column).values;
        let edges = detect(&self.slope, &self.gaussian).into_iter().zip(detect(&self.gaussian, &self.slope));
        let points = detect(&self.bend, &self.gaussian).into_iter().zip(detect(&self.gaussian, &self.bend));
        let mut blurred = opponent.iter().zip(&self.sensitivity).map(|(plane, list)| blur(plane, list));
        let mut next = || blurred.next().unwrap_or_default();
        let colors = next().into_iter().zip(next()).zip(next());
        colors
            .zip(edges.zip(points))
            .map(|(((y, x), z), ((edge_x, edge_y), (point_x, point_y)))| Seen {
                lab: lab_of_opponent([y, x, z]),
                edge: libm::hypot(edge_x, edge_y),
                point: libm::hypot(point_x, point_y),
            })
            .collect()
    }
}

/// The kernel of one radius within a longer one.
fn cut(radius: usize, inner: f64, of: impl Fn(f64) -> f64) -> Vec<f64> {
    kernel(radius, |x| if x.abs() <= inner { of(x) } else { 0.0 })
}

/// A kernel whose positive weights add up to 1 and whose negative ones to -1.
fn balanced(kernel: Vec<f64>) -> Vec<f64> {
    let positive: f64 = kernel.iter().filter(|weight| **weight > 0.0).sum();
    let negative: f64 = kernel.iter().filter(|weight| **weight < 0.0).sum();
    kernel
        .into_iter()
        .map(|weight| if weight > 0.0 { weight / positive } else { -weight / negative })
        .collect()
}

/// Lightness as 0…1.
fn unit(lightness: f64) -> f64 {
    (lightness + 16.0) / 116.0
}

fn blur(plane: &Plane, gaussians: &[(f64, Vec<f64>)]) -> Vec<f64> {
    let mut sum: Vec<f64> = Vec::new();
    for (weight, row) in gaussians {
        let part = plane.filtered(row, row).values;
        if sum.is_empty() {
            sum = part.into_iter().map(|value| weight * value).collect();
        } else {
            sum.iter_mut().zip(part).for_each(|(sum, value)| *sum += weight * value);
        }
    }
    sum
}

/// The opponent channels of some rows and of a margin around them, in which the picture's edges are repeated.
fn opponent_planes(image: &Image, first: usize, rows: usize, margin: usize) -> [Plane; 3] {
    let width = image.width() + 2 * margin;
    let mut planes = [(); 3].map(|()| Vec::with_capacity(width * (rows + 2 * margin)));
    let inside = |place: usize, edge: usize| place.saturating_sub(margin).min(edge - 1);
    for y in first..first + rows + 2 * margin {
        let y = inside(y, image.height());
        let of_pixel = |x| {
            let [r, g, b, _] = image.pixel(x, y).unwrap_or_default();
            opponent_of_display([r, g, b].map(shown))
        };
        let row: Vec<[f64; 3]> = (0..image.width()).map(of_pixel).collect();
        for x in 0..width {
            let color = row.get(inside(x, image.width())).copied().unwrap_or_default();
            planes.iter_mut().zip(color).for_each(|(plane, value)| plane.push(value));
        }
    }
    planes.map(|values| Plane { width, values })
}

/// The exponents and the bend of the paper's section 4.1.3 and 4.2.
const COLOR_EXPONENT: f64 = 0.7;
const FEATURE_EXPONENT: f64 = 0.5;
const BEND_AT: f64 = 0.4;
const BEND_VALUE: f64 = 0.95;

/// The greatest colour difference that the screen can show, to the power.
fn redistribution() -> f64 {
    libm::pow(greatest_distance(), COLOR_EXPONENT)
}

fn error(a: &Seen, b: &Seen, greatest: f64) -> f64 {
    let color = libm::pow(distance(a.lab, b.lab), COLOR_EXPONENT);
    let bend = BEND_AT * greatest;
    let color = if color < bend {
        BEND_VALUE / bend * color
    } else {
        BEND_VALUE + (color - bend) / (greatest - bend) * (1.0 - BEND_VALUE)
    };
    let feature = (a.edge - b.edge).abs().max((a.point - b.point).abs());
    let feature = libm::pow(feature / std::f64::consts::SQRT_2, FEATURE_EXPONENT);
    libm::pow(color, 1.0 - feature).clamp(0.0, 1.0)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::compare::tests::gradient;

    #[test]
    fn equal_pictures_look_equal() {
        let (a, _) = gradient(20, 15);
        let seen = flip(&a, &a).unwrap();
        assert_eq!((seen.mean, seen.max, seen.map.len()), (0.0, 0.0, 300));
        assert!(flip(&a, &gradient(20, 16).0).is_err());
        assert_eq!(seen.picture(20).unwrap().height(), 15);
        assert!(seen.picture(0).is_err());
    }

    #[test]
    fn black_and_white_are_as_far_apart_as_can_be_seen() {
        let grey = |value| Image::from_samples(5, 4, Channels::Rgb, vec![value; 60]).unwrap();
        // L is 0 and 100: the formula of the bend by hand.
        let greatest = libm::pow(greatest_distance(), 0.7);
        let bend = 0.4 * greatest;
        let expected = 0.95 + (libm::pow(100.0, 0.7) - bend) / (greatest - bend) * 0.05;
        let seen = flip(&grey(0.0), &grey(1.0)).unwrap();
        assert!((seen.mean - expected).abs() < 1e-6, "{} {expected}", seen.mean);
        assert_eq!(flip(&grey(-1.0), &grey(0.0)).unwrap().mean, 0.0);
        assert_eq!(flip(&grey(f32::NAN), &grey(0.0)).unwrap().mean, 0.0);
    }

    /// The mean that the authors' own program (flip-evaluator 1.7) gives for the same pair.
    #[test]
    fn a_known_pair_looks_as_far_apart_as_its_authors_say() {
        let (a, b) = gradient(48, 36);
        let found = flip(&a, &b).unwrap().mean;
        assert!((found - KNOWN).abs() < 2e-6, "{found}");
    }

    const KNOWN: f64 = 0.074_388_81;
}

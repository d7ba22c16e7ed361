//! Planes of numbers, filters over them, and bands of rows that threads take in turn.

use std::num::NonZero;
use std::sync::Mutex;

/// One number a pixel, row by row.
pub struct Plane {
    pub width: usize,
    pub values: Vec<f64>,
}

impl Plane {
    /// Each number of `of` in turn for the numbers of this plane.
    pub fn map(&self, of: impl Fn(f64) -> f64) -> Plane {
        Plane { width: self.width, values: self.values.iter().map(|&value| of(value)).collect() }
    }

    /// The product of two planes, number by number.
    pub fn times(&self, other: &Plane) -> Plane {
        let values = self.values.iter().zip(&other.values).map(|(a, b)| a * b).collect();
        Plane { width: self.width, values }
    }

    /// Weighted sums along rows; only where the kernel fits, so rows get shorter by its length less 1.
    fn across(&self, kernel: &[f64]) -> Plane {
        let sum = |window: &[f64]| window.iter().zip(kernel).map(|(value, weight)| value * weight).sum();
        let rows = self.values.chunks_exact(self.width.max(1));
        let values = rows.flat_map(|row| row.windows(kernel.len()).map(sum)).collect();
        Plane { width: (self.width + 1).saturating_sub(kernel.len()), values }
    }

    /// Weighted sums along columns; only where the kernel fits.
    fn down(&self, kernel: &[f64]) -> Plane {
        let rows: Vec<&[f64]> = self.values.chunks_exact(self.width.max(1)).collect();
        let mut values = Vec::with_capacity(self.values.len());
        for window in rows.windows(kernel.len()) {
            let mut sums = vec![0.0; self.width];
            for (row, weight) in window.iter().zip(kernel) {
                sums.iter_mut().zip(*row).for_each(|(sum, value)| *sum += value * weight);
            }
            values.extend(sums);
        }
        Plane { width: self.width, values }
    }

    /// The plane under a filter that is the product of a row and a column; only where the filter fits.
    pub fn filtered(&self, row: &[f64], column: &[f64]) -> Plane {
        self.across(row).down(column)
    }
}

/// The weights `of(x)` for x from -radius to radius.
pub fn kernel(radius: usize, of: impl Fn(f64) -> f64) -> Vec<f64> {
    (0..=2 * radius).map(|place| of(place as f64 - radius as f64)).collect()
}

/// A kernel whose sum is 1.
pub fn of_sum_one(kernel: Vec<f64>) -> Vec<f64> {
    let sum: f64 = kernel.iter().sum();
    kernel.into_iter().map(|weight| weight / sum).collect()
}

/// Rows that are worked on at a time: the memory for filters is that of a band, whatever the picture's size.
const BAND: usize = 32;

/// A map of `width` x `height` numbers. `of(first, rows)` gives those of some rows; several threads share the bands,
/// and the map does not depend on them.
pub fn in_bands(width: usize, height: usize, of: impl Fn(usize, usize) -> Vec<f64> + Sync) -> Vec<f32> {
    let mut map = vec![0.0_f32; width * height];
    let threads = std::thread::available_parallelism().map_or(1, NonZero::get).min(height.div_ceil(BAND));
    let bands = Mutex::new(map.chunks_mut((width * BAND).max(1)).enumerate());
    let work = || {
        while let Some((number, band)) = bands.lock().ok().and_then(|mut bands| bands.next()) {
            let values = of(number * BAND, band.len() / width);
            band.iter_mut().zip(values).for_each(|(place, value)| *place = value as f32);
        }
    };
    if threads < 2 {
        work();
    } else {
        std::thread::scope(|scope| (0..threads).for_each(|_| drop(scope.spawn(work))));
    }
    map
}

/// The mean of a map, summed in its order.
pub fn mean(map: &[f32]) -> f64 {
    map.iter().map(|&value| f64::from(value)).sum::<f64>() / map.len() as f64
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn filters_lose_their_margins() {
        let plane = Plane { width: 4, values: (0..12).map(f64::from).collect() };
        let filtered = plane.filtered(&[1.0, 0.0, -1.0], &[0.5, 0.5]);
        assert_eq!((filtered.width, filtered.values), (2, vec![-2.0; 4]));
        let filtered = plane.filtered(&[1.0], &[0.0, 1.0, 0.0]);
        assert_eq!(filtered.values, [4.0, 5.0, 6.0, 7.0]);
    }

    #[test]
    fn bands_cover_every_row_once() {
        for height in [1, BAND, BAND + 1, 3 * BAND - 1] {
            let map = in_bands(3, height, |first, rows| {
                (first..first + rows).flat_map(|row| vec![row as f64; 3]).collect()
            });
            let expected: Vec<f32> = (0..height).flat_map(|row| vec![row as f32; 3]).collect();
            assert_eq!(map, expected);
        }
    }
}

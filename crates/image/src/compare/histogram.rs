//! How many samples differ by how much.

use crate::compare::channel_distances;
use crate::compare::sizes_differ;
use crate::error::ImageError;
use crate::image::Image;

/// Samples whose difference, rounded to steps of 1/255, lies in a range.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Bin {
    /// The least number of steps.
    pub from: u32,
    /// The greatest number of steps; none for the last bin, which has no end.
    pub to: Option<u32>,
    /// How many samples of red, green and blue.
    pub counts: [u64; 3],
}

/// The ranges double in width: equal, one step, two, three to four, and so on.
const ENDS: [u32; 9] = [0, 1, 2, 4, 8, 16, 32, 64, 128];

/// The absolute differences of red, green and blue in bins that double in width, in steps of 1/255. Every sample is in
/// one of them, those that are not finite in the last.
///
/// # Errors
/// [`ImageError::SizesDiffer`] if the sizes differ.
pub fn histogram(a: &Image, b: &Image) -> Result<Vec<Bin>, ImageError> {
    if let Some(error) = sizes_differ(a, b) {
        return Err(error);
    }
    let mut from = 0;
    let mut bins = Vec::new();
    for to in ENDS.into_iter().map(Some).chain([None]) {
        bins.push(Bin { from, to, counts: [0; 3] });
        from = to.map_or(from, |to| to + 1);
    }
    for differences in channel_distances(a, b) {
        for (channel, difference) in differences.into_iter().enumerate() {
            let steps = (255.0 * difference).round();
            let bin = bins.iter_mut().find(|bin| bin.to.is_none_or(|to| steps <= f64::from(to)));
            if let Some(count) = bin.and_then(|bin| bin.counts.get_mut(channel)) {
                *count += 1;
            }
        }
    }
    Ok(bins)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::image::Channels;

    #[test]
    fn every_sample_is_in_one_bin() {
        let black = Image::new(3, 1, Channels::Rgb).unwrap();
        let mut other = black.clone();
        other.set_pixel(1, 0, [1.4 / 255.0, 3.0 / 255.0, 1.0, 1.0]);
        other.set_pixel(2, 0, [f32::NAN, 0.4 / 255.0, f32::INFINITY, 1.0]);
        let bins = histogram(&black, &other).unwrap();
        let counts = |to: Option<u32>| bins.iter().find(|bin| bin.to == to).map(|bin| bin.counts);
        assert_eq!(counts(Some(0)), Some([1, 2, 1]));
        assert_eq!(counts(Some(1)), Some([1, 0, 0]));
        assert_eq!(counts(Some(4)), Some([0, 1, 0]));
        assert_eq!(counts(None), Some([1, 0, 2]));
        assert_eq!(bins.iter().map(|bin| bin.counts.iter().sum::<u64>()).sum::<u64>(), 9);
        let ranges: Vec<_> = bins.iter().take(4).map(|bin| (bin.from, bin.to)).collect();
        assert_eq!(ranges, [(0, Some(0)), (1, Some(1)), (2, Some(2)), (3, Some(4))]);
        assert_eq!(bins.last().map(|bin| bin.from), Some(129));
    }
}

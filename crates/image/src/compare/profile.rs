//! All figures on two pictures, and what different purposes forgive.

use crate::compare::Block;
use crate::compare::Comparison;
use crate::compare::compare;
use crate::compare::flip::Flip;
use crate::compare::flip::flip;
use crate::compare::histogram::Bin;
use crate::compare::histogram::histogram;
use crate::compare::largest_block;
use crate::compare::ssim::ssim;
use crate::error::ImageError;
use crate::image::Image;

/// What is forgiven when two pictures are compared.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
pub enum Profile {
    /// Nothing but the rounding to 8 bits: no sample may differ by more than half a step of 1/255. For pictures of the
    /// same program: another number of threads, another machine, another file format.
    Exact,
    /// What another correct program in double precision may do otherwise: values rounded elsewhere, single pixels on
    /// silhouettes and shadow edges. At least 99.5 % of the pixels within 2/255, the mean difference at most 0.5/255,
    /// no 8x8 block with a mean difference above 0.08.
    Strict,
    /// Noise and small steps besides: single precision, soft shadows with other samples, another oversampling of
    /// edges. At least 95 % of the pixels within 8/255, the mean difference at most 3/255, no 8x8 block with a mean
    /// difference above 0.2, and a FLIP of at most 0.05. A missing light, shadow or highlight is not forgiven.
    Lenient,
}

/// The numbers of a profile; a figure above, or a share below, is over.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Allowance {
    /// A pixel agrees if no channel differs by more.
    pub tolerance: f64,
    /// The share of the pixels that must agree.
    pub share: f64,
    /// The greatest mean difference.
    pub mean: f64,
    /// The greatest mean difference of an 8x8 block in a channel.
    pub block: f64,
    /// The greatest mean of FLIP.
    pub flip: f64,
}

/// For values that come from f32: 2/255 as a difference of two rounded values may be a little more.
const ROUNDING: f64 = 1e-6;

impl Profile {
    /// Every profile, the one that forgives least first.
    pub const ALL: [Profile; 3] = [Profile::Exact, Profile::Strict, Profile::Lenient];

    /// Its name in options and files.
    pub fn name(self) -> &'static str {
        match self {
            Profile::Exact => "exact",
            Profile::Strict => "strict",
            Profile::Lenient => "lenient",
        }
    }

    /// Its numbers.
    pub fn allowance(self) -> Allowance {
        match self {
            Profile::Exact => {
                let half = 0.5 / 255.0;
                Allowance { tolerance: half, share: 1.0, mean: half, block: half, flip: 1.0 }
            }
            Profile::Strict => {
                Allowance { tolerance: 2.0 / 255.0, share: 0.995, mean: 0.5 / 255.0, block: 0.08, flip: 1.0 }
            }
            Profile::Lenient => {
                Allowance { tolerance: 8.0 / 255.0, share: 0.95, mean: 3.0 / 255.0, block: 0.2, flip: 0.05 }
            }
        }
    }
}

/// Every figure on two pictures of the same size.
#[derive(Debug, Clone, PartialEq)]
pub struct Report {
    /// Differences of samples.
    pub figures: Comparison,
    /// The mean structural similarity of the luma.
    pub ssim: f64,
    /// What a viewer would see.
    pub flip: Flip,
    /// The 8x8 block that differs most.
    pub block: Block,
    /// How many samples differ by how much.
    pub histogram: Vec<Bin>,
}

impl Report {
    /// Takes every figure; `tolerance` is the difference above which a pixel counts as over.
    ///
    /// # Errors
    /// [`ImageError::SizesDiffer`] if the sizes differ.
    pub fn new(a: &Image, b: &Image, tolerance: f64) -> Result<Report, ImageError> {
        Ok(Report {
            figures: compare(a, b, tolerance + ROUNDING)?,
            ssim: ssim(a, b)?,
            flip: flip(a, b)?,
            block: largest_block(a, b)?,
            histogram: histogram(a, b)?,
        })
    }

    /// One sentence for each figure that is over; none if the pictures are within. The report must have been made with
    /// the allowance's tolerance.
    pub fn excesses(&self, allowed: &Allowance) -> Vec<String> {
        let mut excesses = Vec::new();
        let Comparison { mean, pixels_over, pixels, .. } = self.figures;
        let share = (pixels - pixels_over) as f64 / pixels as f64;
        if share < allowed.share {
            let (share, wanted) = (100.0 * share, 100.0 * allowed.share);
            let steps = 255.0 * allowed.tolerance;
            excesses.push(format!(
                "{share:.2} % of the pixels agree within {steps:.3}/255, {wanted} % are wanted"
            ));
        }
        if mean > allowed.mean + ROUNDING {
            let (mean, most) = (255.0 * mean, 255.0 * allowed.mean);
            excesses.push(format!("the mean difference is {mean:.3}/255, at most {most:.3}/255 is allowed"));
        }
        if self.block.difference > allowed.block + ROUNDING {
            let (x, y) = self.block.at;
            let (block, most) = (self.block.difference, allowed.block);
            excesses.push(format!(
                "the 8x8 block at {x},{y} differs by {block:.4} on average, at most {most:.4} is allowed"
            ));
        }
        if self.flip.mean > allowed.flip {
            excesses.push(format!("FLIP is {:.4}, at most {} is allowed", self.flip.mean, allowed.flip));
        }
        excesses
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::image::Channels;

    fn grey(value: f32) -> Image {
        Image::from_samples(40, 40, Channels::Rgb, vec![value; 4800]).unwrap()
    }

    fn excesses(a: &Image, b: &Image, profile: Profile) -> Vec<String> {
        let allowed = profile.allowance();
        Report::new(a, b, allowed.tolerance).unwrap().excesses(&allowed)
    }

    fn passing(a: &Image, b: &Image) -> Vec<&'static str> {
        let passes = |profile: &Profile| excesses(a, b, *profile).is_empty();
        Profile::ALL.into_iter().filter(passes).map(Profile::name).collect()
    }

    #[test]
    fn each_profile_forgives_what_it_says() {
        let middle = grey(128.0 / 255.0);
        assert_eq!(passing(&middle, &middle), ["exact", "strict", "lenient"]);
        assert_eq!(passing(&middle, &grey(128.49 / 255.0)), ["exact", "strict", "lenient"]);
        assert_eq!(passing(&middle, &grey(129.0 / 255.0)), ["lenient"]);
        assert_eq!(passing(&middle, &grey(140.0 / 255.0)), [""; 0]);
        let mut one_pixel = middle.clone();
        one_pixel.set_pixel(3, 3, [1.0, 0.5, 0.5, 1.0]);
        assert_eq!(passing(&middle, &one_pixel), ["strict", "lenient"]);
        let mut a_spot = middle.clone();
        (0..8).for_each(|x| (0..8).for_each(|y| assert!(a_spot.set_pixel(x, y, [0.8, 0.5, 0.5, 1.0]))));
        assert_eq!(passing(&middle, &a_spot), [""; 0]);
        let mut wrong = middle.clone();
        wrong.set_pixel(0, 0, [f32::NAN, 0.5, 0.5, 1.0]);
        assert_eq!(passing(&middle, &wrong), [""; 0]);
    }

    #[test]
    fn excesses_say_what_and_how_much() {
        let found = excesses(&grey(0.0), &grey(1.0), Profile::Lenient).join("\n");
        for part in [
            "0.00 % of the pixels agree within 8.000/255, 95 % are wanted",
            "255.000/255",
            "differs by 1.0000",
            "FLIP",
        ] {
            assert!(found.contains(part), "{found}");
        }
    }
}

//! What a picture is worth.

use dotray_image::Image;
use dotray_image::compare::profile::Profile;
use dotray_image::compare::profile::Report;

use crate::case::Case;
use crate::settings::Credit;
use crate::suite::Test;

/// How good a picture is.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Verdict {
    /// Within the test's tolerance.
    Right,
    /// Within the profile `lenient`.
    Close,
    /// More than half of what is seen is right.
    Partly,
    /// Less is.
    Wrong,
    /// There is no picture, or one of another size.
    NoPicture,
}

impl Verdict {
    /// The word in reports.
    pub fn name(self) -> &'static str {
        match self {
            Self::Right => "right",
            Self::Close => "close",
            Self::Partly => "partly",
            Self::Wrong => "wrong",
            Self::NoPicture => "no picture",
        }
    }
}

/// The judgement on a picture of the right size.
#[derive(Clone, Debug)]
pub struct Score {
    /// How good it is.
    pub verdict: Verdict,
    /// The share of the test's points.
    pub credit: f64,
    /// The share of what is seen that is right, see [`share_of_content`].
    pub share: f64,
    /// Why it is not within the tolerance.
    pub reasons: Vec<String>,
    /// All figures.
    pub report: Report,
}

/// Judges a picture that has been brought to 0…1.
///
/// # Errors
/// The picture has another size than the truth.
pub fn score(case: &Case, picture: &Image, test: &Test, credit: &Credit) -> Result<Score, String> {
    let compared =
        |tolerance| Report::new(&case.truth, picture, tolerance).map_err(|error| error.to_string());
    let report = compared(test.allowance.tolerance)?;
    let reasons = report.excesses(&test.allowance);
    let lenient = Profile::Lenient.allowance();
    let share = share_of_content(case, picture, lenient.tolerance);
    let is_close = compared(lenient.tolerance)?.excesses(&lenient).is_empty();
    let (verdict, credit) = if reasons.is_empty() {
        (Verdict::Right, 1.0)
    } else if is_close {
        (Verdict::Close, credit.lenient)
    } else if share > 0.5 {
        (Verdict::Partly, credit.partial * (2.0 * share - 1.0))
    } else {
        (Verdict::Wrong, 0.0)
    };
    Ok(Score { verdict, credit, share, reasons, report })
}

/// Of the pixels where the truth or the picture shows anything but the background, the share that agrees within the
/// tolerance: a blank picture of a small shape is not nearly right. 1 where there is nothing but background.
pub fn share_of_content(case: &Case, picture: &Image, tolerance: f64) -> f64 {
    let differ = |a: [f32; 4], b: [f32; 3], by: f64| {
        a.into_iter().zip(b).any(|(a, b)| (f64::from(a) - f64::from(b)).abs() > by)
    };
    let (mut content, mut right) = (0_u64, 0_u64);
    for (y, x) in (0..case.truth.height()).flat_map(|y| (0..case.truth.width()).map(move |x| (y, x))) {
        let truth = case.truth.pixel(x, y).unwrap_or_default();
        let found = picture.pixel(x, y).unwrap_or_default();
        let step = 2.0 / 255.0;
        if differ(truth, case.background, step) || differ(found, case.background, step) {
            let [r, g, b, _] = truth;
            content += 1;
            right += u64::from(!differ(found, [r, g, b], tolerance));
        }
    }
    if content == 0 { 1.0 } else { right as f64 / content as f64 }
}

//! The likely fault of a wrong picture: the variant that it matches better than the truth.

use dotray_image::Image;

use crate::case::Case;
use crate::suite::Test;
use crate::variants::Change;
use crate::variants::VARIANTS;
use crate::variants::Variant;

/// A likely fault.
#[derive(Clone, Debug, PartialEq)]
pub struct Hint {
    /// The variant's name.
    pub name: &'static str,
    /// What it tells.
    pub text: String,
    /// The mean difference from the variant's picture.
    pub distance: f64,
}

/// A variant whose picture is the truth, to within a quarter of a step of 1/255, says nothing about this scene.
const SAME: f64 = 0.25 / 255.0;
/// A variant is named if the picture is at least so much nearer to it than to the truth.
const NEARER: f64 = 0.5;
/// Others are named too if they are hardly further off than the nearest: by this factor and a tenth of a step.
const AS_NEAR: f64 = 1.15;
const MOST_HINTS: usize = 3;

/// The likely faults of a picture of the right size, brought to 0…1; the likeliest first. None where no
/// variant comes near.
pub fn hints(case: &Case, picture: &Image, test: &Test) -> Vec<Hint> {
    hints_among(&telling(case, test), case, picture, test)
}

/// The pictures of all variants that differ from the truth in this scene, in the order of the variants.
pub fn telling(case: &Case, test: &Test) -> Vec<(&'static Variant, Image)> {
    let pictures = VARIANTS.iter().filter(|variant| is_wanted(variant, test)).filter_map(|variant| {
        let picture = case.variant(&variant.change).ok()?;
        (distance(&picture, &case.truth) > SAME).then_some((variant, picture))
    });
    pictures.collect()
}

fn is_wanted(variant: &Variant, test: &Test) -> bool {
    test.hints.as_ref().is_none_or(|names| names.iter().any(|name| name == variant.name))
}

/// [`hints`] among pictures that are there already.
pub fn hints_among(
    telling: &[(&'static Variant, Image)],
    case: &Case,
    picture: &Image,
    test: &Test,
) -> Vec<Hint> {
    let from_truth = distance(picture, &case.truth);
    let hint = |variant: &Variant, distance: f64| {
        let text = test.say.get(variant.name).cloned().unwrap_or_else(|| variant.hint.to_owned());
        (distance < NEARER * from_truth).then_some(Hint { name: variant.name, text, distance })
    };
    let mut found: Vec<Hint> =
        telling.iter().filter_map(|(variant, wrong)| hint(variant, distance(picture, wrong))).collect();
    // This one depends on the picture that is judged.
    let speckles = VARIANTS.iter().find(|variant| matches!(variant.change, Change::Speckles));
    if let Some(variant) = speckles.filter(|variant| is_wanted(variant, test)) {
        found.extend(distance_of_speckles(case, picture).and_then(|distance| hint(variant, distance)));
    }
    // Stable, so that of two with the same picture the first stays first.
    found.sort_by(|a, b| a.distance.total_cmp(&b.distance));
    if let Some(nearest) = found.first().map(|hint| hint.distance) {
        found.retain(|hint| hint.distance <= AS_NEAR * nearest + 0.1 / 255.0);
        found.truncate(MOST_HINTS);
    }
    found
}

/// The mean absolute difference of red, green and blue; infinite for pictures of other sizes.
fn distance(a: &Image, b: &Image) -> f64 {
    dotray_image::compare::compare(a, b, 0.0).map_or(f64::INFINITY, |figures| figures.mean)
}

/// How far the picture is from one in which each point is either as it should be or in shadow, where both occur side by
/// side all over the place; none where they do not.
fn distance_of_speckles(case: &Case, picture: &Image) -> Option<f64> {
    let dark = case.variant(&Change::Resolved(|resolved, _| resolved.lights.clear())).ok()?;
    let apart = |a: [f32; 4], b: [f32; 4]| {
        let channels = a.into_iter().zip(b).take(3);
        channels.map(|(a, b)| (f64::from(a) - f64::from(b)).abs()).sum::<f64>() / 3.0
    };
    let (mut sum, mut points, mut in_shadow, mut pairs, mut changes) = (0.0, 0_u32, 0_u32, 0_u32, 0_u32);
    for y in 0..case.truth.height() {
        let mut before = None;
        for x in 0..case.truth.width() {
            let [truth, dark, found] =
                [&case.truth, &dark, picture].map(|image| image.pixel(x, y).unwrap_or_default());
            let (from_truth, from_dark) = (apart(found, truth), apart(found, dark));
            sum += from_truth.min(from_dark);
            // Where light changes little, nothing can be told.
            let choice = (apart(truth, dark) > 0.05).then_some(from_dark < from_truth);
            if let Some(is_dark) = choice {
                points += 1;
                in_shadow += u32::from(is_dark);
                pairs += u32::from(before.is_some());
                changes += u32::from(before.is_some_and(|before| before != is_dark));
            }
            before = choice;
        }
    }
    let share = |part: u32, whole: u32| f64::from(part) / f64::from(whole.max(1));
    let mixed = (0.03..0.97).contains(&share(in_shadow, points)) && share(changes, pairs) > 0.08;
    mixed.then(|| sum / (case.truth.width() * case.truth.height()) as f64)
}

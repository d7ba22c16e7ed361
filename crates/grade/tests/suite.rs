//! The ready suite: its scenes have pictures, and every wrong variant is found by one of them.

use dotray_grade::bent::Bend;
use dotray_grade::bent::snell;
use dotray_grade::case::Case;
use dotray_grade::case::clamped;
use dotray_grade::hint::hints;
use dotray_grade::hint::hints_among;
use dotray_grade::hint::telling;
use dotray_grade::score::Verdict;
use dotray_grade::score::score;
use dotray_grade::suite::Suite;
use dotray_grade::suite::Test;
use dotray_grade::variants::Change;
use dotray_grade::variants::VARIANTS;
use dotray_grade::variants::Variant;
use dotray_image::EncodeOptions;
use dotray_image::Format;
use dotray_image::Image;
use dotray_image::Limits;
use dotray_image::compare::compare;
use dotray_image::compare::profile::Profile;
use dotray_image::decode;
use dotray_image::encode;
use std::path::Path;

fn ready_suite() -> Suite {
    Suite::read(&Path::new(env!("CARGO_MANIFEST_DIR")).join("../../grading")).expect("the ready suite")
}

/// The suite with pictures so small that all variants of all scenes can be made.
fn small_suite() -> Suite {
    let mut suite = ready_suite();
    for options in suite.tests.iter_mut().map(|test| &mut test.options) {
        (options.width, options.height) = (options.width / 2, options.height / 2);
    }
    suite
}

fn cases(suite: &Suite) -> Vec<(&Test, Case)> {
    let case = |test| Case::new(suite, test).unwrap_or_else(|error| panic!("{error}"));
    suite.tests.iter().map(|test| (test, case(test))).collect()
}

/// What comes back from a file of the suite's format.
fn stored(image: &Image, format: Format) -> Image {
    let bytes = encode(image, format, &EncodeOptions::default()).expect("a file");
    clamped(decode(&bytes, None, &Limits::default()).expect("a picture"))
}

#[test]
fn about_forty_lessons_stand_in_teaching_order() {
    let suite = ready_suite();
    assert!((40..=60).contains(&suite.tests.len()), "{}", suite.tests.len());
    let scenes: Vec<&Path> = suite.tests.iter().map(|test| test.scene.as_path()).collect();
    assert!(scenes.is_sorted(), "{scenes:?}");
    let place = |name: &str| suite.tests.iter().position(|test| test.name == name).expect("a lesson");
    let order = ["sphere", "camera", "light-dir", "box", "translate", "shadow-dir", "mirror", "glass"];
    assert!(order.windows(2).all(|pair| place(pair[0]) < place(pair[1])));
    assert!(place("glass") < place("texture-triangle") && place("texture-sphere") < place("oversampling"));
}

#[test]
fn a_right_picture_has_all_points_whatever_the_tolerance() {
    let suite = ready_suite();
    for (test, case) in cases(&suite) {
        let picture = stored(&case.truth, suite.format);
        let score = score(&case, &picture, test, &suite.credit).expect("the same size");
        assert_eq!(
            (score.verdict, score.credit),
            (Verdict::Right, 1.0),
            "{}: {:?}",
            test.name,
            score.reasons
        );
        let blank = Image::new(picture.width(), picture.height(), picture.channels()).expect("a picture");
        let blank = self::score(&case, &blank, test, &suite.credit).expect("the same size");
        assert!(blank.credit < 0.1, "{}: a black picture has {}", test.name, blank.credit);
    }
}

/// A program that has no shadows, mirrors or glass yet has all points of the lessons before them, and one that has
/// everything has them too.
#[test]
fn lessons_do_not_need_what_comes_later() {
    let suite = ready_suite();
    let later = [("shadow-dir", "no-shadows"), ("mirror", "no-reflection"), ("glass", "no-refraction")];
    for (first, variant) in later {
        let change = &VARIANTS.iter().find(|other| other.name == variant).expect("a variant").change;
        for (test, case) in cases(&suite).into_iter().take_while(|(test, _)| test.name != first) {
            let picture = case.variant(change).expect("a picture");
            let score = score(&case, &picture, test, &suite.credit).expect("the same size");
            assert_eq!(score.verdict, Verdict::Right, "{} needs {variant}: {:?}", test.name, score.reasons);
        }
    }
}

/// The tracer of the glass variants differs from the renderer in the bending alone: bent rightly, its picture is the
/// renderer's.
#[test]
fn glass_that_is_bent_rightly_is_the_truth() {
    let right: Bend = |at| {
        let (normal, eta) = if at.entering { (at.outward, 1.0 / at.index) } else { (-at.outward, at.index) };
        snell(at.direction, normal, eta)
    };
    let suite = small_suite();
    let mut compared = 0;
    for (test, case) in cases(&suite) {
        if let Ok(picture) = case.variant(&Change::Bend(right)) {
            let figures = compare(&picture, &case.truth, 0.5 / 255.0).expect("the same size");
            assert!(figures.pixels_over <= 5, "{}: {}", test.name, figures.pixels_over);
            compared += 1;
        }
    }
    assert!(compared >= 4, "{compared}");
}

type Pictures = Vec<(&'static Variant, Image)>;

/// The lessons in which a picture loses points, and what is named there.
fn lessons(
    suite: &Suite,
    cases: &[(&Test, Case, Pictures)],
    picture: impl Fn(&Case, &Pictures) -> Option<Image>,
) -> Vec<(String, Vec<&'static str>)> {
    let mut lessons = Vec::new();
    for (test, case, telling) in cases {
        let Some(picture) = picture(case, telling) else { continue };
        let picture = stored(&picture, suite.format);
        let Ok(score) = score(case, &picture, test, &suite.credit) else { continue };
        if score.verdict != Verdict::Right {
            let names = hints_among(telling, case, &picture, test).iter().map(|hint| hint.name).collect();
            lessons.push((test.name.clone(), names));
        }
    }
    lessons
}

/// The truth with every third point in its own shadow, here and there.
fn speckled(case: &Case) -> Image {
    let dark = case.variant(&Change::Resolved(|resolved, _| resolved.lights.clear())).expect("a picture");
    let mut picture = case.truth.clone();
    let mut state = 1_u32;
    for (y, x) in (0..dark.height()).flat_map(|y| (0..dark.width()).map(move |x| (y, x))) {
        state = state.wrapping_mul(1_664_525).wrapping_add(1_013_904_223);
        if state >> 24 < 80 {
            picture.set_pixel(x, y, dark.pixel(x, y).expect("the same size"));
        }
    }
    picture
}

fn with_telling((test, case): (&Test, Case)) -> (&Test, Case, Pictures) {
    let telling = telling(&case, test);
    (test, case, telling)
}

#[test]
fn every_variant_is_named_in_some_lesson() {
    let suite = small_suite();
    let cases: Vec<(&Test, Case, Pictures)> = cases(&suite).into_iter().map(with_telling).collect();
    let mut unnamed = Vec::new();
    for variant in VARIANTS {
        let of_variant = |telling: &Pictures| {
            telling.iter().find(|(other, _)| other.name == variant.name).map(|(_, picture)| picture.clone())
        };
        let lessons = match variant.change {
            Change::Speckles => lessons(&suite, &cases, |case, _| Some(speckled(case))),
            Change::Scene(_)
            | Change::Resolved(_)
            | Change::Options(_)
            | Change::Texture(_)
            | Change::Bend(_)
            | Change::Picture(_) => lessons(&suite, &cases, |_, telling| of_variant(telling)),
        };
        let first = lessons.iter().filter(|(_, names)| names.first() == Some(&variant.name)).count();
        let among = lessons.iter().filter(|(_, names)| names.contains(&variant.name)).count();
        let (name, all) = (variant.name, lessons.len());
        println!("{name:<24} loses points in {all:>2} lessons, named in {among:>2}, first in {first:>2}");
        if first == 0 {
            unnamed.push(format!("{name}: {lessons:?}"));
        }
    }
    assert!(unnamed.is_empty(), "never named first:\n{}", unnamed.join("\n"));
}

#[test]
fn pictures_that_are_merely_wrong_have_no_hint() {
    let suite = small_suite();
    let mut hinted = Vec::new();
    for (test, case) in cases(&suite) {
        // A cross over the middle is no common fault.
        let mut picture = case.truth.clone();
        let (width, height) = (picture.width(), picture.height());
        for (y, x) in (0..height).flat_map(|y| (0..width).map(move |x| (y, x))) {
            let pixel = [(x * 7 % 11) as f32 / 11.0, (y * 5 % 13) as f32 / 13.0, 0.5, 1.0];
            if (x * height).abs_diff(y * width) < 10 * width || x.abs_diff(width / 2) < 10 {
                picture.set_pixel(x, y, pixel);
            }
        }
        assert!(compare(&picture, &case.truth, 0.1).expect("the same size").pixels_over > 500);
        hinted.extend(hints(&case, &picture, test).into_iter().map(|hint| (test.name.clone(), hint)));
    }
    assert!(hinted.is_empty(), "{hinted:?}");
}

/// The page for teachers shows a suite that can be read and the numbers that count.
#[test]
fn the_page_tells_the_truth() {
    let path = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../docs/grading.md");
    let page = std::fs::read_to_string(path).expect("the page").replace("\r\n", "\n");
    let example =
        page.split("```toml\n").nth(1).and_then(|rest| rest.split("```").next()).expect("an example");
    let example = Suite::parse(example, Path::new("")).unwrap_or_else(|error| panic!("{error}"));
    assert_eq!((example.tests.len(), example.points()), (2, 3.0));
    assert_eq!(example.tests[1].allowance.flip, 0.1);
    let count = format!("the ready suite: {} scenes", ready_suite().tests.len());
    assert!(page.contains(&count), "the page does not say `{count}`");
    for profile in Profile::ALL {
        let allowed = profile.allowance();
        let (share, flip) = match profile {
            Profile::Exact => ("all".to_owned(), "any".to_owned()),
            Profile::Strict => (format!("{} %", 100.0 * allowed.share), "any".to_owned()),
            Profile::Lenient => (format!("{} %", 100.0 * allowed.share), allowed.flip.to_string()),
        };
        let row = format!("| `{}` | {}/255 | {share} |", profile.name(), 255.0 * allowed.tolerance);
        let line = page.lines().find(|line| line.starts_with(&row));
        assert!(line.is_some_and(|line| line.ends_with(&format!("| {flip} |"))), "no row {row} … {flip}");
    }
}

//! `dotray compare`: how far two pictures are apart.

use dotray::image::EncodeOptions;
use dotray::image::Format;
use dotray::image::Image;
use dotray::image::Limits;
use dotray::image::compare::difference_picture;
use dotray::image::compare::profile::Allowance;
use dotray::image::compare::profile::Report;
use dotray::image::decode;
use dotray::image::encode;
use dotray::scene::Files;
use dotray::scene::files::Disk;
use serde_json::Value;
use serde_json::json;
use std::fmt::Write;
use std::path::Path;

use crate::exit::Failure;
use crate::exit::put;
use crate::judge_args::CompareArgs;
use crate::meaning;
use crate::meaning::Place;
use crate::output;
use crate::values::TextOrJson;

/// Prints the figures; [`Failure::Over`] where the profile does not forgive them.
pub fn run(typed: &CompareArgs) -> Result<(), Failure> {
    let profile = meaning::profile(typed.profile);
    let mut allowed = profile.allowance();
    allowed.tolerance = typed.tolerance.unwrap_or(allowed.tolerance);
    let pictures = [&typed.picture, &typed.flip_picture].map(|path| path.as_deref().map(wanted).transpose());
    let [three_parts, flip_picture] = pictures;
    let (three_parts, flip_picture) = (three_parts?, flip_picture?);

    let (mut a, float_a) = read(&typed.a)?;
    let (mut b, float_b) = read(&typed.b)?;
    if float_a != float_b {
        [&mut a, &mut b].into_iter().for_each(clamp);
    }
    let report = Report::new(&a, &b, allowed.tolerance)?;
    if let Some(wanted) = three_parts {
        write(&difference_picture(&a, &b)?, &wanted)?;
    }
    if let Some(wanted) = flip_picture {
        write(&report.flip.picture(a.width())?, &wanted)?;
    }
    let excesses = report.excesses(&allowed);
    let size = (a.width(), a.height());
    let text = match typed.format {
        TextOrJson::Text => text(size, &report, &allowed, profile.name(), &excesses),
        TextOrJson::Json => {
            format!("{:#}\n", value(size, &report, &allowed, profile.name(), &excesses))
        }
    };
    put(text.as_bytes())?;
    if excesses.is_empty() { Ok(()) } else { Err(Failure::Over) }
}

/// A picture to be written: its place and format, looked at before any work is done.
fn wanted(path: &Path) -> Result<(Place, Format), Failure> {
    let format = Format::from_path(path).map_err(|error| Failure::Usage(error.to_string()))?;
    let place = Place::File(path.to_owned());
    output::check(&place, &Place::Standard)?;
    Ok((place, format))
}

fn write(image: &Image, (place, format): &(Place, Format)) -> Result<(), Failure> {
    output::write(place, &encode(image, *format, &EncodeOptions::default())?)
}

/// A picture and whether its file holds floats.
fn read(path: &Path) -> Result<(Image, bool), Failure> {
    let limits = Limits::default();
    let bytes =
        Disk.read_asked_for(path, limits.max_bytes).map_err(|error| Failure::file("read", path, &error))?;
    let hint = Format::from_path(path).ok();
    let image = decode(&bytes, hint, &limits).map_err(|error| Failure::file("read", path, &error))?;
    Ok((image, Format::sniff(&bytes).or(hint).is_some_and(Format::is_float)))
}

/// What a format of whole numbers does to samples; what is no number stays, for it is a fault.
fn clamp(image: &mut Image) {
    image.samples_mut().iter_mut().for_each(|sample| *sample = sample.clamp(0.0, 1.0));
}

fn text(
    (width, height): (usize, usize),
    report: &Report,
    allowed: &Allowance,
    profile: &str,
    excesses: &[String],
) -> String {
    let figures = &report.figures;
    let steps = |value: f64| format!("{value:<12.6} {:.3}/255", 255.0 * value);
    let at = |(x, y): (usize, usize)| format!("at {x},{y}");
    let mut text = String::new();
    // Writing to a string does not fail.
    let mut row = |name: &str, value: String| {
        let _ = writeln!(text, "{name:<13}{}", value.trim_end());
    };
    row("size", format!("{width} x {height}"));
    row("mean", steps(figures.mean));
    row("max", format!("{} {}", steps(figures.max), at(figures.max_at)));
    row("RMSE", steps(figures.rmse));
    row("PSNR", format!("{:.2} dB", figures.psnr));
    row("SSIM", format!("{:.6}     of the luma", report.ssim));
    row("FLIP", format!("{:<12.6} mean, at most {:.6}", report.flip.mean, report.flip.max));
    row("block", format!("{} {}, 8x8 pixels", steps(report.block.difference), at(report.block.at)));
    let share = 100.0 * figures.pixels_over as f64 / figures.pixels as f64;
    row(
        "pixels over",
        format!(
            "{} of {} ({share:.3} %) by more than {:.3}/255",
            figures.pixels_over,
            figures.pixels,
            255.0 * allowed.tolerance
        ),
    );
    row("", String::new());
    row("difference", format!("{:>12}{:>12}{:>12}", "red", "green", "blue"));
    for bin in &report.histogram {
        let [red, green, blue] = bin.counts;
        row(&bin_name(bin.from, bin.to), format!("{red:>12}{green:>12}{blue:>12}"));
    }
    row("", String::new());
    if excesses.is_empty() {
        row("within", profile.to_owned());
    }
    for excess in excesses {
        row(&format!("over {profile}"), excess.clone());
    }
    text
}

fn bin_name(from: u32, to: Option<u32>) -> String {
    match to {
        Some(to) if to == from => format!("{to}/255"),
        Some(to) => format!("{from}-{to}/255"),
        None => format!("{from}-/255"),
    }
}

/// The object of `--format json`; docs/grading.md lists its keys.
fn value(
    (width, height): (usize, usize),
    report: &Report,
    allowed: &Allowance,
    profile: &str,
    excesses: &[String],
) -> Value {
    let figures = &report.figures;
    let bin = |bin: &dotray::image::compare::histogram::Bin| {
        let [red, green, blue] = bin.counts;
        json!({ "from": bin.from, "to": bin.to, "red": red, "green": green, "blue": blue })
    };
    json!({
        "width": width,
        "height": height,
        "mean": figures.mean,
        "max": figures.max,
        "max_at": [figures.max_at.0, figures.max_at.1],
        "rmse": figures.rmse,
        "psnr": figures.psnr,
        "ssim": report.ssim,
        "flip": { "mean": report.flip.mean, "max": report.flip.max },
        "block": { "difference": report.block.difference, "at": [report.block.at.0, report.block.at.1] },
        "tolerance": allowed.tolerance,
        "pixels": figures.pixels,
        "pixels_over": figures.pixels_over,
        "histogram": report.histogram.iter().map(bin).collect::<Vec<_>>(),
        "profile": profile,
        "within": excesses.is_empty(),
        "excesses": excesses,
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn bins_have_names() {
        let names = [(0, Some(0)), (3, Some(4)), (129, None)].map(|(from, to)| bin_name(from, to));
        assert_eq!(names, ["0/255", "3-4/255", "129-/255"]);
    }
}

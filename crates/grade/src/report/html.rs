//! One page for a browser that needs nothing else: pictures side by side, their difference, and a flicker control.

use dotray_image::EncodeOptions;
use dotray_image::Format;
use dotray_image::Image;
use dotray_image::compare::difference_picture;
use dotray_image::encode;
use std::fmt::Write;

use crate::grade::Outcome;
use crate::report::Report;
use crate::report::escaped;
use crate::report::points;
use crate::report::told;
use crate::score::Verdict;
use crate::suite::Test;

const STYLE: &str = include_str!("page.css");
const SCRIPT: &str = include_str!("page.js");

/// The page.
pub fn page(report: &Report) -> String {
    let title = escaped(&report.suite.title);
    let sum = format!("{} of {} points", points(report.points()), points(report.suite.points()));
    let mut page = format!(
        "<!DOCTYPE html>\n<html lang=\"en\">\n<head>\n<meta charset=\"utf-8\">\n\
         <meta name=\"viewport\" content=\"width=device-width\">\n<title>{title}: {sum}</title>\n\
         <style>\n{STYLE}</style>\n</head>\n<body>\n<header>\n<h1>{title}</h1>\n\
         <p><strong>{sum}</strong> in {:.1} s, <code>{}</code></p>\n\
         <p class=\"controls\"><label>Pictures <input id=\"zoom\" type=\"range\" min=\"1\" max=\"4\" step=\"0.5\" \
         value=\"1.5\"> larger</label> <label>Flicker every <input id=\"pace\" type=\"range\" min=\"100\" \
         max=\"1500\" step=\"50\" value=\"400\"> <output id=\"shown-pace\">400</output> ms</label> \
         <label><input id=\"lost\" type=\"checkbox\"> only tests that lost points</label></p>\n</header>\n",
        report.seconds,
        escaped(report.program)
    );
    page.push_str("<nav><ol>\n");
    for (test, outcome) in report.rows() {
        let (name, class) = (escaped(&test.name), class(outcome.verdict));
        // Writing to a string does not fail.
        let _ = writeln!(
            page,
            "<li class=\"{class}\"><a href=\"#{name}\">{name}</a> {}/{}</li>",
            points(outcome.points),
            points(test.points)
        );
    }
    page.push_str("</ol></nav>\n<main>\n");
    report.rows().for_each(|(test, outcome)| section(test, outcome, &mut page));
    let _ = write!(page, "</main>\n<script>\n{SCRIPT}</script>\n</body>\n</html>\n");
    page
}

fn class(verdict: Verdict) -> &'static str {
    match verdict {
        Verdict::Right => "right",
        Verdict::Close => "close",
        Verdict::Partly => "partly",
        Verdict::Wrong => "wrong",
        Verdict::NoPicture => "none",
    }
}

fn section(test: &Test, outcome: &Outcome, page: &mut String) {
    let lost = if outcome.points < test.points { " lost" } else { "" };
    let _ = writeln!(
        page,
        "<section id=\"{}\" class=\"{}{lost}\">\n<h2>{} <small>{} of {} points, {}, {:.2} s</small></h2>",
        escaped(&test.name),
        class(outcome.verdict),
        escaped(&test.title),
        points(outcome.points),
        points(test.points),
        outcome.verdict.name(),
        outcome.seconds
    );
    let told = told(test, outcome);
    if !told.is_empty() {
        let items: String = told.iter().map(|line| format!("<li>{}</li>\n", escaped(line))).collect();
        let _ = writeln!(page, "<ul class=\"told\">\n{items}</ul>");
    }
    pictures(outcome, page);
    if let Some(score) = &outcome.score {
        let (report, figures) = (&score.report, &score.report.figures);
        let _ = writeln!(
            page,
            "<p class=\"figures\">mean {:.3}/255, max {:.1}/255 at {},{}, SSIM {:.4}, FLIP {:.4}, \
             {} of {} pixels over, {:.1} % of what is seen agrees</p>",
            255.0 * figures.mean,
            255.0 * figures.max,
            figures.max_at.0,
            figures.max_at.1,
            report.ssim,
            report.flip.mean,
            figures.pixels_over,
            figures.pixels,
            100.0 * score.share
        );
    }
    let _ =
        writeln!(page, "<details><summary>Command and output</summary><pre>{}", escaped(&outcome.command));
    for (name, text) in [("Standard output", &outcome.stdout), ("Standard error", &outcome.stderr)] {
        if !text.trim().is_empty() {
            let _ = write!(page, "\n\n{name}:\n{}", escaped(text.trim_end()));
        }
    }
    page.push_str("</pre></details>\n</section>\n");
}

fn pictures(outcome: &Outcome, page: &mut String) {
    let truth = source(&outcome.truth);
    let mut figure = |class: &str, caption: &str, content: String| {
        let _ =
            writeln!(page, "<figure class=\"{class}\">{content}<figcaption>{caption}</figcaption></figure>");
    };
    let img = |source: &str, text: &str| format!("<img src=\"{source}\" alt=\"{text}\">");
    let Some(picture) = &outcome.picture else {
        figure("", "wanted", img(&truth, "wanted"));
        return;
    };
    let yours = source(picture);
    figure("", "yours", img(&yours, "yours"));
    if outcome.score.is_some()
        && let Ok(parts) = difference_picture(&outcome.truth, picture)
        && let Some(middle) = parts.crop(picture.width(), 0, picture.width(), picture.height())
    {
        figure("", "difference, eight times", img(&source(&middle), "difference"));
    }
    figure("", "wanted", img(&truth, "wanted"));
    let both = img(&yours, "yours") + &img(&truth, "wanted");
    figure(
        "flicker",
        "<button type=\"button\">flicker</button> <span>yours</span>",
        format!("<div tabindex=\"0\" title=\"click: flicker; hover or hold: wanted\">{both}</div>"),
    );
}

/// A picture within the page: PNG, or BMP where this build has no PNG.
fn source(image: &Image) -> String {
    let (format, name) = if Format::Png.is_built() { (Format::Png, "png") } else { (Format::Bmp, "bmp") };
    let bytes = encode(image, format, &EncodeOptions::default()).unwrap_or_default();
    format!("data:image/{name};base64,{}", base64(&bytes))
}

/// RFC 4648, section 4.
fn base64(bytes: &[u8]) -> String {
    const DIGITS: &[u8; 64] = b"ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
    let mut text = String::with_capacity(bytes.len().div_ceil(3) * 4);
    for chunk in bytes.chunks(3) {
        let bits =
            chunk.iter().fold(0_u32, |bits, byte| bits << 8 | u32::from(*byte)) << (8 * (3 - chunk.len()));
        for place in 0..4 {
            let digit = DIGITS.get((bits >> (18 - 6 * place)) as usize & 63).copied().unwrap_or(b'=');
            text.push(if place <= chunk.len() { char::from(digit) } else { '=' });
        }
    }
    text
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn base64_is_that_of_the_standard() {
        for (bytes, text) in [
            ("", ""),
            ("f", "Zg=="),
            ("fo", "Zm8="),
            ("foo", "Zm9v"),
            ("foob", "Zm9vYg=="),
            ("fooba", "Zm9vYmE="),
        ] {
            assert_eq!(base64(bytes.as_bytes()), text);
        }
    }
}

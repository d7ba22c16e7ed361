//! JSON: our own, and that which Gradescope reads.

use serde_json::Value;
use serde_json::json;

use crate::report::Report;
use crate::report::points;
use crate::report::told;
use crate::score::Verdict;

/// Everything but the pictures; docs/grading.md lists the keys.
pub fn own(report: &Report) -> Value {
    let tests = report.rows().map(|(test, outcome)| {
        let figures = outcome.score.as_ref().map(|score| {
            let report = &score.report;
            json!({
                "mean": report.figures.mean,
                "max": report.figures.max,
                "rmse": report.figures.rmse,
                "psnr": report.figures.psnr,
                "ssim": report.ssim,
                "flip": report.flip.mean,
                "block": report.block.difference,
                "pixels_over": report.figures.pixels_over,
                "pixels": report.figures.pixels,
                "share_of_content": score.share,
            })
        });
        let hints = outcome
            .hints
            .iter()
            .map(|hint| json!({ "name": hint.name, "text": hint.text, "distance": hint.distance }));
        json!({
            "name": test.name,
            "title": test.title,
            "verdict": outcome.verdict.name(),
            "points": outcome.points,
            "max_points": test.points,
            "seconds": outcome.seconds,
            "command": outcome.command,
            "reasons": outcome.reasons,
            "hints": hints.collect::<Vec<_>>(),
            "figures": figures,
            "stdout": outcome.stdout,
            "stderr": outcome.stderr,
        })
    });
    json!({
        "suite": report.suite.title,
        "program": report.program,
        "points": report.points(),
        "max_points": report.suite.points(),
        "seconds": report.seconds,
        "tests": tests.collect::<Vec<_>>(),
    })
}

/// Gradescope's results.json: <https://gradescope-autograders.readthedocs.io/en/latest/specs/>.
pub fn gradescope(report: &Report) -> Value {
    let tests = report.rows().enumerate().map(|(place, (test, outcome))| {
        let mut lines = vec![format!("{} ({:.2} s)", outcome.verdict.name(), outcome.seconds)];
        lines.extend(told(test, outcome));
        if outcome.verdict == Verdict::NoPicture && !outcome.stderr.trim().is_empty() {
            lines.push(format!("Standard error:\n{}", outcome.stderr.trim_end()));
        }
        json!({
            "score": outcome.points,
            "max_score": test.points,
            "status": if outcome.points >= test.points { "passed" } else { "failed" },
            "name": test.title,
            "name_format": "text",
            "number": format!("{}", place + 1),
            "output": lines.join("\n"),
            "output_format": "text",
            "tags": [test.name],
            "visibility": "visible",
        })
    });
    let sum = format!("{} of {} points", points(report.points()), points(report.suite.points()));
    json!({
        "score": report.points(),
        "execution_time": report.seconds,
        "output": format!("{}: {sum}", report.suite.title),
        "output_format": "text",
        "visibility": "visible",
        "stdout_visibility": "hidden",
        "tests": tests.collect::<Vec<_>>(),
    })
}

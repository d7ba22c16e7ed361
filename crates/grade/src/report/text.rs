//! A table for a terminal.

use std::fmt::Write;

use crate::grade::Outcome;
use crate::report::Report;
use crate::report::points;
use crate::report::told;
use crate::suite::Test;

/// One line for a test that is finished.
pub fn line(test: &Test, outcome: &Outcome) -> String {
    let reached = format!("{}/{}", points(outcome.points), points(test.points));
    let figures = outcome.score.as_ref().map_or_else(String::new, |score| {
        let figures = &score.report;
        format!("FLIP {:.4}, mean {:.2}/255", figures.flip.mean, 255.0 * figures.figures.mean)
    });
    let line = format!(
        "{:<24} {:<11}{reached:>9}{:>8.2} s  {figures}",
        test.name,
        outcome.verdict.name(),
        outcome.seconds
    );
    line.trim_end().to_owned()
}

/// The whole table: a line a test, below it what was found, and the sum.
pub fn table(report: &Report) -> String {
    let mut text = String::new();
    // Writing to a string does not fail.
    let _ = writeln!(text, "{}\n", report.suite.title);
    for (test, outcome) in report.rows() {
        let _ = writeln!(text, "{}", line(test, outcome));
        for told in told(test, outcome) {
            let _ = writeln!(text, "    {}", told.replace('\n', "\n    "));
        }
    }
    let all = report.suite.tests.len();
    let right = report.rows().filter(|(test, outcome)| outcome.points >= test.points).count();
    let _ = writeln!(
        text,
        "\n{} of {} points, {right} of {all} tests right, {:.1} s",
        points(report.points()),
        points(report.suite.points()),
        report.seconds
    );
    text
}

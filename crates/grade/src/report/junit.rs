//! JUnit XML, as continuous integration reads it.

use std::fmt::Write;

use crate::report::Report;
use crate::report::escaped;
use crate::report::points;
use crate::report::told;
use crate::score::Verdict;

/// One suite, one case a test: a failure where points are missing, an error where there is no picture.
pub fn xml(report: &Report) -> String {
    let short = |verdict: &Verdict| *verdict == Verdict::NoPicture;
    let lost = report.rows().filter(|(test, outcome)| outcome.points < test.points);
    let (errors, failures): (Vec<_>, Vec<_>) = lost.partition(|(_, outcome)| short(&outcome.verdict));
    let title = escaped(&report.suite.title);
    let counts = format!(
        "tests=\"{}\" failures=\"{}\" errors=\"{}\" time=\"{:.3}\"",
        report.outcomes.len(),
        failures.len(),
        errors.len(),
        report.seconds
    );
    let mut xml = "<?xml version=\"1.0\" encoding=\"UTF-8\"?>\n".to_owned();
    // Writing to a string does not fail.
    let _ = writeln!(xml, "<testsuites name=\"{title}\" {counts}>\n  <testsuite name=\"{title}\" {counts}>");
    for (test, outcome) in report.rows() {
        let _ = writeln!(
            xml,
            "    <testcase classname=\"{title}\" name=\"{}\" time=\"{:.3}\">",
            escaped(&test.name),
            outcome.seconds
        );
        let (reached, most) = (points(outcome.points), points(test.points));
        let _ = writeln!(
            xml,
            "      <properties>\n        <property name=\"points\" value=\"{reached}\"/>\n        \
             <property name=\"max_points\" value=\"{most}\"/>\n      </properties>"
        );
        if outcome.points < test.points {
            let tag = if short(&outcome.verdict) { "error" } else { "failure" };
            let _ = writeln!(
                xml,
                "      <{tag} type=\"{}\" message=\"{reached} of {most} points\">{}</{tag}>",
                outcome.verdict.name(),
                escaped(&told(test, outcome).join("\n"))
            );
        }
        for (tag, text) in [("system-out", &outcome.stdout), ("system-err", &outcome.stderr)] {
            if !text.is_empty() {
                let _ = writeln!(xml, "      <{tag}>{}</{tag}>", escaped(text));
            }
        }
        xml.push_str("    </testcase>\n");
    }
    xml.push_str("  </testsuite>\n</testsuites>\n");
    xml
}

//! Workflow commands: GitHub shows them beside the lines of a change.

use std::fmt::Write;

use super::Finding;
use super::Region;
use super::Report;
use super::severity_name;

/// One command a message.
pub fn github(report: &Report) -> String {
    report.findings.iter().map(command).collect()
}

fn command(finding: &Finding) -> String {
    let mut command =
        format!("::{} file={}", severity_name(finding.severity), property(&finding.location.file));
    if let Some(Region { start, end }) = finding.location.region {
        // Writing to a string cannot fail.
        let _ = write!(command, ",line={},col={}", start.line, start.column);
        // The end of a place over several lines would be taken for one in the first.
        if start.line == end.line {
            let _ = write!(command, ",endLine={},endColumn={}", end.line, end.column);
        }
    }
    let _ = writeln!(command, ",title={}::{}", property(finding.code), data(&finding.in_words()));
    command
}

/// What may stand behind the second `::`.
fn data(text: &str) -> String {
    text.replace('%', "%25").replace('\r', "%0D").replace('\n', "%0A")
}

/// What may stand behind a `=`.
fn property(text: &str) -> String {
    data(text).replace(':', "%3A").replace(',', "%2C")
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn signs_with_a_meaning_are_escaped() {
        assert_eq!(data("100% a,b:c\r\nd"), "100%25 a,b:c%0D%0Ad");
        assert_eq!(property("a,b:c%d\n"), "a%2Cb%3Ac%25d%0A");
    }
}

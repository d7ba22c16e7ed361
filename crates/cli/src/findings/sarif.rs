//! A log of the Static Analysis Results Interchange Format, 2.1.0.

use dotray::scene::codes::Code;
use dotray::scene::codes::all_codes;
use dotray::scene::codes::explanation;
use serde_json::Value;
use serde_json::json;
use std::fmt::Write;

use super::Finding;
use super::Location;
use super::Report;
use super::severity_name;

const SCHEMA: &str =
    "https://docs.oasis-open.org/sarif/sarif/v2.1.0/errata01/os/schemas/sarif-schema-2.1.0.json";

/// The report as one run of one tool, with a line end.
pub fn sarif(report: &Report) -> String {
    let codes = all_codes();
    let results: Vec<Value> = report.findings.iter().map(|finding| result(finding, &codes)).collect();
    let log = json!({
        "$schema": SCHEMA,
        "version": "2.1.0",
        "runs": [{
            "tool": { "driver": {
                "name": "dotray",
                "version": env!("CARGO_PKG_VERSION"),
                "semanticVersion": env!("CARGO_PKG_VERSION"),
                "informationUri": env!("CARGO_PKG_REPOSITORY"),
                "rules": codes.iter().map(rule).collect::<Vec<_>>(),
            }},
            "columnKind": "unicodeCodePoints",
            "results": results,
        }],
    });
    format!("{log:#}\n")
}

fn rule(code: &Code) -> Value {
    let text = explanation(code.name).map_or(code.meaning, |explanation| explanation.text);
    json!({
        "id": code.name,
        "shortDescription": { "text": code.meaning },
        "fullDescription": { "text": text },
        "defaultConfiguration": { "level": severity_name(code.severity) },
    })
}

fn result(finding: &Finding, codes: &[Code]) -> Value {
    let mut result = json!({
        "ruleId": finding.code,
        "level": severity_name(finding.severity),
        "message": { "text": finding.in_words() },
        "locations": [{ "physicalLocation": physical(&finding.location) }],
    });
    let related: Vec<Value> = finding
        .notes
        .iter()
        .filter_map(|note| Some((note, note.location.as_ref()?)))
        .zip(0..)
        .map(|((note, location), id)| {
            json!({ "id": id, "message": { "text": note.message }, "physicalLocation": physical(location) })
        })
        .collect();
    if let Some(object) = result.as_object_mut() {
        if let Some(index) = codes.iter().position(|code| code.name == finding.code) {
            object.insert("ruleIndex".to_owned(), index.into());
        }
        if !related.is_empty() {
            object.insert("relatedLocations".to_owned(), related.into());
        }
    }
    result
}

fn physical(location: &Location) -> Value {
    let artifact = json!({ "uri": uri(&location.file) });
    match location.region {
        None => json!({ "artifactLocation": artifact }),
        Some(region) => json!({
            "artifactLocation": artifact,
            "region": {
                "startLine": region.start.line,
                "startColumn": region.start.column,
                "endLine": region.end.line,
                "endColumn": region.end.column,
            },
        }),
    }
}

/// A path as a URI: relative ones stay relative.
fn uri(path: &str) -> String {
    let path = if cfg!(windows) { path.replace('\\', "/") } else { path.to_owned() };
    let mut uri = String::new();
    if path.starts_with('/') {
        uri.push_str("file://");
    } else if path.get(1..3) == Some(":/") {
        uri.push_str("file:///");
    } else if path.split('/').next().is_some_and(|first| first.contains(':')) {
        // What stands before a colon would be taken for a scheme.
        uri.push_str("./");
    }
    let has_drive = uri == "file:///";
    for (place, byte) in path.bytes().enumerate() {
        if byte.is_ascii_alphanumeric() || b"-._~/".contains(&byte) || (has_drive && place == 1) {
            uri.push(char::from(byte));
        } else {
            // Writing to a string cannot fail.
            let _ = write!(uri, "%{byte:02X}");
        }
    }
    uri
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn paths_become_uris() {
        for (path, expected) in [
            ("scenes/a b.ray", "scenes/a%20b.ray"),
            ("../ä.ray", "../%C3%A4.ray"),
            ("/a/b#c.ray", "file:///a/b%23c.ray"),
            ("C:/a.ray", "file:///C:/a.ray"),
            ("a:b.ray", "./a%3Ab.ray"),
            ("<stdin>", "%3Cstdin%3E"),
        ] {
            assert_eq!(uri(path), expected);
        }
    }
}

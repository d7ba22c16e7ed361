//! One JSON object; docs/messages.md describes its keys.

use serde_json::Map;
use serde_json::Value;
use serde_json::json;

use super::Finding;
use super::Location;
use super::Report;
use super::severity_name;

/// The report as JSON, with a line end.
pub fn json(report: &Report) -> String {
    let object = json!({
        "version": 1,
        "files": report.files,
        "errors": report.errors(),
        "warnings": report.warnings(),
        "diagnostics": report.findings.iter().map(finding).collect::<Vec<_>>(),
    });
    format!("{object:#}\n")
}

fn finding(finding: &Finding) -> Value {
    let mut object = place(Some(&finding.location));
    let notes: Vec<Value> = finding
        .notes
        .iter()
        .map(|note| {
            let mut object = place(note.location.as_ref());
            object.insert("message".to_owned(), note.message.clone().into());
            Value::Object(object)
        })
        .collect();
    let label = Some(finding.label.as_str()).filter(|label| !label.is_empty());
    for (key, value) in [
        ("severity", json!(severity_name(finding.severity))),
        ("code", json!(finding.code)),
        ("message", json!(finding.message)),
        ("label", json!(label)),
        ("notes", json!(notes)),
        ("help", json!(finding.help)),
    ] {
        object.insert(key.to_owned(), value);
    }
    Value::Object(object)
}

fn place(location: Option<&Location>) -> Map<String, Value> {
    let region = location.and_then(|location| location.region);
    [
        ("file", json!(location.map(|location| &location.file))),
        ("line", json!(region.map(|region| region.start.line))),
        ("column", json!(region.map(|region| region.start.column))),
        ("end_line", json!(region.map(|region| region.end.line))),
        ("end_column", json!(region.map(|region| region.end.column))),
    ]
    .into_iter()
    .map(|(key, value)| (key.to_owned(), value))
    .collect()
}

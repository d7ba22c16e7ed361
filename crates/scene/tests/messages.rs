//! The expected messages stand in the files of tests/messages:
//!
//!     //~ LINE:COLUMN severity[code] part of the text | another part
//!
//! `FILE:LINE:COLUMN` is a place in an included file, `-` no place. All diagnostics of a file must be expected, and all
//! expected ones must come. `//~ limit NAME VALUE` sets a limit, `//~ dialect NAME` the dialect; `//~ whole` goes on
//! after reading: the scene is resolved and looked over as `dotray check` does.

use dotray_scene::context::name_groups;
use dotray_scene::diagnostic::Diagnostic;
use dotray_scene::diagnostic::READER_CODES;
use dotray_scene::diagnostic::Severity;
use dotray_scene::dialect::Dialect;
use dotray_scene::files::Disk;
use dotray_scene::lint::LINT_CODES;
use dotray_scene::lint::lint;
use dotray_scene::load::LoadOptions;
use dotray_scene::load::Loaded;
use dotray_scene::load::load;
use dotray_scene::report::render_text;
use dotray_scene::resolve::RESOLVER_CODES;
use dotray_scene::resolve::resolve;
use dotray_scene::sources::Position;
use dotray_scene::sources::Sources;
use std::collections::BTreeSet;
use std::path::Path;
use std::path::PathBuf;

fn folder() -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/messages")
}

fn name(severity: Severity) -> &'static str {
    match severity {
        Severity::Warning => "warning",
        Severity::Error => "error",
    }
}

/// `place severity[code]`
fn head(diagnostic: &Diagnostic, sources: &Sources) -> String {
    let place = diagnostic.span.map_or("-".to_owned(), |span| {
        let Position { line, column } = sources.position(span);
        let path = sources.path(span.file);
        match span.file.0 {
            0 => format!("{line}:{column}"),
            _ => format!("{}:{line}:{column}", path.file_name().unwrap().to_string_lossy()),
        }
    });
    format!("{place} {}[{}]", name(diagnostic.severity), diagnostic.code)
}

fn body(diagnostic: &Diagnostic) -> String {
    let notes: Vec<_> = diagnostic.notes.iter().map(|(_, text)| text.as_str()).collect();
    let help = diagnostic.help.as_deref().unwrap_or_default();
    format!("{}\n{}\n{}\n{help}", diagnostic.message, diagnostic.label, notes.join("\n"))
}

struct Wanted {
    messages: Vec<Expected>,
    options: LoadOptions,
    whole: bool,
}

struct Expected {
    head: String,
    parts: Vec<String>,
}

fn expectations(text: &str) -> Wanted {
    let mut expected = Vec::new();
    let mut options = LoadOptions::default();
    let mut whole = false;
    for marker in text.lines().filter_map(|line| line.split_once("//~ ")).map(|(_, marker)| marker) {
        if let Some(name) = marker.strip_prefix("dialect ") {
            options.dialect = Some(Dialect::of_name(name.trim()).unwrap());
            continue;
        }
        if marker.trim() == "whole" {
            whole = true;
            continue;
        }
        if let Some(limit) = marker.strip_prefix("limit ") {
            let (limit, value) = limit.split_once(' ').unwrap();
            let value: u32 = value.trim().parse().unwrap();
            match limit {
                "max_shapes" => options.limits.max_shapes = value,
                "max_file_bytes" => options.limits.max_file_bytes = u64::from(value),
                "max_include_depth" => options.limits.max_include_depth = value as usize,
                "max_includes" => options.limits.max_includes = value as usize,
                "max_nesting" => options.limits.max_nesting = value as usize,
                _ => panic!("unknown limit {limit}"),
            }
            continue;
        }
        let (head, parts) = marker.split_once(']').unwrap_or_else(|| panic!("no code in {marker}"));
        let parts = parts.split(" | ").map(|part| part.trim().to_owned()).filter(|part| !part.is_empty());
        expected.push(Expected { head: format!("{head}]"), parts: parts.collect() });
    }
    Wanted { messages: expected, options, whole }
}

/// What resolving and looking over say, too.
fn go_on(loaded: Loaded) -> (Vec<Diagnostic>, Sources) {
    let Loaded { scene, mut diagnostics, sources, .. } = loaded;
    let outcome = scene.map(resolve);
    if let Some(outcome) = outcome {
        diagnostics.extend(outcome.diagnostics);
        diagnostics.extend(outcome.resolved.iter().flat_map(lint));
    }
    name_groups(&mut diagnostics, &sources);
    (diagnostics, sources)
}

/// What is wrong with the messages of one file; empty if nothing is.
fn faults(path: &Path, seen: &mut BTreeSet<&'static str>) -> String {
    let text = String::from_utf8_lossy(&std::fs::read(path).unwrap()).into_owned();
    let Wanted { messages: mut expected, options, whole } = expectations(&text);
    let loaded = load(path, &Disk, &options);
    let mut faults = String::new();
    let has_errors = loaded.diagnostics.iter().any(|diagnostic| diagnostic.severity == Severity::Error);
    if has_errors == loaded.scene.is_some() {
        faults.push_str("a scene is given exactly where there are no errors\n");
    }
    let (diagnostics, sources) = if whole { go_on(loaded) } else { (loaded.diagnostics, loaded.sources) };
    for diagnostic in &diagnostics {
        seen.insert(diagnostic.code);
        let (head, body) = (head(diagnostic, &sources), body(diagnostic));
        let place = expected.iter().position(|wanted| {
            wanted.head == head && wanted.parts.iter().all(|part| body.contains(part.as_str()))
        });
        match place {
            Some(place) => drop(expected.remove(place)),
            None => faults.push_str(&format!("unexpected: {head}\n{body}\n")),
        }
    }
    for Expected { head, parts } in expected {
        faults.push_str(&format!("missing: {head} {}\n", parts.join(" | ")));
    }
    // Rendering must work for every message that there is.
    let shown = render_text(&diagnostics, &sources, false);
    if std::env::var_os("SHOW").is_some() {
        println!("{shown}");
    }
    for diagnostic in &diagnostics {
        if !shown.contains(&format!("{}[{}]: ", name(diagnostic.severity), diagnostic.code)) {
            faults.push_str(&format!("{} is not rendered\n", diagnostic.code));
        }
    }
    faults
}

#[test]
fn all_and_only_the_expected_messages_come() {
    let mut seen = BTreeSet::new();
    let mut faulty = String::new();
    let mut paths: Vec<_> = std::fs::read_dir(folder()).unwrap().map(|entry| entry.unwrap().path()).collect();
    paths.sort();
    for path in paths.iter().filter(|path| path.extension().is_some_and(|extension| extension == "ray")) {
        let faults = faults(path, &mut seen);
        if !faults.is_empty() {
            faulty.push_str(&format!("--- {}\n{faults}", path.display()));
        }
    }
    assert!(faulty.is_empty(), "\n{faulty}");
    let lists = [READER_CODES, RESOLVER_CODES, LINT_CODES];
    let known: BTreeSet<_> = lists.into_iter().flatten().map(|(code, _, _)| *code).collect();
    assert_eq!(seen.difference(&known).collect::<Vec<_>>(), Vec::<&&str>::new(), "codes that are not listed");
    // No file can give this one.
    let never: Vec<_> = known.difference(&seen).filter(|code| **code != "broken-scene").collect();
    assert!(never.is_empty(), "codes without a file: {never:?}");
}

#[test]
fn severities_are_as_listed() {
    let mut codes: Vec<_> = READER_CODES.iter().map(|(code, _, _)| *code).collect();
    assert!(codes.is_sorted());
    codes.dedup();
    assert_eq!(codes.len(), READER_CODES.len());
}

#[test]
fn a_file_that_cannot_be_read_is_a_diagnostic() {
    let load = |name: &str| load(&folder().join(name), &Disk, &LoadOptions::default());
    let missing = load("argument-cuont.ray");
    assert!(missing.scene.is_none());
    let [error] = missing.diagnostics.as_slice() else { panic!("{:?}", missing.diagnostics) };
    assert_eq!((error.code, error.span), ("cannot-read", None));
    assert!(error.message.contains("argument-cuont.ray"), "{}", error.message);
    assert!(error.help.as_ref().unwrap().contains("argument-count.ray"));
    let folder = load("parts");
    assert_eq!(folder.diagnostics[0].code, "cannot-read");
    assert!(render_text(&folder.diagnostics, &folder.sources, true).contains("cannot read"));
}

//! Each code is explained, its example gives exactly this code, and docs/messages.md is made from both; `UPDATE=1`
//! rewrites it.

use dotray_scene::codes::Example;
use dotray_scene::codes::TEXTURE_CODES;
use dotray_scene::codes::all_codes;
use dotray_scene::codes::explain;
use dotray_scene::codes::explanation;
use dotray_scene::codes::explanations;
use dotray_scene::codes::messages_page;
use dotray_scene::diagnostic::Severity;
use dotray_scene::dialect::Dialect;
use dotray_scene::files::Files;
use dotray_scene::lint::lint;
use dotray_scene::load::LoadOptions;
use dotray_scene::load::load_text;
use dotray_scene::resolve::resolve;
use std::collections::BTreeSet;
use std::io;
use std::path::Path;

/// The files beside an example, and the example itself.
struct Beside<'a>(&'a Example);

impl Files for Beside<'_> {
    fn read(&self, path: &Path) -> io::Result<Vec<u8>> {
        let name = path.to_str().unwrap();
        match self.0.parts.iter().find(|(part, _)| *part == name) {
            Some((_, Some(content))) => Ok(content.as_bytes().to_vec()),
            Some((_, None)) => Err(io::ErrorKind::PermissionDenied.into()),
            None => Err(io::ErrorKind::NotFound.into()),
        }
    }
}

/// All codes that an example gives as `dotray check` would, but for those of textures.
fn given(example: &Example, text: &str) -> BTreeSet<&'static str> {
    let mut options = LoadOptions::default();
    if let Some((name, value)) = example.limit {
        match name {
            "dialect" => options.dialect = Dialect::ALL.get(value as usize).copied(),
            "max_errors" => options.limits.max_errors = value as usize,
            "max_file_bytes" => options.limits.max_file_bytes = u64::from(value),
            "max_includes" => options.limits.max_includes = value as usize,
            "max_nesting" => options.limits.max_nesting = value as usize,
            "max_shapes" => options.limits.max_shapes = value,
            _ => panic!("unknown limit {name}"),
        }
    }
    // From memory nothing is too large; the limit is for files.
    if text.len() as u64 > options.limits.max_file_bytes {
        return BTreeSet::from(["file-too-large"]);
    }
    let loaded = load_text("example.ray", text, &Beside(example), &options);
    let mut diagnostics = loaded.diagnostics;
    if let Some(outcome) = loaded.scene.map(resolve) {
        diagnostics.extend(outcome.diagnostics);
        diagnostics.extend(outcome.resolved.iter().flat_map(lint));
    }
    diagnostics.iter().map(|diagnostic| diagnostic.code).collect()
}

/// The example with what a whole scene has, so that nothing but the example's own message comes.
fn completed(code: &str, text: &str) -> String {
    let mut whole = text.to_owned();
    let is_incomplete = ["no-camera", "no-light", "no-shape"].contains(&code);
    for (directive, line) in [
        ("#camera", "#camera 0 0 50  0 0 -1  0 1 0  .5"),
        ("#light_", "#light_dir 1 1 1  0 0 -1"),
        ("#shape_", "#shape_sphere -1  0 0 0  1"),
    ] {
        let is_there = text.replace("#light_num", "").contains(directive);
        if !is_incomplete && !is_there {
            whole.push_str(&format!("\n{line}"));
        }
    }
    // Where the one shape is left out, another remains.
    if code == "degenerate-shape" {
        whole.push_str("\n#shape_sphere -1  0 0 0  1.5");
    }
    whole
}

#[test]
fn every_code_is_explained_and_every_explanation_is_of_a_code() {
    let codes: BTreeSet<_> = all_codes().iter().map(|code| code.name).collect();
    let explained: Vec<_> = explanations().map(|explanation| explanation.code).collect();
    let set: BTreeSet<_> = explained.iter().copied().collect();
    assert_eq!(codes, set);
    assert_eq!(explained.len(), set.len(), "a code is explained twice");
    for explanation in explanations() {
        assert!(explanation.text.len() > 60 && explanation.text.ends_with('.'), "{}", explanation.code);
        assert_eq!(explanation.example.is_none(), explanation.code == "broken-scene", "{}", explanation.code);
    }
}

#[test]
fn each_example_gives_exactly_its_code() {
    let of_textures: Vec<_> = TEXTURE_CODES.iter().map(|(code, _, _)| *code).collect();
    for explanation in explanations() {
        let Some(example) = explanation.example else { continue };
        if of_textures.contains(&explanation.code) {
            assert!(given(&example, &completed(explanation.code, example.text)).is_empty());
            continue;
        }
        let severity = all_codes().into_iter().find(|code| code.name == explanation.code).unwrap().severity;
        // After an error nothing is looked at any more that would want a whole scene.
        let text = match severity {
            Severity::Error if explanation.code != "singular-product" => example.text.to_owned(),
            Severity::Error | Severity::Warning => completed(explanation.code, example.text),
        };
        let mut given_codes = given(&example, &text);
        if explanation.code == "too-many-errors" {
            assert!(given_codes.remove("unknown-directive"));
        }
        assert_eq!(given_codes, BTreeSet::from([explanation.code]), "{text}");
        if !explanation.repaired.is_empty() {
            let text = completed(explanation.code, explanation.repaired);
            assert_eq!(given(&example, &text), BTreeSet::new(), "{}: {text}", explanation.code);
        }
    }
}

#[test]
fn a_code_is_told_in_plain_text() {
    let text = explain("half-angle").unwrap();
    assert!(
        text.starts_with("error[half-angle]: The camera's half angle does not lie between 0 and π/2.\n\n"),
        "{text}"
    );
    assert!(text.contains("\n    #camera 0 0 4  0 0 -1  0 1 0  45\n"), "{text}");
    assert!(text.lines().all(|line| line.chars().count() <= 100), "{text}");
    assert!(explain("include-cycle").unwrap().contains("and in `part.ray`:"));
    assert!(explain("half-angel").is_none());
    assert!(explanation("broken-scene").is_some());
}

#[test]
fn the_page_of_messages_is_that_of_the_tables() {
    let path = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../docs/messages.md");
    let made = messages_page();
    if std::env::var_os("UPDATE").is_some() {
        std::fs::write(&path, &made).unwrap();
    }
    let written = std::fs::read_to_string(&path).unwrap_or_default();
    assert!(written == made, "docs/messages.md is not what the tables say; UPDATE=1 rewrites it");
}

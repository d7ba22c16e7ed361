//! The editors' grammar names the directives of the table; `UPDATE=1` rewrites it.

use dotray_scene::Dialect;
use dotray_scene::directive::ArgumentKind;
use dotray_scene::directive::Spec;
use dotray_scene::directive::words_of;
use dotray_scene::procedural::parse_clauses;
use serde_json::Value;
use serde_json::json;
use std::collections::BTreeSet;
use std::path::Path;

/// The words for which `wanted` holds, without `#`, in any dialect, as alternatives.
fn alternatives(wanted: impl Fn(&Spec) -> bool) -> String {
    let all = Dialect::ALL.into_iter().flat_map(words_of).filter(|spec| wanted(spec));
    let words: BTreeSet<&str> = all.map(|spec| spec.word.trim_start_matches('#')).collect();
    words.into_iter().collect::<Vec<_>>().join("|")
}

fn names_file(spec: &Spec) -> bool {
    let mut groups = spec.forms.iter().flat_map(|form| form.arguments);
    groups.any(|group| group.kind == ArgumentKind::Name)
}

fn opens_or_closes(spec: &Spec) -> bool {
    spec.word.ends_with("_begin") || spec.word.ends_with("_end")
}

fn is_shape(spec: &Spec) -> bool {
    const SHAPES: [&str; 6] = ["#sphere", "#box", "#cylinder", "#cone", "#triangle", "#torus"];
    spec.word.starts_with("#shape_") || SHAPES.contains(&spec.word)
}

fn directive(scope: &str, wanted: impl Fn(&Spec) -> bool) -> Value {
    json!({ "name": format!("{scope}.ray"), "match": format!("(?i)(?<!\\S)#({})(?!\\S)", alternatives(wanted)) })
}

fn grammar() -> Value {
    const NUMBER: &str = "[-+]?(?:\\d+\\.?\\d*|\\.\\d+)(?:[eE][-+]?\\d+)?";
    // A line that begins with a directive ends whatever was not closed, as in the reader.
    let next_line = format!("(?i)(?=^[ \\t]*#(?:{})(?!\\S))", alternatives(|_| true));
    let clauses = ["noise", "marble", "wood", "checker", "bump"];
    for clause in clauses {
        let (known, _) = parse_clauses(clause);
        assert_eq!(known.solids.len() + known.bumps.len(), 1, "{clause}");
    }
    json!({
        "name": "ray",
        "scopeName": "source.ray",
        "fileTypes": ["ray"],
        "patterns": [
            { "name": "comment.line.double-slash.ray", "match": "(?<![^\\s!\"])//.*$" },
            { "name": "comment.block.ray", "begin": "(?<![^\\s!\"])/\\*", "end": "\\*/" },
            directive("keyword.control.import", names_file),
            directive("keyword.control", |spec| opens_or_closes(spec) && !names_file(spec)),
            directive("entity.name.function", |spec| is_shape(spec) && !opens_or_closes(spec)),
            directive("keyword.other", |spec| !names_file(spec) && !opens_or_closes(spec) && !is_shape(spec)),
            { "name": "invalid.illegal.ray", "match": "(?<!\\S)#\\S*" },
            {
                "name": "string.other.ray",
                "begin": "(?<!\\S)!",
                "end": format!("!|{next_line}"),
                "patterns": [
                    {
                        "name": "support.function.ray",
                        "match": format!("(?:(?<=[!;])|(?<=[!;]\\s))\\s*({})(?=\\s|;|!|$)", clauses.join("|")),
                    },
                    { "name": "variable.parameter.ray", "match": "(?:scale|octaves|color2?|height)(?==)" },
                    { "name": "constant.numeric.ray", "match": format!("(?<=[=,]){NUMBER}") },
                ],
            },
            { "name": "string.quoted.double.ray", "begin": "(?<!\\S)\"", "end": format!("\"|{next_line}") },
            { "name": "constant.numeric.ray", "match": format!("(?<!\\S){NUMBER}(?!\\S)") },
            { "name": "string.unquoted.ray", "match": "(?<!\\S)[^\\s#!\"]\\S*" },
        ],
    })
}

#[test]
fn the_grammar_names_the_directives_of_the_table() {
    let path =
        Path::new(env!("CARGO_MANIFEST_DIR")).join("../../editors/vscode/syntaxes/ray.tmLanguage.json");
    let made = grammar();
    if std::env::var_os("UPDATE").is_some() {
        std::fs::write(&path, format!("{made:#}\n")).unwrap();
    }
    let written = std::fs::read_to_string(&path).unwrap_or_default();
    let written: Value = serde_json::from_str(&written).unwrap_or_default();
    assert!(written == made, "the grammar is not what the table says; UPDATE=1 rewrites it");
}

/// The words by what tree-sitter's grammar makes of them.
fn sorted_words() -> Value {
    let all: BTreeSet<&str> = Dialect::ALL.into_iter().flat_map(words_of).map(|spec| spec.word).collect();
    let begins = |word: &str| word.ends_with("_begin");
    let ends =
        |word: &str| word.strip_suffix("_end").is_some_and(|stem| all.contains(&*format!("{stem}_begin")));
    let sort = |spec: &Spec| match spec.word {
        word if begins(word) => "begins",
        word if ends(word) => "ends",
        _other if names_file(spec) => "files",
        _other if is_shape(spec) => "shapes",
        _other => "settings",
    };
    let of = |wanted: &str| {
        let specs = Dialect::ALL.into_iter().flat_map(words_of).filter(|spec| sort(spec) == wanted);
        let words: BTreeSet<&str> = specs.map(|spec| spec.word.trim_start_matches('#')).collect();
        json!(words)
    };
    let sorts = ["begins", "ends", "files", "shapes", "settings"];
    Value::Object(sorts.into_iter().map(|sort| (sort.to_owned(), of(sort))).collect())
}

#[test]
fn the_grammar_for_tree_sitter_names_the_directives_of_the_table() {
    let path = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../editors/tree-sitter/directives.json");
    let made = sorted_words();
    if std::env::var_os("UPDATE").is_some() {
        std::fs::write(&path, format!("{made:#}\n")).unwrap();
    }
    let written = std::fs::read_to_string(&path).unwrap_or_default();
    let written: Value = serde_json::from_str(&written).unwrap_or_default();
    assert!(written == made, "directives.json is not what the table says; UPDATE=1 rewrites it");
    // No word is in two lists, and together they are all words.
    let lists = written.as_object().into_iter().flatten().filter_map(|(_, list)| list.as_array());
    let listed: Vec<&str> = lists.flatten().filter_map(Value::as_str).collect();
    assert_eq!(listed.len(), listed.iter().collect::<BTreeSet<_>>().len());
    assert_eq!(listed.len(), alternatives(|_| true).split('|').count());
}

#[test]
fn every_directive_is_of_one_sort() {
    for spec in Dialect::ALL.into_iter().flat_map(words_of) {
        let rest = !names_file(spec) && !opens_or_closes(spec) && !is_shape(spec);
        let sorts = [
            names_file(spec),
            opens_or_closes(spec) && !names_file(spec),
            is_shape(spec) && !opens_or_closes(spec),
            rest,
        ];
        assert_eq!(sorts.iter().filter(|sort| **sort).count(), 1, "{}", spec.word);
    }
}

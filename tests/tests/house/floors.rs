//! Inside a crate, the order of the `mod` lines is the floor order.

use super::rust::Source;
use super::rust::code_without_tests;
use super::rust::line_of;
use super::rust::sources;
use super::rust::words;

/// The modules that a crate root declares, in order.
fn modules(root: &Source) -> Vec<String> {
    let code = code_without_tests(&root.text);
    let words = words(&code);
    let mut modules = Vec::new();
    for pair in words.windows(2) {
        if pair[0].1 == "mod" && code[pair[1].0 + pair[1].1.len()..].starts_with(';') {
            modules.push(pair[1].1.to_owned());
        }
    }
    modules
}

/// The path below `src` as module names: `shape/round.rs` is `shape`, `round`.
fn module_path(below_src: &str) -> Vec<&str> {
    let mut path: Vec<&str> = below_src.trim_end_matches(".rs").split('/').collect();
    if path.last() == Some(&"mod") {
        path.pop();
    }
    path
}

/// What is wrong with one crate's sources; their paths are below its `src`.
fn faults(sources: &[Source]) -> Vec<String> {
    let mut faults = Vec::new();
    let roots: Vec<(&Source, Vec<String>)> = sources
        .iter()
        .filter(|source| ["lib.rs", "main.rs"].contains(&source.path.as_str()))
        .map(|source| (source, modules(source)))
        .collect();
    for source in sources {
        let path = module_path(&source.path);
        if path == ["lib"] || path == ["main"] || path[0] == "bin" {
            continue;
        }
        let home = roots.iter().find_map(|(_, modules)| {
            let floor = modules.iter().position(|module| module == path[0])?;
            Some((modules, floor))
        });
        match home {
            Some((modules, floor)) => file_faults(source, &path, modules, floor, &mut faults),
            None => faults.push(format!("{}: `{}` is in no crate root", source.path, path[0])),
        }
    }
    faults
}

fn file_faults(source: &Source, path: &[&str], modules: &[String], floor: usize, faults: &mut Vec<String>) {
    let code = code_without_tests(&source.text);
    let mut fault = |at: usize, what: String| {
        faults.push(format!("{}:{}: {what}", source.path, line_of(&code, at)));
    };
    for (at, word) in words(&code) {
        let after = &code[at + word.len()..];
        let Some(named) = after.strip_prefix("::") else { continue };
        let used = words(named).first().map_or("", |first| first.1);
        match word {
            "crate" if named.starts_with('{') => {
                fault(at, "a grouped `use crate::{…}` hides floors".to_owned())
            }
            "crate" => match modules.iter().position(|module| module == used) {
                Some(other) if other <= floor => {}
                Some(_) => fault(at, format!("`{}` uses `{used}`, which is listed below it", path[0])),
                None => fault(at, format!("`crate::{used}` goes by the root: name the module")),
            },
            // From the file's own module, `super` goes one module up; the first module's is the root.
            "super" if !code[..at].ends_with("super::") => {
                let mut rest = after;
                let mut levels = 1;
                while let Some(next) = rest.strip_prefix("::super") {
                    levels += 1;
                    rest = next;
                }
                if levels >= path.len() {
                    fault(at, "`super` reaches the crate root: name the module by `crate::`".to_owned());
                }
            }
            _ => {}
        }
    }
}

#[test]
fn modules_use_only_modules_listed_above_them() {
    let all = sources();
    let mut faults_of_all = Vec::new();
    let mut names: Vec<String> = all
        .iter()
        .filter_map(|source| source.path.split_once("/src/").map(|(member, _)| member.to_owned()))
        .collect();
    names.dedup();
    assert!(names.len() >= 7, "{names:?}");
    for member in names {
        let prefix = format!("{member}/src/");
        let sources: Vec<Source> = all
            .iter()
            .filter_map(|source| {
                let below = source.path.strip_prefix(&prefix)?;
                Some(Source { path: below.to_owned(), text: source.text.clone() })
            })
            .collect();
        faults_of_all.extend(faults(&sources).into_iter().map(|fault| format!("{prefix}{fault}")));
    }
    super::expect_none("floors inside crates", &faults_of_all);
}

#[test]
fn planted_faults_are_found() {
    let tree = |files: &[(&str, &str)]| -> Vec<Source> {
        files.iter().map(|&(path, text)| Source { path: path.to_owned(), text: text.to_owned() }).collect()
    };
    let of = |path: &str, text: &str| {
        let lib = "//! x\npub mod low;\nmod high;\n#[cfg(test)]\nmod tests { }\npub use high::Name;";
        let mut files = vec![("lib.rs", lib), ("low.rs", ""), ("high.rs", "")];
        files.retain(|file| file.0 != path);
        files.push((path, text));
        faults(&tree(&files))
    };
    assert_eq!(
        of("high.rs", "use crate::low::A; use crate::high::B;\n/// [`crate::Name`]\nfn f() {}"),
        [""; 0]
    );
    assert_eq!(of("low/part.rs", "use crate::low::A; use super::B;"), [""; 0]);
    assert_eq!(of("low.rs", "#[cfg(test)]\nmod tests { use crate::high::A; use super::*; }"), [""; 0]);
    for (path, text, expected) in [
        ("low.rs", "\nuse crate::high::A;", "low.rs:2: `low` uses `high`"),
        ("low/part.rs", "fn f() { crate::high::g() }", "low/part.rs:1: `low` uses `high`"),
        ("low/mod.rs", "fn f() { $crate::high::g() }", "low/mod.rs:1: `low` uses `high`"),
        ("high.rs", "use crate::Name;", "`crate::Name` goes by the root"),
        ("high.rs", "use crate::{low, Name};", "grouped"),
        ("high.rs", "use super::low;", "`super` reaches the crate root"),
        ("low/part.rs", "use super::super::high;", "`super` reaches the crate root"),
        ("lost.rs", "", "`lost` is in no crate root"),
    ] {
        let found = of(path, text);
        assert_eq!(found.len(), 1, "{text}: {found:?}");
        assert!(found[0].contains(expected), "{text}: {found:?}");
    }
}

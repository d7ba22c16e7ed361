//! Functions over 70 lines and files over 500 lines, unit tests aside, are listed here, and the numbers may only fall.

use super::rust::code_without_tests;
use super::rust::line_of;
use super::rust::sources;
use super::rust::words;

const FUNCTION_LIMIT: usize = 70;
const FILE_LIMIT: usize = 500;

/// Path, function and its number of lines.
const LONG_FUNCTIONS: &[(&str, &str, usize)] = &[];
/// Path and its number of lines.
const LONG_FILES: &[(&str, &str, usize)] = &[];

/// The functions with a body: name and number of lines, from `fn` to the closing brace.
fn functions(code: &str) -> Vec<(String, usize)> {
    let words = words(code);
    let mut functions = Vec::new();
    for pair in words.windows(2) {
        let ((start, keyword), (name_at, name)) = (pair[0], pair[1]);
        // `fn(u32)` is a type: between `fn` and a function's name there is nothing but blanks.
        if keyword != "fn" || !code[start + 2..name_at].trim().is_empty() {
            continue;
        }
        if let Some(end) = body_end(&code[name_at..]) {
            let lines = line_of(code, name_at + end) - line_of(code, start) + 1;
            functions.push((name.to_owned(), lines));
        }
    }
    functions
}

/// Where the braces that open first close; none where a semicolon comes before.
fn body_end(code: &str) -> Option<usize> {
    let (mut braces, mut others) = (0, 0);
    for (at, c) in code.char_indices() {
        match c {
            '(' | '[' => others += 1,
            ')' | ']' => others -= 1,
            '{' => braces += 1,
            '}' => braces -= 1,
            ';' if braces == 0 && others == 0 => return None,
            _ => {}
        }
        if c == '}' && braces == 0 {
            return Some(at);
        }
    }
    None
}

/// Compares what is over the limit with the list.
fn compare(over: &[(String, String, usize)], list: &[(&str, &str, usize)]) -> Vec<String> {
    let mut faults = Vec::new();
    for (path, name, lines) in over {
        match list.iter().find(|entry| entry.0 == path && entry.1 == name) {
            None => faults.push(format!("{path}: `{name}` has {lines} lines: divide it")),
            Some(entry) if *lines > entry.2 => {
                faults.push(format!("{path}: `{name}` has grown from {} to {lines} lines", entry.2));
            }
            Some(entry) if *lines < entry.2 => {
                faults.push(format!(
                    "{path}: `{name}` has shrunk to {lines} lines: lower its {} here",
                    entry.2
                ));
            }
            Some(_) => {}
        }
    }
    for (path, name, _) in list {
        if !over.iter().any(|found| found.0 == *path && found.1 == *name) {
            faults.push(format!("{path}: `{name}` is within the limit: take it off the list"));
        }
    }
    faults
}

/// The sources that count: all under a `src`.
fn counted() -> impl Iterator<Item = (String, String)> {
    sources().into_iter().filter(|source| source.path.contains("/src/")).map(|source| {
        let code = code_without_tests(&source.text);
        (source.path, code)
    })
}

#[test]
fn functions_stay_short() {
    let mut over = Vec::new();
    let mut count = 0;
    for (path, code) in counted() {
        for (name, lines) in functions(&code) {
            count += 1;
            if lines > FUNCTION_LIMIT {
                over.push((path.clone(), name, lines));
            }
        }
    }
    assert!(count > 300, "only {count} functions were found");
    super::expect_none("long functions", &compare(&over, LONG_FUNCTIONS));
}

#[test]
fn files_stay_short() {
    let mut over = Vec::new();
    for source in sources().iter().filter(|source| source.path.contains("/src/")) {
        let lines = lines_without_tests(&source.text);
        if lines > FILE_LIMIT {
            over.push((source.path.clone(), "the file".to_owned(), lines));
        }
    }
    super::expect_none("long files", &compare(&over, LONG_FILES));
}

/// The lines of a file, those of its unit tests not counted.
fn lines_without_tests(text: &str) -> usize {
    let code = super::rust::code(text);
    let without = code_without_tests(text);
    let of_tests = code.lines().zip(without.lines()).filter(|(all, rest)| all != rest).count();
    text.lines().count() - of_tests
}

#[test]
fn planted_faults_are_found() {
    let code = "fn a() {\n\n}\nimpl X {\n    fn b(f: fn(u32) -> [u8; 3])\n    where Y: Z,\n    {\n        { }\n\
        }\n    fn c();\n}";
    assert_eq!(functions(code), [("a".to_owned(), 3), ("b".to_owned(), 5)]);
    assert_eq!(lines_without_tests("a\nb\n#[cfg(test)]\nmod t {\n}\n"), 2);
    let over = |lines| vec![("p".to_owned(), "f".to_owned(), lines)];
    assert!(compare(&over(80), &[])[0].contains("divide"));
    assert!(compare(&over(80), &[("p", "f", 79)])[0].contains("grown"));
    assert!(compare(&over(80), &[("p", "f", 81)])[0].contains("shrunk"));
    assert!(compare(&[], &[("p", "f", 81)])[0].contains("off the list"));
    assert_eq!(compare(&over(80), &[("p", "f", 80)]), [""; 0]);
}

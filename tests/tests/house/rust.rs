//! Just enough reading of Rust: the tree's sources, and their code without comments, literals and unit tests.

use std::path::Path;
use std::path::PathBuf;

/// A Rust source of the tree.
pub struct Source {
    /// Relative to the repository, with `/`.
    pub path: String,
    /// All of it.
    pub text: String,
}

/// The repository's root.
pub fn root() -> PathBuf {
    dotray_tests::corpus::root()
}

/// Every Rust source of the members, in order of their paths.
pub fn sources() -> Vec<Source> {
    let mut found = Vec::new();
    for folder in ["crates", "tests", "xtask"] {
        collect(&root().join(folder), &mut found);
    }
    assert!(found.len() > 50, "the tree was not found");
    found.sort_by(|a, b| a.path.cmp(&b.path));
    found
}

fn collect(folder: &Path, found: &mut Vec<Source>) {
    for entry in std::fs::read_dir(folder).into_iter().flatten().flatten() {
        let path = entry.path();
        if path.is_dir() && path.file_name().is_some_and(|name| name != "target") {
            collect(&path, found);
        } else if path.extension().is_some_and(|extension| extension == "rs") {
            let relative = path.strip_prefix(root()).unwrap_or(&path).to_string_lossy().replace('\\', "/");
            let text = std::fs::read_to_string(&path).unwrap_or_else(|error| panic!("{relative}: {error}"));
            found.push(Source { path: relative, text });
        }
    }
}

/// The text with comments and the insides of literals blanked; every line keeps its place and length.
pub fn code(text: &str) -> String {
    let mut reader = Reader { rest: text.chars().collect(), at: 0, code: String::with_capacity(text.len()) };
    while reader.at < reader.rest.len() {
        reader.step();
    }
    reader.code
}

struct Reader {
    rest: Vec<char>,
    at: usize,
    code: String,
}

impl Reader {
    fn peek(&self, ahead: usize) -> char {
        self.rest.get(self.at + ahead).copied().unwrap_or('\0')
    }

    fn keep(&mut self, count: usize) {
        for _ in 0..count {
            self.code.push(self.peek(0));
            self.at += 1;
        }
    }

    fn blank(&mut self, count: usize) {
        for _ in 0..count {
            self.code.push(if self.peek(0) == '\n' { '\n' } else { ' ' });
            self.at += 1;
        }
    }

    fn step(&mut self) {
        let after_word = self.code.chars().next_back().is_some_and(is_word);
        match (self.peek(0), self.peek(1)) {
            ('/', '/') => {
                while self.at < self.rest.len() && self.peek(0) != '\n' {
                    self.blank(1);
                }
            }
            ('/', '*') => self.block_comment(),
            ('"', _) => self.string(),
            ('r', '"' | '#') if !after_word => self.raw_string(1),
            ('b', 'r') if !after_word && matches!(self.peek(2), '"' | '#') => self.raw_string(2),
            ('\'', '\\') => self.character(),
            ('\'', _) if self.peek(2) == '\'' => self.character(),
            (_, _) => self.keep(1),
        }
    }

    fn block_comment(&mut self) {
        let mut depth = 0;
        while self.at < self.rest.len() {
            let step = match (self.peek(0), self.peek(1)) {
                ('/', '*') => 1,
                ('*', '/') => -1,
                (_, _) => 0,
            };
            depth += step;
            self.blank(if step == 0 { 1 } else { 2 });
            if depth == 0 {
                return;
            }
        }
    }

    fn string(&mut self) {
        self.keep(1);
        while self.at < self.rest.len() && self.peek(0) != '"' {
            self.blank(if self.peek(0) == '\\' { 2 } else { 1 });
        }
        self.keep(1);
    }

    fn raw_string(&mut self, prefix: usize) {
        let signs = (prefix..).take_while(|&i| self.peek(i) == '#').count();
        if self.peek(prefix + signs) != '"' {
            return self.keep(prefix + signs);
        }
        self.keep(prefix + signs + 1);
        let closes = |reader: &Self| reader.peek(0) == '"' && (1..=signs).all(|i| reader.peek(i) == '#');
        while self.at < self.rest.len() && !closes(self) {
            self.blank(1);
        }
        self.keep(signs + 1);
    }

    fn character(&mut self) {
        self.keep(1);
        while self.at < self.rest.len() && self.peek(0) != '\'' {
            self.blank(if self.peek(0) == '\\' { 2 } else { 1 });
        }
        self.keep(1);
    }
}

/// Whether a character can stand in a name.
pub fn is_word(c: char) -> bool {
    c.is_alphanumeric() || c == '_'
}

/// [`code`] with everything under `#[cfg(test)]`, or `#[cfg(all(test, …))]`, blanked too.
pub fn code_without_tests(text: &str) -> String {
    let mut code = code(text);
    let mut from = 0;
    while let Some(start) = code[from..].find("#[cfg(").map(|found| from + found) {
        let item = start + code[start..].find(']').map_or(0, |end| end + 1);
        from = item;
        if !["#[cfg(test)]", "#[cfg(all(test,"].iter().any(|mark| code[start..].starts_with(mark)) {
            continue;
        }
        let end = item + item_length(&code[item..]);
        let blank: String = code[start..end].chars().map(|c| if c == '\n' { '\n' } else { ' ' }).collect();
        code.replace_range(start..end, &blank);
        from = start + blank.len();
    }
    code
}

/// The bytes of the item that starts here: to its closing brace, or to a semicolon before any brace.
fn item_length(code: &str) -> usize {
    let mut depth = 0_i32;
    for (at, c) in code.char_indices() {
        match c {
            '{' => depth += 1,
            '}' => depth -= 1,
            _ => {}
        }
        if depth == 0 && matches!(c, '}' | ';') {
            return at + 1;
        }
    }
    code.len()
}

/// A word with its byte place in the code.
pub fn words(code: &str) -> Vec<(usize, &str)> {
    let mut words = Vec::new();
    let mut start = None;
    for (at, c) in code.char_indices().chain([(code.len(), ' ')]) {
        match (is_word(c), start) {
            (true, None) => start = Some(at),
            (false, Some(from)) => {
                words.push((from, &code[from..at]));
                start = None;
            }
            (true, Some(_)) | (false, None) => {}
        }
    }
    words
}

/// The number of the line that holds byte `at`.
pub fn line_of(text: &str, at: usize) -> usize {
    text[..at].matches('\n').count() + 1
}

#[test]
fn comments_and_literals_are_blanked() {
    let text = "let a = \"unsafe \\\" //\"; // unsafe\n/* unsafe /* */ unsafe */ let b = 'x'; \
        let c = '\\''; r#\"a\"b\"# 'life";
    let blanked = code(text);
    assert_eq!(blanked.chars().count(), text.chars().count());
    assert!(!blanked.contains("unsafe"), "{blanked}");
    assert!(blanked.contains("let b = ' '; let c = '  '; r#\"   \"# 'life"), "{blanked}");
}

#[test]
fn unit_tests_are_blanked() {
    let of_tests = "#[cfg(test)]\nmod tests {\n fn b() { \"}\" }\n}\n#[cfg(all(test, unix))]\nmod x;\n";
    let text = format!("fn a() {{}}\n{of_tests}#[cfg(unix)]\nfn c() {{}}\n");
    let blanked = code_without_tests(&text);
    assert_eq!(blanked.lines().count(), text.lines().count());
    let left: Vec<&str> = words(&blanked).into_iter().map(|(_, word)| word).collect();
    assert_eq!(left, ["fn", "a", "cfg", "unix", "fn", "c"]);
}

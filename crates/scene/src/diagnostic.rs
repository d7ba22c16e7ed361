//! Faults and warnings as data.

use crate::span::Span;

/// How bad it is.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub enum Severity {
    /// The scene can be rendered all the same.
    Warning,
    /// It cannot.
    Error,
}

/// One message about a place in a file.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Diagnostic {
    /// Error or warning.
    pub severity: Severity,
    /// A stable name of the kind of message in kebab-case, such as `unknown-directive`.
    pub code: &'static str,
    /// One sentence: what is wrong, the value, what was expected.
    pub message: String,
    /// The place; `None` where the whole scene is meant.
    pub span: Option<Span>,
    /// Short text under the caret; may be empty.
    pub label: String,
    /// Other places that matter: the chain of includes, the group around, where something was declared.
    pub notes: Vec<(Option<Span>, String)>,
    /// What to do, where a likely repair is known.
    pub help: Option<String>,
}

impl Diagnostic {
    /// An error about the whole scene; [`Diagnostic::at`] gives it a place.
    pub fn error(code: &'static str, message: impl Into<String>) -> Self {
        Self::new(Severity::Error, code, message.into())
    }

    /// A warning about the whole scene; [`Diagnostic::at`] gives it a place.
    pub fn warning(code: &'static str, message: impl Into<String>) -> Self {
        Self::new(Severity::Warning, code, message.into())
    }

    fn new(severity: Severity, code: &'static str, message: String) -> Self {
        Self { severity, code, message, span: None, label: String::new(), notes: Vec::new(), help: None }
    }

    /// The same at a place.
    #[must_use]
    pub fn at(mut self, span: Span) -> Self {
        self.span = Some(span);
        self
    }

    /// The same with a short text under the caret.
    #[must_use]
    pub fn label(mut self, label: impl Into<String>) -> Self {
        self.label = label.into();
        self
    }

    /// The same with a further sentence.
    #[must_use]
    pub fn note(mut self, text: impl Into<String>) -> Self {
        self.notes.push((None, text.into()));
        self
    }

    /// The same with a sentence about another place.
    #[must_use]
    pub fn note_at(mut self, span: Span, text: impl Into<String>) -> Self {
        self.notes.push((Some(span), text.into()));
        self
    }

    /// The same with a likely repair.
    #[must_use]
    pub fn help(mut self, help: impl Into<String>) -> Self {
        self.help = Some(help.into());
        self
    }
}

/// Collects diagnostics and keeps their number small: after `max_errors` errors it asks the reader to stop, and of
/// each kind of warning it keeps the first few and counts the rest.
#[derive(Clone, Debug)]
pub struct Sink {
    kept: Vec<Diagnostic>,
    max_errors: usize,
    max_warnings_of_a_kind: usize,
    errors: usize,
    warnings: Vec<(&'static str, usize)>,
}

/// A state of a [`Sink`] to which it can go back.
#[derive(Clone, Debug)]
pub struct SinkMark {
    kept: usize,
    errors: usize,
    warnings: Vec<(&'static str, usize)>,
}

impl Sink {
    /// An empty one.
    pub fn new(max_errors: usize, max_warnings_of_a_kind: usize) -> Self {
        Self { kept: Vec::new(), max_errors, max_warnings_of_a_kind, errors: 0, warnings: Vec::new() }
    }

    /// Takes an error, unless there are enough.
    pub fn error(&mut self, diagnostic: Diagnostic) {
        self.errors = self.errors.saturating_add(1);
        if self.errors <= self.max_errors {
            self.kept.push(diagnostic);
        }
    }

    /// Counts a warning and makes it only where it will be shown.
    pub fn warn(&mut self, code: &'static str, make: impl FnOnce() -> Diagnostic) {
        let seen = match self.warnings.iter_mut().find(|entry| entry.0 == code) {
            Some(entry) => &mut entry.1,
            None => {
                self.warnings.push((code, 0));
                match self.warnings.last_mut() {
                    Some(entry) => &mut entry.1,
                    None => return,
                }
            }
        };
        *seen = seen.saturating_add(1);
        if *seen <= self.max_warnings_of_a_kind {
            self.kept.push(make());
        }
    }

    /// Whether more errors came than are kept: reading on is of no use.
    pub fn is_full(&self) -> bool {
        self.errors > self.max_errors
    }

    /// Whether nothing came at all.
    pub fn is_silent(&self) -> bool {
        self.errors == 0 && self.warnings.is_empty()
    }

    /// How many errors came.
    pub fn errors(&self) -> usize {
        self.errors
    }

    /// The state now.
    pub fn mark(&self) -> SinkMark {
        SinkMark { kept: self.kept.len(), errors: self.errors, warnings: self.warnings.clone() }
    }

    /// Forgets what came after `mark`.
    pub fn rewind(&mut self, mark: SinkMark) {
        self.kept.truncate(mark.kept);
        self.errors = mark.errors;
        self.warnings = mark.warnings;
    }

    /// What was kept, in the order of files and places, with a note where warnings were left out and a last error
    /// where errors were.
    pub fn finish(mut self) -> Vec<Diagnostic> {
        for (code, seen) in &self.warnings {
            let more = seen.saturating_sub(self.max_warnings_of_a_kind);
            if more > 0
                && let Some(last) = self.kept.iter_mut().rev().find(|kept| kept.code == *code)
            {
                last.notes.push((None, format!("and {more} more of this kind")));
            }
        }
        self.kept.sort_by_key(|kept| match kept.span {
            Some(span) => (0, span.file.0, span.start),
            None => (1, 0, 0),
        });
        if self.errors > self.max_errors {
            let text = format!("further errors are not shown after the first {}", self.max_errors);
            self.kept.push(Diagnostic::error("too-many-errors", text));
        }
        self.kept
    }
}

/// Every code that reading a file can give, with what it means.
pub const READER_CODES: &[(&str, Severity, &str)] = &[
    ("argument-count", Severity::Error, "A directive has too few or too many arguments."),
    ("attenuation", Severity::Warning, "An attenuation coefficient is below 0, or all three are 0."),
    ("cannot-read", Severity::Error, "A file cannot be read; the message says what the system says."),
    ("count-hint", Severity::Warning, "A `#…_num` line does not agree with what stands in the file."),
    ("degenerate-shape", Severity::Warning, "A shape of no extent; it is left out."),
    ("dialect-doubt", Severity::Warning, "The file has marks of more than one dialect."),
    ("dialect-unclear", Severity::Error, "The file has as many marks of one dialect as of another."),
    ("file-too-large", Severity::Error, "A file is larger than the limit."),
    (
        "group-matrix",
        Severity::Error,
        "The last row of a group's matrix is not `0 0 0 1`, or the matrix is singular.",
    ),
    ("half-angle", Severity::Error, "The camera's half angle does not lie between 0 and π/2."),
    ("ignored-part", Severity::Warning, "A part of a foreign dialect that the picture does not show."),
    ("include-cycle", Severity::Error, "A file includes itself, be it by way of others."),
    (
        "include-elsewhere",
        Severity::Warning,
        "An included file of a foreign dialect was found in another folder than usual.",
    ),
    ("include-limit", Severity::Error, "Includes are nested too deep, or there are too many files."),
    ("include-not-found", Severity::Error, "An included file was not found; the places tried are listed."),
    (
        "index-of-refraction",
        Severity::Error,
        "A material transmits (kt > 0), but its index of refraction is not above 0.",
    ),
    ("lamp-radius", Severity::Error, "The radius of a `#light_area` is not above 0."),
    ("letter-case", Severity::Warning, "A directive is not written in lower case; it is accepted."),
    ("lone-affine", Severity::Error, "`#static_affine` without a shape after it."),
    ("negative-count", Severity::Error, "The number of a `#…_num` line is below 0."),
    ("nesting-limit", Severity::Error, "Groups are nested deeper than the limit."),
    ("not-a-number", Severity::Error, "A number belongs here: decimal, finite."),
    ("not-a-scene", Severity::Error, "The file is empty, binary, or in another format."),
    ("not-an-integer", Severity::Error, "A whole number belongs here."),
    ("other-dialect", Severity::Error, "The file is written in a dialect of the language that is not read."),
    ("parallel-up", Severity::Error, "The camera's up vector is parallel to its view direction."),
    (
        "repeated-directive",
        Severity::Warning,
        "A second `#camera`, `#background` or `#ambient`; the first one counts.",
    ),
    ("repeated-name", Severity::Warning, "A second material of the same name; the last one counts."),
    ("spot-angle", Severity::Warning, "A spot's cut-off angle does not lie between 0 and π."),
    ("stray-group-end", Severity::Error, "`#group_end` without an open group."),
    ("stray-text", Severity::Error, "Text before the first directive."),
    ("too-many-errors", Severity::Error, "There were more errors than are shown."),
    ("too-many-shapes", Severity::Error, "There are more shapes than the limit."),
    ("unclosed-flags", Severity::Error, "The flags of a directive do not end with `--`."),
    ("unclosed-group", Severity::Error, "A `#group_begin` without its `#group_end`."),
    ("unknown-directive", Severity::Error, "No directive has this name."),
    ("unknown-include", Severity::Error, "`#ray_file_instance` names no `#ray_file`."),
    ("unknown-material", Severity::Error, "A shape names no material."),
    ("unknown-texture", Severity::Error, "A material names no texture."),
    ("unknown-vertex", Severity::Error, "A triangle names no vertex."),
    (
        "unsupported-directive",
        Severity::Error,
        "A directive of a foreign dialect that nothing here corresponds to.",
    ),
    ("unterminated", Severity::Error, "A quote, a `!…!` text or a comment is never closed."),
    ("wrong-argument", Severity::Error, "A file name or a `!…!` text belongs here."),
    ("zero-direction", Severity::Error, "A direction has length 0, or a length that cannot be computed."),
];

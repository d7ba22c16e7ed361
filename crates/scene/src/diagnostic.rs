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

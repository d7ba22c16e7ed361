//! Messages about several scenes with their places worked out, and the ways to print them.

mod github;
mod json;
mod sarif;

pub use github::github;
pub use json::json;
pub use sarif::sarif;

use dotray::scene::Diagnostic;
use dotray::scene::Severity;
use dotray::scene::report::render_text;
use dotray::scene::sources::Position;
use dotray::scene::sources::Sources;
use dotray::scene::span::Span;

/// Where something begins, and the place after its last character; all from 1.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub struct Region {
    /// Where it begins.
    pub start: Position,
    /// The place after its end.
    pub end: Position,
}

/// A place in a file, or a whole file.
#[derive(Clone, Debug, PartialEq, Eq, Hash)]
pub struct Location {
    /// The path.
    pub file: String,
    /// `None` for the whole file.
    pub region: Option<Region>,
}

/// A further sentence.
#[derive(Clone, Debug)]
pub struct Note {
    /// The sentence.
    pub message: String,
    /// What it is about, if not the place of the message.
    pub location: Option<Location>,
}

/// A message on its own: it needs the text of its file no more.
#[derive(Clone, Debug)]
pub struct Finding {
    /// Error or warning.
    pub severity: Severity,
    /// The code.
    pub code: &'static str,
    /// One sentence.
    pub message: String,
    /// Where.
    pub location: Location,
    /// The words under the caret; may be empty.
    pub label: String,
    /// Further sentences.
    pub notes: Vec<Note>,
    /// A likely repair.
    pub help: Option<String>,
    /// All of it as people read it.
    pub text: String,
}

impl Finding {
    /// A diagnostic with its places. `scene` is the file that was asked for.
    pub fn new(diagnostic: &Diagnostic, sources: &Sources, scene: &str, color: bool) -> Self {
        let mut text = render_text(std::slice::from_ref(diagnostic), sources, color);
        if sources.is_empty() {
            text.insert_str(0, &format!("{scene}: "));
        }
        let whole = Location { file: scene.to_owned(), region: None };
        let note = |(span, message): &(Option<Span>, String)| Note {
            message: message.clone(),
            location: span.map(|span| location(span, sources)),
        };
        Self {
            severity: diagnostic.severity,
            code: diagnostic.code,
            message: diagnostic.message.clone(),
            location: diagnostic.span.map_or(whole, |span| location(span, sources)),
            label: diagnostic.label.clone(),
            notes: diagnostic.notes.iter().map(note).collect(),
            help: diagnostic.help.clone(),
            text,
        }
    }

    /// The sentence and all that is said besides, one a line, for those who show no source.
    fn in_words(&self) -> String {
        let mut lines = vec![self.message.clone()];
        if !self.label.is_empty() {
            lines.push(self.label.clone());
        }
        lines.extend(self.notes.iter().map(|note| match &note.location {
            Some(Location { file, region: Some(region) }) => {
                format!("note: {} ({file}:{}:{})", note.message, region.start.line, region.start.column)
            }
            Some(_) | None => format!("note: {}", note.message),
        }));
        lines.extend(self.help.iter().map(|help| format!("help: {help}")));
        lines.join("\n")
    }
}

fn location(span: Span, sources: &Sources) -> Location {
    let end = Span { start: span.end.max(span.start), ..span };
    let region = Region { start: sources.position(span), end: sources.position(end) };
    Location { file: sources.path(span.file).display().to_string(), region: Some(region) }
}

/// What was found in all scenes.
#[derive(Debug, Default)]
pub struct Report {
    /// How many scenes were checked.
    pub files: usize,
    /// The messages, in the order of scenes and places.
    pub findings: Vec<Finding>,
}

impl Report {
    /// How many errors there are.
    pub fn errors(&self) -> usize {
        self.findings.iter().filter(|finding| finding.severity == Severity::Error).count()
    }

    /// How many warnings there are.
    pub fn warnings(&self) -> usize {
        self.findings.len() - self.errors()
    }

    /// `3 files: 2 errors, 1 warning`
    pub fn summary(&self) -> String {
        let counted =
            |count: usize, what: &str| format!("{count} {what}{}", if count == 1 { "" } else { "s" });
        let [files, errors, warnings] =
            [(self.files, "file"), (self.errors(), "error"), (self.warnings(), "warning")]
                .map(|(count, what)| counted(count, what));
        format!("{files}: {errors}, {warnings}")
    }

    /// The messages for people, and the summary.
    pub fn text(&self) -> String {
        let mut text: String = self.findings.iter().map(|finding| finding.text.as_str()).collect();
        text.push_str(&self.summary());
        text.push('\n');
        text
    }
}

fn severity_name(severity: Severity) -> &'static str {
    match severity {
        Severity::Warning => "warning",
        Severity::Error => "error",
    }
}

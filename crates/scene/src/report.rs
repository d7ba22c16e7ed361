//! Diagnostics as text for people: the place and the message, the line, a caret under the token.

use crate::diagnostic::Diagnostic;
use crate::diagnostic::Severity;
use crate::sources::Position;
use crate::sources::Sources;
use crate::span::FileId;
use crate::span::Span;
use annotate_snippets::Annotation;
use annotate_snippets::AnnotationKind;
use annotate_snippets::Group;
use annotate_snippets::Level;
use annotate_snippets::Renderer;
use annotate_snippets::Snippet;

/// Lines are cut to this many columns around what the caret points at.
const WIDTH: usize = 170;

/// How many bytes of a line before and after the caret are looked at, so that a line of any length costs the same.
const WINDOW: usize = 300;

/// Marks the path of a snippet that shows only part of its line; what it says of columns is then corrected.
const CUT: char = '\u{E0F0}';

/// All diagnostics, one after the other, each followed by an empty line. Each begins `file:line:column: error[code]: `,
/// which editors know how to jump to; where the whole scene is meant, `file: `.
pub fn render_text(diagnostics: &[Diagnostic], sources: &Sources, color: bool) -> String {
    let renderer = if color { Renderer::styled() } else { Renderer::plain() }.term_width(WIDTH);
    let mut text = String::new();
    for diagnostic in diagnostics {
        text.push_str(&one(diagnostic, sources, &renderer));
        text.push_str("\n\n");
    }
    text
}

fn one(diagnostic: &Diagnostic, sources: &Sources, renderer: &Renderer) -> String {
    let level = match diagnostic.severity {
        Severity::Warning => Level::WARNING,
        Severity::Error => Level::ERROR,
    };
    let mut corrections = Vec::new();
    let mut group = Group::with_title(level.primary_title(diagnostic.message.as_str()).id(diagnostic.code));
    if let Some(span) = diagnostic.span {
        group = group.element(snippet(sources, span, &diagnostic.label).snippet);
    }
    let mut groups = Vec::new();
    for (span, note) in &diagnostic.notes {
        match span {
            None => group = group.element(Level::NOTE.message(note.as_str())),
            Some(span) => {
                let title = Level::NOTE.secondary_title(note.as_str());
                let part = snippet(sources, *span, "");
                let mut path = shown_path(sources, span.file);
                if part.shown_column != part.place.column {
                    let Position { line, column } = part.place;
                    path.push(CUT);
                    let shown = format!("{CUT}:{line}:{}", part.shown_column);
                    corrections.push((shown, format!(":{line}:{column}")));
                }
                groups.push(Group::with_title(title).element(part.snippet.path(path)));
            }
        }
    }
    if let Some(help) = &diagnostic.help {
        group = group.element(Level::HELP.message(help.as_str()));
    }
    groups.insert(0, group);
    let mut text = renderer.render(&groups);
    for (shown, right) in corrections {
        text = text.replacen(&shown, &right, 1);
    }
    place(sources, diagnostic.span) + &text
}

/// `file:line:column: `, `file: ` for a whole scene, nothing where no file was read.
fn place(sources: &Sources, span: Option<Span>) -> String {
    match span {
        Some(span) => {
            let Position { line, column } = sources.position(span);
            format!("{}:{line}:{column}: ", shown_path(sources, span.file))
        }
        None if sources.is_empty() => String::new(),
        None => format!("{}: ", shown_path(sources, FileId(0))),
    }
}

fn shown_path(sources: &Sources, file: FileId) -> String {
    let path = sources.path(file).display().to_string();
    path.chars().map(|c| if c.is_control() || c == CUT { '\u{FFFD}' } else { c }).collect()
}

/// A line with its caret, not yet with its path.
struct Part<'a> {
    snippet: Snippet<'a, Annotation<'a>>,
    place: Position,
    /// The column in the part of the line that is shown.
    shown_column: usize,
}

/// The line where a span starts, or the part of it around the span.
fn snippet<'a>(sources: &Sources, span: Span, label: &'a str) -> Part<'a> {
    let bytes = sources.bytes(span.file);
    let place = sources.position(span);
    let line = sources.line_start(span);
    let start = usize::try_from(span.start).unwrap_or(usize::MAX).clamp(line, bytes.len().max(line));
    let from = start.saturating_sub(WINDOW).max(line);
    let line_end = line_end(bytes, start);
    let end = usize::try_from(span.end).unwrap_or(usize::MAX).clamp(start, line_end);

    // Broken UTF-8 is shown as U+FFFD, so the three parts are made apart to know where the carets go.
    let before = readable(bytes.get(from..start).unwrap_or_default());
    let token = readable(bytes.get(start..end).unwrap_or_default());
    let after = readable(bytes.get(end..line_end).unwrap_or_default());
    let carets = before.len()..before.len() + token.len();
    let shown_column = before.chars().count() + 1;

    let annotation = AnnotationKind::Primary.span(carets);
    let annotation = if label.is_empty() { annotation } else { annotation.label(label) };
    let snippet = Snippet::source(before + &token + &after).line_start(place.line).annotation(annotation);
    Part { snippet, place, shown_column }
}

/// The end of the line, or of as much of it as is looked at.
fn line_end(bytes: &[u8], start: usize) -> usize {
    let rest = bytes.get(start..).unwrap_or_default();
    let rest = rest.get(..WINDOW).unwrap_or(rest);
    let length = rest.iter().position(|&byte| byte == b'\n').unwrap_or(rest.len());
    let has_return = length > 0 && rest.get(length - 1) == Some(&b'\r');
    start + length - usize::from(has_return)
}

/// Text on one line, whatever the bytes are.
fn readable(bytes: &[u8]) -> String {
    let text = String::from_utf8_lossy(bytes);
    text.chars().map(|c| if c.is_control() && c != '\t' || c == CUT { '\u{FFFD}' } else { c }).collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::path::PathBuf;
    use std::time::Instant;

    fn render(text: &[u8], start: usize, end: usize) -> String {
        let mut sources = Sources::default();
        let file = sources.add(PathBuf::from("a.ray"), text.to_vec());
        let diagnostic = Diagnostic::error("code", "message").at(Span::new(file, start, end)).label("here");
        render_text(&[diagnostic.note("note").help("help")], &sources, false)
    }

    #[test]
    fn it_looks_like_rustc() {
        let text = render(b"#a 1\n\t#b two 3\r\n#c", 9, 12);
        let expected = "\
a.ray:2:5: error[code]: message
  |
2 |     #b two 3
  |        ^^^ here
  |
  = note: note
  = help: help

";
        assert_eq!(text, expected);
    }

    #[test]
    fn a_whole_scene_is_named_by_its_file() {
        let mut sources = Sources::default();
        let fault = || Diagnostic::warning("code", "message");
        assert_eq!(render_text(&[fault()], &sources, false), "warning[code]: message\n\n");
        let file = sources.add(PathBuf::from("a\n.ray"), b"#a\n#b".to_vec());
        assert_eq!(render_text(&[fault()], &sources, false), "a\u{FFFD}.ray: warning[code]: message\n\n");
        let text = render_text(&[fault().note_at(Span::new(file, 3, 5), "there")], &sources, false);
        assert!(text.contains("note: there\n --> a\u{FFFD}.ray:2:1\n"), "{text}");
    }

    #[test]
    fn carets_stand_right_in_odd_text() {
        let text = render(b"\xef\xbb\xbf\xff\xc3\xa4 x\x07y", 7, 8);
        assert!(text.contains("a.ray:1:4"), "{text}");
        assert!(text.contains("1 | \u{FFFD}ä x\u{FFFD}y\n  |    ^ here"), "{text}");
        for end in 0..4 {
            render(b"", end, end + 1);
            render(b"a\n", 2, end);
        }
    }

    #[test]
    fn a_long_line_costs_its_window_and_tells_the_true_column() {
        let mut line = b"#camera ".to_vec();
        for _ in 0..1_000_000 {
            line.extend_from_slice(b"12345 ");
        }
        let at = line.len() - 600_000;
        let begin = Instant::now();
        let text = render(&line, at + 2, at + 7);
        assert!(begin.elapsed().as_secs_f64() < 1.0);
        assert!(text.contains(&format!("a.ray:1:{}", at + 3)), "{text}");
        assert!(!text.contains(CUT), "{text}");
        assert!(text.lines().all(|line| line.chars().count() <= WIDTH + 10), "{text}");
        assert!(text.contains("^^^^^ here"), "{text}");
    }
}

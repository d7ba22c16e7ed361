//! Where in the tree a fault stands: the groups around it.

#![deny(clippy::indexing_slicing, clippy::unwrap_used, clippy::expect_used)]

use crate::diagnostic::Diagnostic;
use crate::lex::Lexer;
use crate::lex::TokenKind;
use crate::sources::Sources;
use crate::span::FileId;
use crate::span::Span;

/// What stands in the tree and is moved by the groups around it.
const IN_THE_TREE: [&str; 4] = ["#shape_", "#group_begin", "#ray_file_instance", "#group_end"];

/// Adds to each message about a place inside groups where the innermost of them begins. The files are read once more
/// for it, so this is for whoever checks a scene.
pub fn name_groups(diagnostics: &mut [Diagnostic], sources: &Sources) {
    let files = u32::try_from(sources.len()).unwrap_or(u32::MAX);
    for file in (0..files).map(FileId) {
        let mut asked: Vec<&mut Diagnostic> = diagnostics
            .iter_mut()
            .filter(|diagnostic| {
                diagnostic.span.is_some_and(|span| span.file == file) && !has_group(diagnostic)
            })
            .collect();
        if !asked.is_empty() {
            asked.sort_by_key(|diagnostic| diagnostic.span);
            name_groups_of(file, sources.bytes(file), &mut asked);
        }
    }
}

fn has_group(diagnostic: &Diagnostic) -> bool {
    let says = |text: &str| text.starts_with("inside") || text.starts_with("opened");
    diagnostic.code == "unclosed-group" || diagnostic.notes.iter().any(|(_, text)| says(text))
}

fn name_groups_of(file: FileId, bytes: &[u8], asked: &mut [&mut Diagnostic]) {
    let mut lexer = Lexer::new(bytes);
    let mut open: Vec<Span> = Vec::new();
    let mut asked = asked.iter_mut().peekable();
    let mut directive = Directive { in_the_tree: false, depth: 0, around: None };
    while asked.peek().is_some() {
        let token = match lexer.token() {
            Ok(Some(token)) => Some(token),
            Ok(None) => None,
            // The lexer stands behind what is not closed.
            Err(_) => continue,
        };
        let start = token.map_or(u64::MAX, |token| token.start as u64);
        // Whatever begins before this token belongs to the directive at hand.
        while let Some(diagnostic) =
            asked.next_if(|diagnostic| diagnostic.span.is_some_and(|s| s.start < start))
        {
            directive.tell(diagnostic);
        }
        let Some(token) = token else { return };
        if token.kind != TokenKind::Directive {
            continue;
        }
        let word = lexer.text(token);
        let is = |name: &str| word.eq_ignore_ascii_case(name.as_bytes());
        if is("#group_end") {
            open.pop();
        }
        let in_the_tree = IN_THE_TREE.iter().any(|start| {
            word.get(..start.len()).is_some_and(|begin| begin.eq_ignore_ascii_case(start.as_bytes()))
        });
        directive = Directive { in_the_tree, depth: open.len(), around: open.last().copied() };
        if is("#group_begin") {
            open.push(Span::new(file, token.start, token.end));
        }
    }
}

/// The directive at hand.
struct Directive {
    in_the_tree: bool,
    depth: usize,
    around: Option<Span>,
}

impl Directive {
    fn tell(&self, diagnostic: &mut Diagnostic) {
        let Some(around) = self.around.filter(|_| self.in_the_tree) else { return };
        let text = match self.depth - 1 {
            0 => "inside this group".to_owned(),
            1 => "inside this group and one around it".to_owned(),
            more => format!("inside this group and {more} around it"),
        };
        diagnostic.notes.push((Some(around), text));
    }
}

#[cfg(test)]
#[allow(clippy::unwrap_used, clippy::indexing_slicing)]
mod tests {
    use super::*;
    use std::path::PathBuf;

    #[test]
    fn the_innermost_group_is_named() {
        let begin = "#group_begin 1 0 0 0  0 1 0 0  0 0 1 0  0 0 0 1\n";
        let text =
            format!("#shape_sphere a\n{begin}{begin}#shape_sphere b\n#ambient c\n#group_end\n#shape_box d\n");
        let mut sources = Sources::default();
        let file = sources.add(PathBuf::from("a.ray"), text.clone().into_bytes());
        let mut diagnostics: Vec<Diagnostic> = [" a\n", " b\n", " c\n", " d\n"]
            .map(|at| text.find(at).unwrap() + 1)
            .map(|at| Diagnostic::error("x", "x").at(Span::new(file, at, at + 1)))
            .into();
        name_groups(&mut diagnostics, &sources);
        let lines: Vec<_> = diagnostics
            .iter()
            .map(|d| {
                d.notes.first().map(|(span, text)| (sources.position(span.unwrap()).line, text.as_str()))
            })
            .collect();
        let expected =
            [None, Some((3, "inside this group and one around it")), None, Some((2, "inside this group"))];
        assert_eq!(lines, expected);
    }
}

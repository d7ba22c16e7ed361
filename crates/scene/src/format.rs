//! One canonical layout for `.ray` text, made from its tokens: numbers and comments stay as they are written.
//!
//! - A directive begins a line, in lower case, two blanks deeper for each group around it (at most 64).
//! - One blank parts its arguments, two part its groups of arguments: `#camera 0 0 4  0 0 -1  0 1 0  .5`.
//! - What does not fit in [`WIDTH`] columns goes on in further lines, two blanks deeper; a matrix then stands row by
//!   row.
//! - A comment behind something stays behind it, one on a line of its own stays so. Comments between arguments make
//!   each group of arguments a line of its own.
//! - Of several empty lines between directives one stays; none at the begin and end of groups and of the file.

#![deny(clippy::indexing_slicing, clippy::unwrap_used, clippy::expect_used)]

mod layout;
mod pieces;

use crate::directive;
use crate::lex::TokenKind;
use crate::lex::Unterminated;
use layout::Printer;
use pieces::Piece;
use pieces::PieceKind;
use pieces::Pieces;

/// Lines are kept within so many columns where breaking them is possible.
pub const WIDTH: usize = 100;

/// Why a text has no canonical layout.
#[derive(Clone, Copy, Debug, PartialEq, Eq, thiserror::Error)]
pub enum FormatError {
    /// Something is opened and never closed.
    #[error("byte {}: something is opened here and never closed", .0.start)]
    Unterminated(Unterminated),
    /// Words before the first directive.
    #[error("byte {0}: text before the first directive")]
    StrayText(usize),
}

/// Faults of a file that leave open what belongs to what: such a file cannot be laid out.
pub fn is_structural(code: &str) -> bool {
    const STRUCTURAL: [&str; 15] = [
        "argument-count",
        "cannot-read",
        "dialect-unclear",
        "file-too-large",
        "not-a-number",
        "not-a-scene",
        "other-dialect",
        "stray-group-end",
        "stray-text",
        "too-many-errors",
        "unclosed-flags",
        "unclosed-group",
        "unknown-directive",
        "unterminated",
        "wrong-argument",
    ];
    STRUCTURAL.contains(&code)
}

/// The text in its canonical layout. Formatting what comes out changes nothing more.
///
/// # Errors
/// A text whose tokens are not certain; see [`FormatError`].
///
/// ```
/// let text = "#Ambient 1 1\n\n\n1 // white\n   #shape_sphere -1 0 0 0 1";
/// let formatted = dotray_scene::format::format_text(text.as_bytes())?;
/// assert_eq!(formatted, b"#ambient 1 1 1  // white\n#shape_sphere -1  0 0 0  1\n");
/// # Ok::<(), dotray_scene::format::FormatError>(())
/// ```
pub fn format_text(text: &[u8]) -> Result<Vec<u8>, FormatError> {
    let mut printer = Printer::new(text);
    let mut statement: Vec<Piece> = Vec::new();
    for piece in Pieces::new(text) {
        let piece = piece.map_err(FormatError::Unterminated)?;
        let in_directive = statement.first().is_some_and(|first| first.kind.is(TokenKind::Directive));
        match piece.kind {
            PieceKind::Token(TokenKind::Directive) => {
                printer.statement(&statement);
                statement.clear();
            }
            PieceKind::Token(TokenKind::Word | TokenKind::Quoted | TokenKind::Text) if !in_directive => {
                return Err(FormatError::StrayText(piece.start));
            }
            PieceKind::Token(TokenKind::Word | TokenKind::Quoted | TokenKind::Text)
            | PieceKind::LineComment
            | PieceKind::BlockComment => {}
        }
        statement.push(piece);
    }
    printer.statement(&statement);
    Ok(printer.finish())
}

/// Whether two texts have the same tokens and comments in the same order: what layout may never change. Letter case of
/// directives, blanks at the end of a comment's line and Windows line ends in comments do not count.
pub fn says_the_same(one: &[u8], other: &[u8]) -> bool {
    let mut others = Pieces::new(other);
    for piece in Pieces::new(one) {
        let same = match (piece, others.next()) {
            (Ok(piece), Some(Ok(found))) => equal(&piece, piece.text(one), &found, found.text(other)),
            (Ok(_) | Err(_), _) => false,
        };
        if !same {
            return false;
        }
    }
    others.next().is_none()
}

fn equal(piece: &Piece, text: &[u8], found: &Piece, found_text: &[u8]) -> bool {
    piece.kind == found.kind
        && match piece.kind {
            PieceKind::Token(TokenKind::Directive) => canonical_word(text) == canonical_word(found_text),
            PieceKind::Token(TokenKind::Word | TokenKind::Quoted | TokenKind::Text) => text == found_text,
            PieceKind::LineComment | PieceKind::BlockComment => {
                layout::comment_lines(text).eq(layout::comment_lines(found_text))
            }
        }
}

/// A directive's word as the table has it.
fn canonical_word(word: &[u8]) -> &[u8] {
    directive::find_in_any_case(word).map_or(word, |spec| spec.word.as_bytes())
}

//! Tokens and comments, and how many line ends stand before each.

use crate::lex::Lexer;
use crate::lex::TokenKind;
use crate::lex::Unterminated;

/// What a piece is.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum PieceKind {
    /// What the language sees.
    Token(TokenKind),
    /// `// …`
    LineComment,
    /// `/* … */`
    BlockComment,
}

impl PieceKind {
    /// Whether it is a token of this kind.
    pub fn is(self, kind: TokenKind) -> bool {
        self == Self::Token(kind)
    }

    /// Whether it is a comment.
    pub fn is_comment(self) -> bool {
        matches!(self, Self::LineComment | Self::BlockComment)
    }
}

/// A token or comment.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Piece {
    /// What it is.
    pub kind: PieceKind,
    /// The first byte.
    pub start: usize,
    /// The byte after the last.
    pub end: usize,
    /// The line ends between it and the piece before.
    pub breaks: usize,
}

impl Piece {
    /// Its bytes.
    pub fn text<'a>(&self, text: &'a [u8]) -> &'a [u8] {
        text.get(self.start..self.end).unwrap_or_default()
    }
}

/// All pieces of a text, in order; ends after the first fault.
pub struct Pieces<'a> {
    text: &'a [u8],
    at: usize,
    failed: bool,
}

impl<'a> Pieces<'a> {
    /// Before the first piece, after a byte order mark.
    pub fn new(text: &'a [u8]) -> Self {
        Self { text, at: Lexer::new(text).at(), failed: false }
    }

    fn rest(&self) -> &'a [u8] {
        self.text.get(self.at..).unwrap_or_default()
    }

    /// Goes over white space and counts its line ends; `\r\n` is one.
    fn skip_white(&mut self) -> usize {
        let mut breaks = 0;
        let mut before = 0;
        for &byte in self.rest() {
            match byte {
                b'\n' if before == b'\r' => {}
                b'\n' | b'\r' => breaks += 1,
                b' ' | b'\t' | 0x0b | 0x0c => {}
                _ => break,
            }
            before = byte;
            self.at += 1;
        }
        breaks
    }

    fn comment(&self) -> Option<PieceKind> {
        match self.rest() {
            [b'/', b'/', ..] => Some(PieceKind::LineComment),
            [b'/', b'*', ..] => Some(PieceKind::BlockComment),
            _ => None,
        }
    }

    fn comment_end(&mut self, kind: PieceKind) -> Result<usize, Unterminated> {
        if kind == PieceKind::LineComment {
            let rest = self.rest();
            let length = rest.iter().position(|&byte| byte == b'\n' || byte == b'\r');
            return Ok(self.at + length.unwrap_or(rest.len()));
        }
        // One comment at a time: a lexer that skips blanks would take all that follow each other.
        let inside = self.at + 2;
        let rest = self.text.get(inside..).unwrap_or_default();
        match rest.windows(2).position(|pair| pair == b"*/") {
            Some(length) => Ok(inside + length + 2),
            None => Err(Unterminated { what: crate::lex::Opened::Comment, start: self.at }),
        }
    }
}

impl Iterator for Pieces<'_> {
    type Item = Result<Piece, Unterminated>;

    fn next(&mut self) -> Option<Self::Item> {
        if self.failed {
            return None;
        }
        let breaks = self.skip_white();
        if let Some(kind) = self.comment() {
            let start = self.at;
            return Some(self.comment_end(kind).map(|end| {
                self.at = end;
                Piece { kind, start, end, breaks }
            }))
            .inspect(|piece| self.failed = piece.is_err());
        }
        let mut lexer = Lexer::from(self.text, self.at);
        match lexer.token() {
            Ok(None) => None,
            Ok(Some(token)) => {
                self.at = token.end;
                let kind = PieceKind::Token(token.kind);
                Some(Ok(Piece { kind, start: token.start, end: token.end, breaks }))
            }
            Err(fault) => {
                self.failed = true;
                Some(Err(fault))
            }
        }
    }
}

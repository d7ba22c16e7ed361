//! Files that are no `.ray` files of the dialect that is read: told in one message instead of twenty.

#![deny(clippy::indexing_slicing, clippy::unwrap_used, clippy::expect_used)]

use crate::lex;
use crate::lex::Lexer;
use crate::lex::TokenKind;

/// What a file is instead of a scene.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum Lookalike {
    /// Nothing but white space and comments.
    Empty,
    /// Bytes that no text has.
    Binary,
    /// UTF-16 text.
    Utf16,
    /// Another program's format, as far as known whose.
    OtherFormat(&'static str),
    /// Another dialect of the language.
    OtherDialect(&'static str),
}

/// Looks at the first bytes and tokens.
pub fn lookalike(bytes: &[u8]) -> Option<Lookalike> {
    const ENOUGH: usize = 4096;
    if bytes.starts_with(b"\xff\xfe") || bytes.starts_with(b"\xfe\xff") {
        return Some(Lookalike::Utf16);
    }
    if bytes.iter().take(ENOUGH).any(|&byte| byte == 0) {
        return Some(Lookalike::Binary);
    }
    let mut lexer = Lexer::new(bytes);
    let token = match lexer.token() {
        Ok(Some(token)) => token,
        Ok(None) => return Some(Lookalike::Empty),
        Err(_) => return None,
    };
    match (token.kind, lexer.text(token)) {
        (TokenKind::Word, b"SBT-raytracer") => Some(Lookalike::OtherFormat("an SBT-raytracer file")),
        (TokenKind::Word, b"eye:" | b"set") => Some(Lookalike::OtherFormat("another ray tracer's file")),
        (TokenKind::Directive, b"#parameters") => Some(Lookalike::OtherFormat("another ray tracer's file")),
        (TokenKind::Directive, b"#version") => {
            let version = lexer.token().ok().flatten().map(|token| lexer.text(token)).unwrap_or_default();
            version.starts_with(b"HMC").then_some(Lookalike::OtherDialect("hmc"))
        }
        (TokenKind::Quoted, _) => {
            let next = lexer.token().ok().flatten()?;
            let is_number = lex::number(lexer.text(next)).is_ok();
            is_number.then_some(Lookalike::OtherFormat("a file of ray acoustics"))
        }
        (TokenKind::Directive | TokenKind::Word | TokenKind::Text, _) => None,
    }
}

/// The dialect of which a directive is known that this one has not.
pub fn foreign_directive(word: &[u8]) -> Option<&'static str> {
    const FOREIGN: &[(&str, &str)] = &[
        ("#joint_begin", "uva"),
        ("#joint_end", "uva"),
        ("#key_file", "uva"),
        ("#static_affine", "jhu"),
        ("#shape_list_begin", "jhu"),
        ("#shape_list_end", "jhu"),
        ("#shape_triangles", "jhu"),
        ("#shape_torus", "jhu"),
        ("#version", "hmc"),
        ("#rayfile_end", "hmc"),
        ("#sphere", "hmc"),
        ("#triangle", "hmc"),
        ("#box", "hmc"),
        ("#cone", "hmc"),
        ("#cylinder", "hmc"),
        ("#torus", "hmc"),
        ("#translate", "hmc"),
        ("#rotate", "hmc"),
        ("#scale", "hmc"),
        ("#shader", "unisa"),
    ];
    FOREIGN.iter().find(|(known, _)| known.as_bytes().eq_ignore_ascii_case(word)).map(|(_, dialect)| *dialect)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn other_formats_are_told_by_their_first_words() {
        let cases: [(&[u8], Option<Lookalike>); 9] = [
            (b" // nothing\n", Some(Lookalike::Empty)),
            (b"BM\x36\0\0\0", Some(Lookalike::Binary)),
            (b"\xff\xfe#\0c\0", Some(Lookalike::Utf16)),
            (b"SBT-raytracer 1.0", Some(Lookalike::OtherFormat("an SBT-raytracer file"))),
            (b"eye: 0 0 0", Some(Lookalike::OtherFormat("another ray tracer's file"))),
            (b"'a title'\n 1", None),
            (b"\"A title\" 50.0", Some(Lookalike::OtherFormat("a file of ray acoustics"))),
            (b"#version HMCCS155FALL2002", Some(Lookalike::OtherDialect("hmc"))),
            (b"#camera 0 0 0", None),
        ];
        for (bytes, expected) in cases {
            assert_eq!(lookalike(bytes), expected, "{}", String::from_utf8_lossy(bytes));
        }
    }
}

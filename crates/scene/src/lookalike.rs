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
    if let Some((_, name)) = BEGINNINGS.iter().find(|(begin, _)| bytes.starts_with(begin)) {
        return Some(Lookalike::OtherFormat(name));
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
        (TokenKind::Word, b"ply") => Some(Lookalike::OtherFormat("a PLY mesh")),
        (TokenKind::Word, b"solid") => Some(Lookalike::OtherFormat("an STL mesh")),
        (TokenKind::Word, b"OFF") => Some(Lookalike::OtherFormat("an OFF mesh")),
        (TokenKind::Word, b"mtllib") => Some(Lookalike::OtherFormat("a Wavefront OBJ mesh")),
        (TokenKind::Word, b"v" | b"o" | b"g" | b"vn") if is_mesh(lexer.clone()) => {
            Some(Lookalike::OtherFormat("a Wavefront OBJ mesh"))
        }
        (TokenKind::Word, b"LookAt" | b"WorldBegin" | b"Camera" | b"Film" | b"Sampler" | b"Integrator") => {
            Some(Lookalike::OtherFormat("a pbrt scene"))
        }
        (TokenKind::Word, b"camera" | b"global_settings" | b"light_source") if is_braced(lexer.clone()) => {
            Some(Lookalike::OtherFormat("a POV-Ray scene"))
        }
        (TokenKind::Directive, b"#VRML") => Some(Lookalike::OtherFormat("a VRML world")),
        (TokenKind::Directive, b"##RenderMan") => Some(Lookalike::OtherFormat("a RenderMan file")),
        (TokenKind::Quoted, _) => {
            let next = lexer.token().ok().flatten()?;
            let is_number = lex::number(lexer.text(next)).is_ok();
            is_number.then_some(Lookalike::OtherFormat("a file of ray acoustics"))
        }
        (TokenKind::Directive | TokenKind::Word | TokenKind::Text, _) => None,
    }
}

/// Files that their first bytes name, whatever follows.
const BEGINNINGS: &[(&[u8], &str)] = &[
    (b"\x89PNG", "a PNG picture"),
    (b"\xff\xd8\xff", "a JPEG picture"),
    (b"GIF8", "a GIF picture"),
    (b"qoif", "a QOI picture"),
    (b"#?RADIANCE", "a Radiance HDR picture"),
    (b"\x76\x2f\x31\x01", "an OpenEXR picture"),
    (b"%PDF", "a PDF document"),
    (b"%!PS", "a PostScript document"),
    (b"PK\x03\x04", "a ZIP archive"),
    (b"glTF", "a glTF mesh"),
    (b"<<<<<<<", "a text with marks of a merge that was not finished"),
    (b"version https://git-lfs", "a pointer of Git LFS, whose file was not fetched"),
    (b"<", "an XML or HTML document"),
    (b"{", "a JSON document"),
];

/// Whether a line of an OBJ mesh goes on: three numbers, or a name and a line of numbers.
fn is_mesh(mut lexer: Lexer<'_>) -> bool {
    let words = std::iter::from_fn(|| lexer.token().ok().flatten().map(|token| lexer.text(token)));
    let numbers = words.take(5).filter(|word| lex::number(word).is_ok());
    numbers.count() >= 3
}

fn is_braced(mut lexer: Lexer<'_>) -> bool {
    lexer.token().ok().flatten().is_some_and(|token| lexer.text(token).starts_with(b"{"))
}

/// The dialect of which a directive is known that this one has not.
pub fn foreign_directive(word: &[u8]) -> Option<&'static str> {
    const FOREIGN: &[(&str, &str)] = &[
        ("#joint_begin", "uva"),
        ("#joint_end", "uva"),
        ("#key_file", "uva"),
        ("#static_affine", "jhu"),
        ("#dynamic_affine", "jhu"),
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

/// Whether the word is one of constructive solid geometry, as `jhu` has it.
pub fn is_solid_geometry(word: &[u8]) -> bool {
    let Some(stem) = word.strip_prefix(b"#") else { return false };
    let stem = stem.to_ascii_lowercase();
    let stem = stem.strip_prefix(b"shape_").unwrap_or(&stem);
    let stem = stem.strip_suffix(b"_begin").or(stem.strip_suffix(b"_end")).unwrap_or(stem);
    [&b"union"[..], b"intersection", b"difference", b"csg"].contains(&stem)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn other_formats_are_told_by_their_first_words() {
        let cases: [(&[u8], Option<Lookalike>); 17] = [
            (b" // nothing\n", Some(Lookalike::Empty)),
            (b"BM\x36\0\0\0", Some(Lookalike::Binary)),
            (b"\xff\xfe#\0c\0", Some(Lookalike::Utf16)),
            (b"SBT-raytracer 1.0", Some(Lookalike::OtherFormat("an SBT-raytracer file"))),
            (b"eye: 0 0 0", Some(Lookalike::OtherFormat("another ray tracer's file"))),
            (b"'a title'\n 1", None),
            (b"\"A title\" 50.0", Some(Lookalike::OtherFormat("a file of ray acoustics"))),
            (b"#version HMCCS155FALL2002", Some(Lookalike::OtherDialect("hmc"))),
            (b"#camera 0 0 0", None),
            (b"\x89PNG\r\n", Some(Lookalike::OtherFormat("a PNG picture"))),
            (b"ply\nformat ascii 1.0", Some(Lookalike::OtherFormat("a PLY mesh"))),
            (b"v 1 2 3\nv 4 5 6", Some(Lookalike::OtherFormat("a Wavefront OBJ mesh"))),
            (b"o cube\nv 1 2 3", Some(Lookalike::OtherFormat("a Wavefront OBJ mesh"))),
            (b"o my scene\n#camera", None),
            (b"camera { location", Some(Lookalike::OtherFormat("a POV-Ray scene"))),
            (b"camera 0 0 4", None),
            (b"<scene version='3'>", Some(Lookalike::OtherFormat("an XML or HTML document"))),
        ];
        for (bytes, expected) in cases {
            assert_eq!(lookalike(bytes), expected, "{}", String::from_utf8_lossy(bytes));
        }
    }
}

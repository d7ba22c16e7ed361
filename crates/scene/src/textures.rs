//! The pictures that scenes name: where they are named, and what there is to say of one that cannot be had. Whether a
//! file is a picture is not asked here; scene opens none.

#![deny(clippy::indexing_slicing, clippy::unwrap_used, clippy::expect_used)]

use crate::diagnostic::Diagnostic;
use crate::dialect::Dialect;
use crate::files::Files;
use crate::lex::Lexer;
use crate::lex::TokenKind;
use crate::model::Placed;
use crate::resolve::resolve_texture;
use crate::resolved::ResolvedTexture;
use crate::similar::similar_file;
use crate::sources::Sources;
use crate::span::FileId;
use crate::span::Span;
use std::path::Path;

/// The textures that a scene names, taken from its tokens: also those of a scene that has faults elsewhere.
pub fn named_in(sources: &Sources, dialect: Dialect) -> Vec<ResolvedTexture> {
    let files = u32::try_from(sources.len()).unwrap_or(u32::MAX);
    let mut found = Vec::new();
    for file in (0..files).map(FileId) {
        let mut lexer = Lexer::new(sources.bytes(file));
        loop {
            let token = match lexer.token() {
                Ok(Some(token)) => token,
                Ok(None) => break,
                // The lexer stands behind what is not closed.
                Err(_) => continue,
            };
            if token.kind != TokenKind::Directive || !lexer.text(token).eq_ignore_ascii_case(b"#texture") {
                continue;
            }
            let start = token.start;
            let Ok(Some(name)) = lexer.token() else { continue };
            match name.kind {
                TokenKind::Word | TokenKind::Quoted => {
                    let value = String::from_utf8_lossy(lexer.inner(name)).into_owned();
                    let span = Span::new(file, start, name.end);
                    found.push(resolve_texture(sources.path(file), dialect, &Placed { value, span }));
                }
                TokenKind::Directive => lexer.go_to(name.start),
                TokenKind::Text => {}
            }
        }
    }
    found
}

/// Looks for files of similar names. A scene may miss a million textures, and each look lists a folder, so that only
/// the first hundred are looked for.
pub struct Hints<'a> {
    files: &'a dyn Files,
    left: u32,
}

impl<'a> Hints<'a> {
    /// Hints from the folders of `files`.
    pub fn new(files: &'a dyn Files) -> Self {
        Self { files, left: 100 }
    }

    fn similar(&mut self, texture: &ResolvedTexture) -> Option<String> {
        self.left = self.left.checked_sub(1)?;
        texture.candidates.iter().find_map(|path| similar_file(self.files, path))
    }
}

/// An error for a texture whose file is nowhere; `refused` tells of files that are there and could not be read.
pub fn not_found(hints: &mut Hints, texture: &ResolvedTexture, refused: Vec<String>) -> Diagnostic {
    let mut folders: Vec<String> = Vec::new();
    for path in &texture.candidates {
        let folder = path.parent().filter(|folder| !folder.as_os_str().is_empty()).unwrap_or(Path::new("."));
        let folder = format!("`{}`", folder.display());
        if !folders.contains(&folder) {
            folders.push(folder);
        }
    }
    let message = format!("the texture `{}` was not found", texture.name);
    let error = Diagnostic::error("texture-not-found", message)
        .at(texture.span)
        .label("named here")
        .note(format!("folders searched: {}", folders.join(", ")));
    let error = refused.into_iter().fold(error, Diagnostic::note);
    match hints.similar(texture) {
        Some(similar) => error.help(format!("there is a file `{similar}`")),
        None => error.help("a texture's name is relative to the folder of its .ray file"),
    }
}

/// An error for a texture whose file at `path` is there, but is no picture that can be decoded.
pub fn unreadable(texture: &ResolvedTexture, path: &Path, fault: &str) -> Diagnostic {
    let message = format!("the texture `{}` cannot be decoded: {fault}", texture.name);
    Diagnostic::error("texture-unreadable", message)
        .at(texture.span)
        .label("named here")
        .note(format!("the file is `{}`", path.display()))
        .help("save it anew as PNG, JPEG, BMP, PPM, QOI, TIFF, HDR or EXR")
}

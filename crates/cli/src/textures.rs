//! Whether a scene's textures are there and can be decoded.

use dotray::image::Format;
use dotray::image::Limits;
use dotray::image::decode;
use dotray::scene::Diagnostic;
use dotray::scene::Files;
use dotray::scene::lex::Lexer;
use dotray::scene::lex::TokenKind;
use dotray::scene::model::Placed;
use dotray::scene::resolve::resolve_texture;
use dotray::scene::resolved::ResolvedTexture;
use dotray::scene::similar::similar_file;
use dotray::scene::sources::Sources;
use dotray::scene::span::FileId;
use dotray::scene::span::Span;
use std::collections::HashMap;
use std::io;
use std::path::Path;
use std::path::PathBuf;

/// No picture of a texture's size limit is larger on disk.
const MOST_BYTES: u64 = 4 << 30;

/// Looks textures up; what several scenes name is decoded once.
pub struct Textures<'a> {
    files: &'a dyn Files,
    /// What is wrong with a file; nothing is.
    seen: HashMap<PathBuf, Option<String>>,
}

impl<'a> Textures<'a> {
    /// None looked up yet.
    pub fn new(files: &'a dyn Files) -> Self {
        Self { files, seen: HashMap::new() }
    }

    /// An error for each texture that is not there or is no picture.
    pub fn check(&mut self, textures: &[ResolvedTexture]) -> Vec<Diagnostic> {
        textures.iter().filter_map(|texture| self.check_one(texture)).collect()
    }

    fn check_one(&mut self, texture: &ResolvedTexture) -> Option<Diagnostic> {
        let mut refused = Vec::new();
        for path in &texture.candidates {
            let known = self.seen.get(path).cloned();
            let fault = match known {
                Some(fault) => fault,
                None => match self.files.read_at_most(path, MOST_BYTES) {
                    Ok(bytes) => fault_of(path, &bytes),
                    Err(error) if error.kind() == io::ErrorKind::NotFound => continue,
                    Err(error) => {
                        refused.push(format!("cannot read `{}`: {error}", path.display()));
                        continue;
                    }
                },
            };
            self.seen.insert(path.clone(), fault.clone());
            return fault.map(|fault| unreadable(texture, path, &fault));
        }
        Some(not_found(self.files, texture, refused))
    }
}

fn fault_of(path: &Path, bytes: &[u8]) -> Option<String> {
    decode(bytes, Format::from_path(path).ok(), &Limits::default()).err().map(|error| error.to_string())
}

fn unreadable(texture: &ResolvedTexture, path: &Path, fault: &str) -> Diagnostic {
    let message = format!("the texture `{}` cannot be decoded: {fault}", texture.name);
    Diagnostic::error("texture-unreadable", message)
        .at(texture.span)
        .label("named here")
        .note(format!("the file is `{}`", path.display()))
        .help("save it anew as PNG, JPEG, BMP, PPM, QOI, TIFF, HDR or EXR")
}

fn not_found(files: &dyn Files, texture: &ResolvedTexture, refused: Vec<String>) -> Diagnostic {
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
    match texture.candidates.iter().find_map(|path| similar_file(files, path)) {
        Some(similar) => error.help(format!("there is a file `{similar}`")),
        None => error.help("a texture's name is relative to the folder of its .ray file"),
    }
}

/// The textures that a scene names, taken from its tokens: also those of a scene that has faults elsewhere.
pub fn named_in(sources: &Sources) -> Vec<ResolvedTexture> {
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
                    found.push(resolve_texture(sources.path(file), &Placed { value, span }));
                }
                TokenKind::Directive => lexer.go_to(name.start),
                TokenKind::Text => {}
            }
        }
    }
    found
}

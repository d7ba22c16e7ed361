//! Whether a scene's textures are there and can be decoded.

use dotray::image::Format;
use dotray::image::Limits;
use dotray::image::decode;
use dotray::scene::Diagnostic;
use dotray::scene::Files;
use dotray::scene::resolved::ResolvedTexture;
use dotray::scene::textures::Hints;
use dotray::scene::textures::not_found;
use dotray::scene::textures::unreadable;
use std::collections::HashMap;
use std::io;
use std::path::Path;
use std::path::PathBuf;

/// No picture of a texture's size limit is larger on disk.
const MOST_BYTES: u64 = 4 << 30;

/// Looks textures up; what several scenes name is decoded once.
pub struct Textures<'a> {
    files: &'a dyn Files,
    hints: Hints<'a>,
    /// What is wrong with a file; nothing is.
    seen: HashMap<PathBuf, Option<String>>,
}

impl<'a> Textures<'a> {
    /// None looked up yet.
    pub fn new(files: &'a dyn Files) -> Self {
        Self { files, hints: Hints::new(files), seen: HashMap::new() }
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
        Some(not_found(&mut self.hints, texture, refused))
    }
}

fn fault_of(path: &Path, bytes: &[u8]) -> Option<String> {
    decode(bytes, Format::from_path(path).ok(), &Limits::default()).err().map(|error| error.to_string())
}

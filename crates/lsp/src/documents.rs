//! The texts that are open in the editor, and files as the editor sees them.

use crate::paths::path_of;
use crate::paths::uri_of;
use crate::text::replace;
use dotray_scene::Dialect;
use dotray_scene::Files;
use dotray_scene::files::Disk;
use lsp_types::TextDocumentContentChangeEvent;
use lsp_types::Uri;
use std::collections::BTreeMap;
use std::io;
use std::path::Path;
use std::path::PathBuf;

/// Larger texts are kept, but nothing is found out about them: an answer to every stroke of a key would come too late.
pub const MOST_BYTES: usize = 16 << 20;

/// A text that is open in the editor.
#[derive(Debug)]
pub struct Document {
    /// Its address as the editor writes it.
    pub uri: Uri,
    /// Its path.
    pub path: PathBuf,
    /// A path that is equal for two names of the same file.
    pub identity: PathBuf,
    /// The number of its last change.
    pub version: i32,
    /// What it holds now.
    pub bytes: Vec<u8>,
    /// Whether it, or what it includes, has changed since it was last looked at.
    pub stale: bool,
    /// The dialect that the last look at it found.
    pub dialect: Dialect,
}

impl Document {
    /// A text as it is opened.
    pub fn new(uri: Uri, version: i32, text: String) -> Self {
        let path = path_of(&uri);
        let identity = Disk.identity(&path);
        let bytes = text.into_bytes();
        Self { uri, path, identity, version, bytes, stale: true, dialect: Dialect::default() }
    }

    /// Takes changes over, one after the other.
    pub fn change(&mut self, version: i32, changes: Vec<TextDocumentContentChangeEvent>) {
        self.version = version;
        self.stale = true;
        for change in changes {
            match change.range {
                Some(range) => replace(&mut self.bytes, range, &change.text),
                None => self.bytes = change.text.into_bytes(),
            }
        }
    }

    /// Whether it is too large to be looked at.
    pub fn is_too_large(&self) -> bool {
        self.bytes.len() > MOST_BYTES
    }
}

/// The open texts by their addresses.
pub type Documents = BTreeMap<String, Document>;

/// Files as the editor sees them: an open text stands for what is on disk.
pub struct Overlay<'a>(pub &'a Documents);

impl Overlay<'_> {
    fn open(&self, path: &Path) -> Option<&[u8]> {
        let identity = Disk.identity(path);
        let document = self.0.values().find(|document| document.identity == identity)?;
        Some(&document.bytes)
    }

    /// The address of a path, as the editor writes it where the file is open.
    pub fn uri(&self, path: &Path) -> Option<Uri> {
        let identity = Disk.identity(path);
        let open = self.0.values().find(|document| document.identity == identity);
        open.map(|document| document.uri.clone()).or_else(|| uri_of(path))
    }
}

impl Files for Overlay<'_> {
    fn read(&self, path: &Path) -> io::Result<Vec<u8>> {
        self.open(path).map_or_else(|| Disk.read(path), |bytes| Ok(bytes.to_vec()))
    }

    fn read_at_most(&self, path: &Path, limit: u64) -> io::Result<Vec<u8>> {
        match self.open(path) {
            Some(bytes) if bytes.len() as u64 > limit => Err(io::ErrorKind::FileTooLarge.into()),
            Some(bytes) => Ok(bytes.to_vec()),
            // A pipe or a device might never answer.
            None if std::fs::metadata(path).is_ok_and(|data| !data.is_file()) => {
                Err(io::Error::other("it is no file"))
            }
            None => Disk.read_at_most(path, limit),
        }
    }

    fn identity(&self, path: &Path) -> PathBuf {
        Disk.identity(path)
    }

    fn names_in(&self, folder: &Path) -> Vec<String> {
        Disk.names_in(folder)
    }
}

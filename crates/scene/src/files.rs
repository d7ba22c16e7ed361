//! Where files come from: a disk, a page, a test.

use std::io;
use std::path::Path;

/// Reads files for the parser and for textures.
pub trait Files {
    /// The whole content of `path`.
    ///
    /// # Errors
    /// What the system says.
    fn read(&self, path: &Path) -> io::Result<Vec<u8>>;
}

/// The machine's own disk.
#[derive(Clone, Copy, Debug, Default)]
pub struct Disk;

impl Files for Disk {
    fn read(&self, path: &Path) -> io::Result<Vec<u8>> {
        std::fs::read(path)
    }
}

//! Files that a scene brings along, so that it can travel to another machine.

use dotray_scene::Files;
use dotray_scene::files::Disk;
use std::collections::HashMap;
use std::io;
use std::path::Path;
use std::path::PathBuf;

/// Files in memory; what is not there is read from disk.
#[derive(Clone, Debug, Default)]
pub struct Carried {
    /// The files by their paths as the scene names them.
    pub files: HashMap<PathBuf, Vec<u8>>,
}

impl Files for Carried {
    fn read(&self, path: &Path) -> io::Result<Vec<u8>> {
        self.read_at_most(path, u64::MAX)
    }

    fn read_at_most(&self, path: &Path, limit: u64) -> io::Result<Vec<u8>> {
        match self.files.get(path) {
            Some(bytes) if bytes.len() as u64 > limit => Err(io::ErrorKind::FileTooLarge.into()),
            Some(bytes) => Ok(bytes.clone()),
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

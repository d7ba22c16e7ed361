//! Files that were dropped on a page: no folders, so each is found by its name alone.

use dotray_scene::Files;
use std::collections::BTreeMap;
use std::io;
use std::path::Path;

/// Files by name, capitals or not.
#[derive(Clone, Debug, Default)]
pub struct Dropped {
    files: BTreeMap<String, Vec<u8>>,
}

/// A path's last part, in small letters.
fn key(path: &Path) -> String {
    path.file_name().unwrap_or(path.as_os_str()).to_string_lossy().to_lowercase()
}

impl Dropped {
    /// Takes a file; one of the same name is replaced.
    pub fn add(&mut self, path: &Path, content: Vec<u8>) {
        self.files.insert(key(path), content);
    }

    /// What a file holds.
    pub fn content(&self, path: &Path) -> Option<&[u8]> {
        self.files.get(&key(path)).map(Vec::as_slice)
    }

    /// The names.
    pub fn names(&self) -> impl Iterator<Item = &str> {
        self.files.keys().map(String::as_str)
    }
}

impl Files for Dropped {
    fn read(&self, path: &Path) -> io::Result<Vec<u8>> {
        let missing = || io::Error::new(io::ErrorKind::NotFound, "not among the files that were dropped");
        self.content(path).map(<[u8]>::to_vec).ok_or_else(missing)
    }

    fn identity(&self, path: &Path) -> std::path::PathBuf {
        key(path).into()
    }

    fn names_in(&self, _: &Path) -> Vec<String> {
        self.files.keys().cloned().collect()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn files_are_found_by_name_alone() {
        let mut dropped = Dropped::default();
        dropped.add(Path::new("Wood.PNG"), vec![1, 2]);
        assert_eq!(dropped.read(Path::new("textures/wood.png")).unwrap(), [1, 2]);
        assert_eq!(dropped.read(Path::new("stone.png")).unwrap_err().kind(), io::ErrorKind::NotFound);
        assert_eq!(
            dropped.read_at_most(Path::new("wood.png"), 1).unwrap_err().kind(),
            io::ErrorKind::FileTooLarge
        );
        assert_eq!(dropped.names_in(Path::new("")), ["wood.png"]);
    }
}

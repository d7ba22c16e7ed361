//! A scene with all that it is made of, to be read somewhere else.

use dotray_scene::Files;
use std::collections::BTreeMap;
use std::io;
use std::path::Path;
use std::path::PathBuf;
use std::sync::Mutex;
use std::sync::PoisonError;

/// Files by the paths under which a scene asks for them.
#[derive(Debug, Default)]
pub struct Bundle {
    files: Mutex<BTreeMap<PathBuf, Vec<u8>>>,
}

impl Bundle {
    /// Of these files.
    pub fn new(files: Vec<(String, Vec<u8>)>) -> Self {
        let bundle = Self::default();
        files.into_iter().for_each(|(path, bytes)| bundle.add(Path::new(&path), bytes));
        bundle
    }

    fn with<T>(&self, look: impl FnOnce(&mut BTreeMap<PathBuf, Vec<u8>>) -> T) -> T {
        look(&mut self.files.lock().unwrap_or_else(PoisonError::into_inner))
    }

    /// Whether there is nothing in it.
    pub fn is_empty(&self) -> bool {
        self.with(|files| files.is_empty())
    }

    /// Whether there is a file of this path.
    pub fn contains(&self, path: &Path) -> bool {
        self.with(|files| files.contains_key(&self.identity(path)))
    }

    /// Takes a file; one of the same path is replaced.
    pub fn add(&self, path: &Path, bytes: Vec<u8>) {
        self.with(|files| files.insert(self.identity(path), bytes));
    }

    /// The paths.
    pub fn paths(&self) -> Vec<PathBuf> {
        self.with(|files| files.keys().cloned().collect())
    }

    /// All files.
    pub fn files(&self) -> Vec<(String, Vec<u8>)> {
        let named =
            |(path, bytes): (&PathBuf, &Vec<u8>)| (path.to_string_lossy().into_owned(), bytes.clone());
        self.with(|files| files.iter().map(named).collect())
    }

    /// Whether another one has the same files.
    pub fn is_same(&self, other: &Self) -> bool {
        std::ptr::eq(self, other) || self.with(|files| other.with(|others| files == others))
    }

    /// The bytes of all files together.
    pub fn size(&self) -> u64 {
        self.with(|files| files.values().map(|bytes| bytes.len() as u64).sum())
    }
}

impl Files for Bundle {
    fn read(&self, path: &Path) -> io::Result<Vec<u8>> {
        let found = self.with(|files| files.get(&self.identity(path)).cloned());
        found.ok_or_else(|| io::Error::new(io::ErrorKind::NotFound, "no such file"))
    }

    fn names_in(&self, folder: &Path) -> Vec<String> {
        let folder = self.identity(folder);
        let inside = |path: &&PathBuf| path.parent() == Some(folder.as_path());
        let name = |path: &PathBuf| path.file_name().map(|name| name.to_string_lossy().into_owned());
        self.with(|files| files.keys().filter(inside).filter_map(name).collect())
    }
}

/// Reads other files and keeps what was read.
pub struct Recorder<'a> {
    files: &'a dyn Files,
    kept: Bundle,
    most: u64,
}

impl<'a> Recorder<'a> {
    /// Keeps up to so many bytes; beyond, files are too large to be read.
    pub fn new(files: &'a dyn Files, most: u64) -> Self {
        Self { files, kept: Bundle::default(), most }
    }

    /// What was read.
    pub fn kept(self) -> Bundle {
        self.kept
    }
}

impl Files for Recorder<'_> {
    fn read(&self, path: &Path) -> io::Result<Vec<u8>> {
        self.read_at_most(path, u64::MAX)
    }

    fn read_at_most(&self, path: &Path, limit: u64) -> io::Result<Vec<u8>> {
        if self.kept.contains(path) {
            return self.kept.read_at_most(path, limit);
        }
        let bytes = self.files.read_at_most(path, limit.min(self.most.saturating_sub(self.kept.size())))?;
        self.kept.add(path, bytes.clone());
        Ok(bytes)
    }

    fn identity(&self, path: &Path) -> PathBuf {
        self.files.identity(path)
    }

    fn names_in(&self, folder: &Path) -> Vec<String> {
        self.files.names_in(folder)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_was_read_can_be_read_again_elsewhere() {
        let there = Bundle::new(vec![("a/b.ray".into(), vec![1, 2]), ("a/c.png".into(), vec![3; 10])]);
        let recorder = Recorder::new(&there, 100);
        assert_eq!(recorder.read(Path::new("a/x/../b.ray")).unwrap(), [1, 2]);
        assert!(recorder.read(Path::new("a/d.png")).is_err());
        let kept = recorder.kept();
        assert_eq!(kept.files(), [("a/b.ray".to_owned(), vec![1, 2])]);
        assert_eq!(kept.read(Path::new("a/./b.ray")).unwrap(), [1, 2]);
        assert_eq!(there.names_in(Path::new("a")), ["b.ray", "c.png"]);
    }

    #[test]
    fn no_more_is_kept_than_was_allowed() {
        let there = Bundle::new(vec![("a".into(), vec![0; 60]), ("b".into(), vec![0; 60])]);
        let recorder = Recorder::new(&there, 100);
        assert!(recorder.read(Path::new("a")).is_ok());
        assert_eq!(recorder.read(Path::new("b")).unwrap_err().kind(), io::ErrorKind::FileTooLarge);
    }
}

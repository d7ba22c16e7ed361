//! Where files come from: a disk, a page, a test.

use std::fs::File;
use std::io;
use std::io::Read;
use std::path::Component;
use std::path::Path;
use std::path::PathBuf;

/// Reads files for the parser and for textures.
pub trait Files {
    /// The whole content of `path`.
    ///
    /// # Errors
    /// What the system says.
    fn read(&self, path: &Path) -> io::Result<Vec<u8>>;

    /// The whole content of `path` if it has at most `limit` bytes, without taking memory for more.
    ///
    /// # Errors
    /// What the system says; [`io::ErrorKind::FileTooLarge`] where there is more.
    fn read_at_most(&self, path: &Path, limit: u64) -> io::Result<Vec<u8>> {
        let content = self.read(path)?;
        if content.len() as u64 > limit { Err(io::ErrorKind::FileTooLarge.into()) } else { Ok(content) }
    }

    /// A path that is equal for two names of the same file.
    fn identity(&self, path: &Path) -> PathBuf {
        without_dots(path)
    }

    /// The names of some files in a folder, for 'did you mean'; may be empty.
    fn names_in(&self, folder: &Path) -> Vec<String> {
        let _ = folder;
        Vec::new()
    }
}

/// The machine's own disk.
#[derive(Clone, Copy, Debug, Default)]
pub struct Disk;

impl Files for Disk {
    fn read(&self, path: &Path) -> io::Result<Vec<u8>> {
        std::fs::read(path)
    }

    fn read_at_most(&self, path: &Path, limit: u64) -> io::Result<Vec<u8>> {
        let mut file = File::open(path)?;
        let size = file.metadata()?.len();
        if size > limit {
            return Err(io::ErrorKind::FileTooLarge.into());
        }
        // A pipe or a device tells no size and may never end, so the limit holds while reading, too.
        let mut content = Vec::with_capacity(usize::try_from(size).unwrap_or(0));
        let read = file.by_ref().take(limit.saturating_add(1)).read_to_end(&mut content)?;
        if read as u64 > limit { Err(io::ErrorKind::FileTooLarge.into()) } else { Ok(content) }
    }

    fn identity(&self, path: &Path) -> PathBuf {
        std::fs::canonicalize(path).unwrap_or_else(|_| without_dots(path))
    }

    fn names_in(&self, folder: &Path) -> Vec<String> {
        const ENOUGH: usize = 2000;
        let folder = if folder.as_os_str().is_empty() { Path::new(".") } else { folder };
        let entries = std::fs::read_dir(folder).into_iter().flatten().take(ENOUGH);
        let mut names: Vec<String> =
            entries.flatten().filter_map(|entry| entry.file_name().into_string().ok()).collect();
        names.sort();
        names
    }
}

/// The path without `.` and without `folder/..`, judged by the text alone.
fn without_dots(path: &Path) -> PathBuf {
    let mut short = PathBuf::new();
    for part in path.components() {
        match part {
            Component::CurDir => {}
            Component::ParentDir if matches!(short.components().next_back(), Some(Component::Normal(_))) => {
                short.pop();
            }
            Component::ParentDir | Component::Normal(_) | Component::RootDir | Component::Prefix(_) => {
                short.push(part);
            }
        }
    }
    short
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn dots_vanish_where_the_text_allows() {
        let cases =
            [("a/./b", "a/b"), ("a/../b", "b"), ("../a", "../a"), ("a/b/../../c", "c"), ("/a/../b", "/b")];
        for (long, short) in cases {
            assert_eq!(without_dots(Path::new(long)), Path::new(short), "{long}");
        }
    }

    #[test]
    fn the_limit_holds_on_disk() {
        let path = Path::new(env!("CARGO_MANIFEST_DIR")).join("Cargo.toml");
        let size = Disk.read(&path).unwrap().len() as u64;
        assert!(Disk.read_at_most(&path, size).is_ok());
        assert_eq!(Disk.read_at_most(&path, size - 1).unwrap_err().kind(), io::ErrorKind::FileTooLarge);
    }
}

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

    /// The same for a file that the caller names himself, not a scene: on a disk it may be a pipe.
    ///
    /// # Errors
    /// As [`Files::read_at_most`].
    fn read_asked_for(&self, path: &Path, limit: u64) -> io::Result<Vec<u8>> {
        self.read_at_most(path, limit)
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

/// The machine's own disk. What a scene names must be a file: a pipe may never open and a device never end.
#[derive(Clone, Copy, Debug, Default)]
pub struct Disk;

impl Files for Disk {
    fn read(&self, path: &Path) -> io::Result<Vec<u8>> {
        self.read_at_most(path, u64::MAX)
    }

    fn read_at_most(&self, path: &Path, limit: u64) -> io::Result<Vec<u8>> {
        // Only opening a pipe can take forever, so this is asked before.
        let kind = std::fs::metadata(path)?.file_type();
        if kind.is_file() {
            return self.read_asked_for(path, limit);
        }
        Err(io::Error::other(if kind.is_dir() {
            "it is a folder"
        } else {
            "it is no file but a pipe or a device"
        }))
    }

    fn read_asked_for(&self, path: &Path, limit: u64) -> io::Result<Vec<u8>> {
        let mut file = File::open(path)?;
        let size = file.metadata()?.len();
        if size > limit {
            return Err(io::ErrorKind::FileTooLarge.into());
        }
        // A pipe or a device tells no size and may never end, so the limit holds while reading, too.
        let mut content = Vec::new();
        content
            .try_reserve(usize::try_from(size).unwrap_or(usize::MAX))
            .map_err(|_| io::ErrorKind::OutOfMemory)?;
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

/// Files in and below one folder only, however they are named: links are followed first.
#[derive(Clone, Debug)]
pub struct Confined<F> {
    files: F,
    folder: PathBuf,
}

/// Why a file outside of [`Confined`]'s folder is not read.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
#[error("it lies outside of `{}`, and nothing outside is read", .0.display())]
pub struct Outside(PathBuf);

/// Whether an error is [`Confined`]'s own.
pub fn is_outside(error: &io::Error) -> bool {
    error.get_ref().is_some_and(|inner| inner.is::<Outside>())
}

impl<F: Files> Confined<F> {
    /// Files that lie in or below `folder`.
    ///
    /// # Errors
    /// What the system says where there is no such folder.
    pub fn new(files: F, folder: &Path) -> io::Result<Self> {
        Ok(Self { files, folder: std::fs::canonicalize(folder)? })
    }

    /// The path without links, if it lies inside. Whether a file outside exists is not told.
    fn inside(&self, path: &Path) -> io::Result<PathBuf> {
        let outside = || io::Error::new(io::ErrorKind::PermissionDenied, Outside(self.folder.clone()));
        let real = std::fs::canonicalize(path).or_else(|fault| {
            // What is not there may be looked for only in folders inside.
            let parent =
                path.parent().filter(|parent| !parent.as_os_str().is_empty()).unwrap_or(Path::new("."));
            match std::fs::canonicalize(parent) {
                Ok(parent) if parent.starts_with(&self.folder) => Err(fault),
                Ok(_) | Err(_) => {
                    let whole = without_dots(&std::path::absolute(path)?);
                    Err(if whole.starts_with(&self.folder) { fault } else { outside() })
                }
            }
        })?;
        if real.starts_with(&self.folder) { Ok(real) } else { Err(outside()) }
    }
}

impl<F: Files> Files for Confined<F> {
    fn read(&self, path: &Path) -> io::Result<Vec<u8>> {
        self.files.read(&self.inside(path)?)
    }

    fn read_at_most(&self, path: &Path, limit: u64) -> io::Result<Vec<u8>> {
        self.files.read_at_most(&self.inside(path)?, limit)
    }

    fn identity(&self, path: &Path) -> PathBuf {
        self.inside(path).map_or_else(|_| without_dots(path), |path| self.files.identity(&path))
    }

    fn names_in(&self, folder: &Path) -> Vec<String> {
        let folder = if folder.as_os_str().is_empty() { Path::new(".") } else { folder };
        self.inside(folder).map_or_else(|_| Vec::new(), |folder| self.files.names_in(&folder))
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

    #[test]
    fn nothing_outside_of_a_folder_is_read() {
        let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("src");
        let confined = Confined::new(Disk, &folder).unwrap();
        let read = |name: &str| confined.read_at_most(&folder.join(name), 1 << 20);
        assert!(read("lib.rs").is_ok() && read("parse/../lib.rs").is_ok() && read("../src/lib.rs").is_ok());
        assert_eq!(read("nothing.rs").unwrap_err().kind(), io::ErrorKind::NotFound);
        for name in ["../Cargo.toml", "/etc/passwd", "../nothing", "/no/thing", "parse/../../Cargo.toml"] {
            assert!(is_outside(&read(name).unwrap_err()), "{name}");
        }
        assert!(!is_outside(&read("nothing.rs").unwrap_err()));
        assert!(confined.names_in(&folder.join("..")).is_empty() && !confined.names_in(&folder).is_empty());
        assert!(Confined::new(Disk, Path::new("/no/such/folder")).is_err());
    }

    #[cfg(target_os = "linux")]
    #[test]
    fn devices_are_no_files() {
        assert!(Disk.read(Path::new("/dev/zero")).unwrap_err().to_string().contains("device"));
        assert!(Disk.read(Path::new("/")).unwrap_err().to_string().contains("folder"));
        let fault = Disk.read_asked_for(Path::new("/dev/zero"), 1000).unwrap_err();
        assert_eq!(fault.kind(), io::ErrorKind::FileTooLarge);
    }
}

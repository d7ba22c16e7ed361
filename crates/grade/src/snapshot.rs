//! The files of a scene, read before any program runs: no program can change them for another test.

use dotray_scene::Files;
use dotray_scene::files::Confined;
use dotray_scene::files::Disk;
use std::collections::BTreeMap;
use std::io;
use std::path::Path;
use std::path::PathBuf;
use std::sync::Mutex;

/// Files in memory, by their paths below the suite's folder.
#[derive(Clone, Debug, Default)]
pub struct Snapshot {
    files: BTreeMap<PathBuf, Vec<u8>>,
}

impl Snapshot {
    /// Writes copies below `folder`.
    ///
    /// # Errors
    /// The system's, where a file or folder cannot be made.
    pub fn write_below(&self, folder: &Path) -> io::Result<()> {
        for (path, content) in &self.files {
            let copy = folder.join(path);
            if let Some(parent) = copy.parent() {
                std::fs::create_dir_all(parent)?;
            }
            std::fs::write(copy, content)?;
        }
        Ok(())
    }
}

impl Files for Snapshot {
    fn read(&self, path: &Path) -> io::Result<Vec<u8>> {
        self.files.get(&self.identity(path)).cloned().ok_or_else(|| io::ErrorKind::NotFound.into())
    }
}

/// The disk below a folder, remembering what was read.
#[derive(Debug)]
pub struct Recorder {
    disk: io::Result<Confined<Disk>>,
    folder: PathBuf,
    files: Mutex<BTreeMap<PathBuf, Vec<u8>>>,
}

impl Recorder {
    /// Reads below `folder` only.
    pub fn new(folder: &Path) -> Self {
        Self { disk: Confined::new(Disk, folder), folder: folder.to_owned(), files: Mutex::default() }
    }

    /// All that was read.
    pub fn snapshot(self) -> Snapshot {
        Snapshot { files: self.files.into_inner().unwrap_or_default() }
    }
}

impl Files for Recorder {
    fn read(&self, path: &Path) -> io::Result<Vec<u8>> {
        self.read_at_most(path, u64::MAX)
    }

    fn read_at_most(&self, path: &Path, limit: u64) -> io::Result<Vec<u8>> {
        let path = self.identity(path);
        let inside = !path.is_absolute() && !path.starts_with("..");
        if !inside {
            return Err(io::Error::other("it lies outside the suite's folder"));
        }
        // A link inside may lead outside, too.
        let disk = self.disk.as_ref().map_err(|fault| io::Error::from(fault.kind()))?;
        let content = disk.read_at_most(&self.folder.join(&path), limit)?;
        if let Ok(mut files) = self.files.lock() {
            files.insert(path, content.clone());
        }
        Ok(content)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_was_read_can_be_read_again_and_copied() {
        let [from, to] = [(); 2].map(|()| tempfile::tempdir().unwrap());
        std::fs::create_dir(from.path().join("deep")).unwrap();
        std::fs::write(from.path().join("deep/a"), "x").unwrap();
        let recorder = Recorder::new(from.path());
        assert_eq!(recorder.read(Path::new("deep/../deep/a")).unwrap(), b"x");
        assert!(recorder.read(Path::new("../a")).unwrap_err().to_string().contains("outside"));
        assert!(recorder.read(&from.path().join("deep/a")).is_err());
        #[cfg(unix)]
        for (name, target) in [("inner", "deep/a"), ("outer", "/etc/hostname")] {
            std::os::unix::fs::symlink(target, from.path().join(name)).unwrap();
            let read = recorder.read(Path::new(name));
            assert_eq!(read.is_ok(), name == "inner", "{read:?}");
        }
        let snapshot = recorder.snapshot();
        assert_eq!(snapshot.read(Path::new("./deep/a")).unwrap(), b"x");
        assert!(snapshot.read(Path::new("deep/b")).is_err());
        snapshot.write_below(to.path()).unwrap();
        assert_eq!(std::fs::read(to.path().join("deep/a")).unwrap(), b"x");
    }
}

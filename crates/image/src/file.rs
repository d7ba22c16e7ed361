//! Storing a file whole or not at all.

use std::fs;
use std::fs::File;
use std::fs::OpenOptions;
use std::io;
use std::io::Write;
use std::path::Path;
use std::path::PathBuf;
use std::sync::atomic::AtomicU64;
use std::sync::atomic::Ordering;

/// Writes a file whole or not at all: whoever looks finds the old content or the new, never a part of it.
///
/// The bytes go to a new file in the same folder, which then takes the name. A symbolic link stays, and what it points
/// to is replaced; permissions of a file that is replaced are kept; a write-protected one is not replaced. What is no
/// regular file (a pipe, `/dev/stdout`) is written to directly.
///
/// # Errors
/// The error of the system, with the path in its text; what was there before is then still there, and nothing else is
/// left behind.
pub fn write_file(path: &Path, bytes: &[u8]) -> io::Result<()> {
    write_files(&[(path, bytes)])
}

/// Writes several files, all of them or none: each goes whole to a file beside its place, as [`write_file`] says, and
/// only when all are there do they take their names.
///
/// # Errors
/// The error of the system, with the path in its text; no file has changed then, unless the system fails while names
/// are being given.
pub fn write_files(files: &[(&Path, &[u8])]) -> io::Result<()> {
    let told = |path: &Path, error: io::Error| {
        io::Error::new(error.kind(), format!("cannot write {}: {error}", path.display()))
    };
    let ready = |&(path, bytes): &(&Path, &[u8])| match prepare(path, |file| file.write_all(bytes)) {
        Ok(ready) => Ok((path.to_path_buf(), ready)),
        Err(error) => Err(told(path, error)),
    };
    let ready: Vec<(PathBuf, Option<Ready>)> = files.iter().map(ready).collect::<io::Result<_>>()?;
    for (path, ready) in ready {
        ready.map_or(Ok(()), Ready::take_name).map_err(|error| told(&path, error))?;
    }
    Ok(())
}

/// A file that is there whole but for its name; whoever drops it before removes it.
struct Ready {
    temporary: PathBuf,
    target: PathBuf,
}

impl Ready {
    fn take_name(self) -> io::Result<()> {
        fs::rename(&self.temporary, &self.target)
    }
}

impl Drop for Ready {
    fn drop(&mut self) {
        // Where it has taken its name there is nothing to remove, and nothing more can be done if this fails.
        let _ = fs::remove_file(&self.temporary);
    }
}

/// Writes the file beside its place; what is no regular file is written to at once.
fn prepare(path: &Path, write: impl FnOnce(&mut File) -> io::Result<()>) -> io::Result<Option<Ready>> {
    let target = final_target(path)?;
    let old = match fs::metadata(&target) {
        Ok(metadata) if metadata.is_dir() => {
            return Err(io::Error::new(io::ErrorKind::IsADirectory, "it is a folder"));
        }
        Ok(metadata) if !metadata.is_file() => {
            return write(&mut OpenOptions::new().write(true).open(&target)?).map(|()| None);
        }
        Ok(metadata) if metadata.permissions().readonly() => {
            return Err(io::Error::new(io::ErrorKind::PermissionDenied, "the file is write-protected"));
        }
        Ok(metadata) => Some(metadata),
        Err(error) if error.kind() == io::ErrorKind::NotFound => None,
        Err(error) => return Err(error),
    };
    let (mut file, temporary) = create_beside(&target)?;
    let ready = Ready { temporary, target };
    write(&mut file)?;
    file.flush()?;
    if let Some(old) = &old {
        // A file system without permissions must not cost the picture.
        let _ = file.set_permissions(old.permissions());
    }
    // Without this the name could reach the disk before the bytes do.
    file.sync_all()?;
    Ok(Some(ready))
}

/// Where a chain of symbolic links ends, even if nothing is there yet.
fn final_target(path: &Path) -> io::Result<PathBuf> {
    // As many links as Linux follows.
    const MOST_LINKS: usize = 40;
    let mut target = path.to_path_buf();
    for _ in 0..MOST_LINKS {
        match fs::symlink_metadata(&target) {
            Ok(metadata) if metadata.is_symlink() => {
                let link = fs::read_link(&target)?;
                target = target.parent().map(|folder| folder.join(&link)).unwrap_or(link);
            }
            Ok(_) | Err(_) => return Ok(target),
        }
    }
    Err(io::Error::other("too many symbolic links follow each other"))
}

/// A new file in the folder of `target`, under a name that nothing else has.
fn create_beside(target: &Path) -> io::Result<(File, PathBuf)> {
    static COUNTER: AtomicU64 = AtomicU64::new(0);
    let mut attempts = 0;
    loop {
        let number = COUNTER.fetch_add(1, Ordering::Relaxed);
        let temporary = target.with_file_name(format!(".dotray-{}-{number}.tmp", std::process::id()));
        match OpenOptions::new().write(true).create_new(true).open(&temporary) {
            Ok(file) => return Ok((file, temporary)),
            // Left by a process that had the same number and was killed.
            Err(error) if error.kind() == io::ErrorKind::AlreadyExists && attempts < 1000 => attempts += 1,
            Err(error) => return Err(error),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn names(folder: &Path) -> Vec<String> {
        let entries = fs::read_dir(folder).unwrap();
        let mut names: Vec<_> =
            entries.map(|entry| entry.unwrap().file_name().to_string_lossy().into_owned()).collect();
        names.sort();
        names
    }

    #[test]
    fn writes_and_replaces() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("a.bmp");
        write_file(&path, b"first, longer").unwrap();
        write_file(&path, b"second").unwrap();
        assert_eq!(fs::read(&path).unwrap(), b"second");
        assert_eq!(names(folder.path()), ["a.bmp"]);
    }

    #[test]
    fn a_failed_write_keeps_the_old_file() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("a.bmp");
        write_file(&path, b"old").unwrap();
        let failed = prepare(&path, |file| {
            file.write_all(b"half of the ne")?;
            Err(io::Error::other("disk full"))
        });
        assert_eq!(failed.err().unwrap().to_string(), "disk full");
        assert_eq!(fs::read(&path).unwrap(), b"old");
        assert_eq!(names(folder.path()), ["a.bmp"]);
    }

    #[test]
    fn of_several_files_all_are_written_or_none() {
        let folder = tempfile::tempdir().unwrap();
        let [a, b, c] = ["a.png", "a.depth.png", "a.normal.png"].map(|name| folder.path().join(name));
        write_files(&[(&a, b"1"), (&b, b"2")]).unwrap();
        assert_eq!(names(folder.path()), ["a.depth.png", "a.png"]);
        // The last one's place is taken by a folder: the others stay as they were.
        fs::create_dir(&c).unwrap();
        let message = write_files(&[(&a, b"3"), (&b, b"4"), (&c, b"5")]).unwrap_err().to_string();
        assert!(message.contains("a.normal.png") && message.contains("folder"), "{message}");
        assert_eq!((fs::read(&a).unwrap(), fs::read(&b).unwrap()), (b"1".to_vec(), b"2".to_vec()));
        assert_eq!(names(folder.path()), ["a.depth.png", "a.normal.png", "a.png"]);
    }

    #[test]
    fn write_protected_files_and_folders_are_kept() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("a.bmp");
        write_file(&path, b"old").unwrap();
        let mut permissions = fs::metadata(&path).unwrap().permissions();
        permissions.set_readonly(true);
        fs::set_permissions(&path, permissions).unwrap();
        let message = write_file(&path, b"new").unwrap_err().to_string();
        assert!(message.contains("a.bmp") && message.contains("write-protected"), "{message}");
        assert_eq!(fs::read(&path).unwrap(), b"old");
        fs::create_dir(folder.path().join("b.bmp")).unwrap();
        assert!(write_file(&folder.path().join("b.bmp"), b"new").is_err());
        assert!(write_file(&folder.path().join("missing/c.bmp"), b"new").is_err());
        assert!(write_file(&path.join("c.bmp"), b"new").is_err());
        assert!(write_file(Path::new(""), b"new").is_err());
        assert_eq!(names(folder.path()), ["a.bmp", "b.bmp"]);
    }

    #[cfg(unix)]
    #[test]
    fn unwritable_folders_give_an_error() {
        use std::os::unix::fs::PermissionsExt;
        let folder = tempfile::tempdir().unwrap();
        fs::set_permissions(folder.path(), fs::Permissions::from_mode(0o555)).unwrap();
        if File::create(folder.path().join("probe")).is_ok() {
            println!("skipped, this user may write everywhere");
            return;
        }
        assert!(write_file(&folder.path().join("a.bmp"), b"new").is_err());
        fs::set_permissions(folder.path(), fs::Permissions::from_mode(0o755)).unwrap();
        assert!(names(folder.path()).is_empty());
    }

    #[cfg(unix)]
    #[test]
    fn links_and_permissions_stay() {
        use std::os::unix::fs::PermissionsExt;
        use std::os::unix::fs::symlink;
        let folder = tempfile::tempdir().unwrap();
        let at = |name: &str| folder.path().join(name);
        fs::create_dir(at("deep")).unwrap();
        symlink("deep/real.bmp", at("link.bmp")).unwrap();
        write_file(&at("link.bmp"), b"through a link to nothing yet").unwrap();
        fs::set_permissions(at("deep/real.bmp"), fs::Permissions::from_mode(0o640)).unwrap();
        write_file(&at("link.bmp"), b"new").unwrap();
        assert!(fs::symlink_metadata(at("link.bmp")).unwrap().is_symlink());
        assert_eq!(fs::read(at("deep/real.bmp")).unwrap(), b"new");
        assert_eq!(fs::metadata(at("deep/real.bmp")).unwrap().permissions().mode() & 0o777, 0o640);
        symlink("loop.bmp", at("loop.bmp")).unwrap();
        assert!(write_file(&at("loop.bmp"), b"new").is_err());
        assert_eq!(names(folder.path()), ["deep", "link.bmp", "loop.bmp"]);
        assert_eq!(names(&at("deep")), ["real.bmp"]);
    }

    #[cfg(unix)]
    #[test]
    fn devices_are_written_to_and_not_replaced() {
        use std::os::unix::fs::FileTypeExt;
        write_file(Path::new("/dev/null"), b"gone").unwrap();
        assert!(fs::metadata("/dev/null").unwrap().file_type().is_char_device());
    }
}

//! Where a picture goes: looked at before minutes are spent on it, written whole or not at all.

use dotray::image::write_file;
use dotray::image::write_files;
use std::fs;
use std::fs::OpenOptions;
use std::io;
use std::io::IsTerminal;
use std::path::Path;
use std::path::PathBuf;

use crate::exit::Failure;
use crate::exit::put;
use crate::meaning::Place;

/// Whether the picture will have a place: an existing folder that takes files, and no terminal.
pub fn check(output: &Place, input: &Place) -> Result<(), Failure> {
    match output {
        Place::Standard if io::stdout().is_terminal() => Err(Failure::Usage(
            "a picture would go to the terminal: redirect standard output or name a file".to_owned(),
        )),
        Place::Standard => Ok(()),
        Place::File(path) => {
            check_differs(path, input)?;
            check_file(path).map_err(|error| Failure::file("write", path, &error))
        }
    }
}

fn check_differs(path: &Path, input: &Place) -> Result<(), Failure> {
    let Place::File(scene) = input else { return Ok(()) };
    match (fs::canonicalize(path), fs::canonicalize(scene)) {
        (Ok(a), Ok(b)) if a == b => {
            Err(Failure::Usage(format!("the picture would overwrite the scene `{}`", scene.display())))
        }
        (Ok(_) | Err(_), _) => Ok(()),
    }
}

fn check_file(path: &Path) -> io::Result<()> {
    match fs::metadata(path) {
        Ok(metadata) if metadata.is_dir() => return Err(io::Error::other("it is a folder")),
        Ok(metadata) if metadata.is_file() && metadata.permissions().readonly() => {
            return Err(io::Error::other("the file is write-protected"));
        }
        // A pipe or a device needs no file beside it.
        Ok(metadata) if !metadata.is_file() => return Ok(()),
        Ok(_) | Err(_) => {}
    }
    let folder = path.parent().filter(|folder| !folder.as_os_str().is_empty()).unwrap_or(Path::new("."));
    match fs::metadata(folder) {
        Ok(metadata) if metadata.is_dir() => {}
        Ok(_) => return Err(io::Error::other(format!("`{}` is not a folder", folder.display()))),
        Err(error) if error.kind() == io::ErrorKind::NotFound => {
            return Err(io::Error::other(format!("there is no folder `{}`", folder.display())));
        }
        Err(error) => return Err(error),
    }
    // Only trying tells whether a folder takes files: permissions, file systems and quotas all have a say. A link
    // may lead elsewhere, and is left to the writing itself.
    if fs::symlink_metadata(path).is_ok_and(|metadata| metadata.is_symlink()) {
        return Ok(());
    }
    let probe = folder.join(format!(".dotray-{}-probe.tmp", std::process::id()));
    OpenOptions::new().write(true).create_new(true).open(&probe)?;
    fs::remove_file(&probe)
}

/// Writes the picture's file and further ones: all of them, or none. Where that fails, the picture is stored elsewhere.
pub fn write_all(output: &Place, bytes: &[u8], more: &[(PathBuf, Vec<u8>)]) -> Result<(), Failure> {
    let Place::File(path) = output else { return write(output, bytes) };
    let more = more.iter().map(|(path, bytes)| (path.as_path(), bytes.as_slice()));
    let files: Vec<_> = std::iter::once((path.as_path(), bytes)).chain(more).collect();
    // The message names the file.
    write_files(&files).map_err(|error| rescued(error.to_string(), path, bytes))
}

/// Writes the picture's file.
pub fn write(output: &Place, bytes: &[u8]) -> Result<(), Failure> {
    match output {
        Place::Standard => put(bytes),
        // The message names the file.
        Place::File(path) => write_file(path, bytes).map_err(|error| Failure::Failed(error.to_string())),
    }
}

/// The failure to write a picture, which goes to the folder for temporary files, so that the work is not lost.
fn rescued(message: String, path: &Path, bytes: &[u8]) -> Failure {
    let name = path.file_name().unwrap_or("picture".as_ref()).to_string_lossy().into_owned();
    let rescue = std::env::temp_dir().join(format!("dotray-{}-{name}", std::process::id()));
    match write_file(&rescue, bytes) {
        Ok(()) => Failure::Failed(format!("{message}\nthe picture is in `{}`", rescue.display())),
        Err(_) => Failure::Failed(message),
    }
}

//! The scene files that paths on the command line stand for.

use std::fs;
use std::path::Path;
use std::path::PathBuf;

use crate::meaning::Place;

/// A path as typed, or a file of a folder that was typed.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum Asked {
    /// A file or standard input.
    Scene(Place),
    /// A folder without any scene.
    Nothing(PathBuf),
}

/// Files stay as typed, in this order; a folder becomes its `.ray` files and those below it, by name. Links to folders
/// are not followed, nor folders whose names begin with a dot.
pub fn expand(typed: &[PathBuf]) -> Vec<Asked> {
    let mut asked = Vec::new();
    for path in typed {
        if path.is_dir() {
            let found = below(path);
            if found.is_empty() {
                asked.push(Asked::Nothing(path.clone()));
            }
            asked.extend(found.into_iter().map(|path| Asked::Scene(Place::File(path))));
        } else {
            asked.push(Asked::Scene(Place::of(path)));
        }
    }
    asked
}

fn below(folder: &Path) -> Vec<PathBuf> {
    let mut found = Vec::new();
    let mut open = vec![folder.to_owned()];
    while let Some(folder) = open.pop() {
        for entry in fs::read_dir(&folder).into_iter().flatten().flatten() {
            let path = entry.path();
            let hidden = entry.file_name().to_string_lossy().starts_with('.');
            match entry.file_type() {
                Ok(kind) if kind.is_dir() && !hidden => open.push(path),
                Ok(kind) if !kind.is_dir() && !hidden && is_scene(&path) => found.push(path),
                Ok(_) | Err(_) => {}
            }
        }
    }
    // By components, so that a folder's files stand together.
    found.sort();
    found.into_iter().map(without_dot).collect()
}

fn is_scene(path: &Path) -> bool {
    path.extension().is_some_and(|extension| extension.eq_ignore_ascii_case("ray")) && path.is_file()
}

/// `./a.ray` is `a.ray`.
fn without_dot(path: PathBuf) -> PathBuf {
    path.strip_prefix(".").map(Path::to_owned).unwrap_or(path)
}

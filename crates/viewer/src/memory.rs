//! Files that were dropped on a page: no folders, so each is found by its name alone.

use dotray_scene::Files;
use std::collections::BTreeMap;
use std::io;
use std::path::Path;
use std::path::PathBuf;
use std::sync::Mutex;
use std::sync::PoisonError;

/// Bytes that are taken at most, all files together: a page cannot have more than four gigabytes for everything.
pub const MOST: u64 = 1 << 30;

/// Files by name, capitals or not.
#[derive(Debug, Default)]
pub struct Dropped {
    files: Mutex<BTreeMap<String, Vec<u8>>>,
}

/// A path's last part, in small letters. Paths come from scenes of all systems, so both kinds of strokes part them.
fn key(path: &Path) -> String {
    let whole = path.to_string_lossy().to_lowercase();
    whole.rsplit(['/', '\\']).next().unwrap_or_default().to_owned()
}

impl Dropped {
    fn with<T>(&self, look: impl FnOnce(&mut BTreeMap<String, Vec<u8>>) -> T) -> T {
        look(&mut self.files.lock().unwrap_or_else(PoisonError::into_inner))
    }

    /// Takes a file; one of the same name is replaced.
    pub fn add(&self, path: &Path, content: Vec<u8>) {
        self.with(|files| files.insert(key(path), content));
    }

    /// The bytes of all files together.
    pub fn size(&self) -> u64 {
        self.with(|files| files.values().map(|content| content.len() as u64).sum())
    }
}

impl Files for Dropped {
    fn read(&self, path: &Path) -> io::Result<Vec<u8>> {
        let missing = || io::Error::new(io::ErrorKind::NotFound, "not among the files that were dropped");
        self.with(|files| files.get(&key(path)).cloned()).ok_or_else(missing)
    }

    fn identity(&self, path: &Path) -> PathBuf {
        key(path).into()
    }

    fn names_in(&self, _: &Path) -> Vec<String> {
        self.with(|files| files.keys().cloned().collect())
    }
}

/// The file that holds the scene: the one named `.ray`, packed or not, that no other includes; the first by name where
/// there are several.
pub fn scene_among<'a>(paths: impl IntoIterator<Item = &'a Path>, files: &Dropped) -> Option<PathBuf> {
    let is_scene = |path: &&Path| {
        let name = key(path);
        [".ray", ".ray.gz", ".ray.zst"].iter().any(|ending| name.ends_with(ending))
    };
    let mut scenes: Vec<&Path> = paths.into_iter().filter(is_scene).collect();
    scenes.sort();
    let texts: Vec<(&Path, String)> = scenes
        .iter()
        .filter_map(|path| Some((*path, String::from_utf8_lossy(&files.read(path).ok()?).to_lowercase())))
        .collect();
    let is_included =
        |path: &Path| texts.iter().any(|(other, text)| *other != path && text.contains(&key(path)));
    let top = scenes.iter().find(|path| !is_included(path)).or(scenes.first());
    top.map(|path| path.to_path_buf())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn files_are_found_by_name_alone() {
        let dropped = Dropped::default();
        dropped.add(Path::new("Wood.PNG"), vec![1, 2]);
        assert_eq!(dropped.read(Path::new("textures/wood.png")).unwrap(), [1, 2]);
        assert_eq!(dropped.read(Path::new("textures\\WOOD.png")).unwrap(), [1, 2]);
        assert_eq!(dropped.read(Path::new("stone.png")).unwrap_err().kind(), io::ErrorKind::NotFound);
        assert_eq!(
            dropped.read_at_most(Path::new("wood.png"), 1).unwrap_err().kind(),
            io::ErrorKind::FileTooLarge
        );
        assert_eq!(dropped.names_in(Path::new("")), ["wood.png"]);
        assert_eq!(dropped.size(), 2);
    }

    #[test]
    fn the_scene_is_the_file_that_no_other_includes() {
        let dropped = Dropped::default();
        dropped.add(Path::new("a.ray"), b"#shape_sphere 0 0 0 1".to_vec());
        dropped.add(Path::new("b.ray"), b"#include \"A.ray\"".to_vec());
        dropped.add(Path::new("wood.png"), Vec::new());
        let paths = ["a.ray", "b.ray", "wood.png"].map(Path::new);
        assert_eq!(scene_among(paths, &dropped), Some("b.ray".into()));
        assert_eq!(scene_among([Path::new("a.ray")], &dropped), Some("a.ray".into()));
        assert_eq!(scene_among([Path::new("wood.png")], &dropped), None);
    }
}

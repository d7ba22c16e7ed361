//! Tracked files stay small.

use super::rust::root;
use std::path::Path;
use std::process::Command;

/// Every file of the repository that git tracks or would, relative to its root; all files where git is not at hand.
pub fn tracked() -> Vec<String> {
    let listed = Command::new("git")
        .args(["ls-files", "-z", "--cached", "--others", "--exclude-standard"])
        .current_dir(root())
        .output();
    if let Ok(output) = listed
        && output.status.success()
    {
        let text = String::from_utf8_lossy(&output.stdout).into_owned();
        return text.split('\0').filter(|path| !path.is_empty()).map(str::to_owned).collect();
    }
    let mut found = Vec::new();
    walk(&root(), "", &mut found);
    found
}

fn walk(folder: &Path, prefix: &str, found: &mut Vec<String>) {
    for entry in std::fs::read_dir(folder).into_iter().flatten().flatten() {
        let name = entry.file_name().to_string_lossy().into_owned();
        let path = format!("{prefix}{name}");
        if name == ".git" || name.starts_with("target") {
            continue;
        }
        if entry.path().is_dir() {
            walk(&entry.path(), &format!("{path}/"), found);
        } else {
            found.push(path);
        }
    }
}

const PICTURES: [&str; 9] = [".png", ".bmp", ".jpg", ".jpeg", ".ppm", ".qoi", ".tif", ".exr", ".hdr"];
const TEST_PICTURE_LIMIT: u64 = 60 << 10;
const FILE_LIMIT: u64 = 1 << 20;

fn fault(path: &str, bytes: u64) -> Option<String> {
    // The conformance references are floats, handed over as they are.
    let picture = PICTURES.iter().any(|extension| path.ends_with(extension));
    let limited = picture && path.contains("tests/") && !path.starts_with("tests/conformance/");
    let limit = if limited { TEST_PICTURE_LIMIT } else { FILE_LIMIT };
    (bytes > limit).then(|| format!("{path}: {bytes} bytes, at most {limit} allowed"))
}

#[test]
fn tracked_files_are_small() {
    let files = tracked();
    assert!(files.len() > 100, "the tree was not found");
    let size = |path: &String| std::fs::metadata(root().join(path)).map_or(0, |meta| meta.len());
    let faults: Vec<String> = files.iter().filter_map(|path| fault(path, size(path))).collect();
    super::expect_none("large files", &faults);
}

#[test]
fn planted_faults_are_found() {
    assert!(fault("crates/scene/tests/a.png", TEST_PICTURE_LIMIT + 1).is_some());
    assert!(fault("tests/conformance/a.exr", TEST_PICTURE_LIMIT + 1).is_none());
    assert!(fault("tests/conformance/a.exr", FILE_LIMIT + 1).is_some());
    assert!(fault("scenes/a.png", TEST_PICTURE_LIMIT + 1).is_none());
    assert!(fault("docs/a.md", FILE_LIMIT + 1).is_some());
    assert!(fault("docs/a.md", FILE_LIMIT).is_none());
}

#[test]
fn the_walk_finds_what_git_lists() {
    let mut found = Vec::new();
    walk(&root(), "", &mut found);
    for path in tracked().iter().filter(|path| path.starts_with("crates/") && path.ends_with(".rs")) {
        assert!(found.contains(path), "{path}");
    }
}

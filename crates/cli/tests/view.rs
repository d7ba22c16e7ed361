//! `dotray view` starts the rayview beside it, else the one on the PATH, and says what to do where there is none.
#![cfg(unix)]

use std::os::unix::fs::PermissionsExt;
use std::path::Path;
use std::process::Command;
use std::process::Output;

/// A program that prints its name and its arguments.
fn plant(folder: &Path, says: &str, code: i32) {
    std::fs::create_dir_all(folder).expect("a folder");
    let path = folder.join("rayview");
    std::fs::write(&path, format!("#!/bin/sh\necho {says} \"$@\"\nexit {code}\n")).expect("written");
    std::fs::set_permissions(&path, std::fs::Permissions::from_mode(0o755)).expect("executable");
}

/// Runs a dotray that stands alone in its folder.
fn view(folder: &Path, path: &Path, arguments: &[&str]) -> Output {
    let program = folder.join("dotray");
    if !program.exists() {
        std::fs::create_dir_all(folder).expect("a folder");
        std::fs::copy(env!("CARGO_BIN_EXE_dotray"), &program).expect("copied");
    }
    Command::new(program).arg("view").args(arguments).env("PATH", path).output().expect("it runs")
}

#[test]
fn the_one_beside_comes_before_the_one_on_the_path() {
    let root = tempfile::tempdir().expect("a folder");
    let (bin, other) = (root.path().join("bin"), root.path().join("other"));
    std::fs::create_dir_all(&other).expect("a folder");
    let out = view(&bin, &other, &["a.ray"]);
    let message = String::from_utf8_lossy(&out.stderr).into_owned();
    assert_eq!(out.status.code(), Some(1));
    assert!(message.contains("neither beside dotray nor on the PATH"), "{message}");

    plant(&other, "path", 0);
    let out = view(&bin, &other, &["a.ray"]);
    assert_eq!((out.status.code(), &*out.stdout), (Some(0), &b"path -- a.ray\n"[..]));

    plant(&bin, "beside", 0);
    let out = view(&bin, &other, &["--traced", "--", "-a.ray"]);
    assert_eq!((out.status.code(), &*out.stdout), (Some(0), &b"beside --traced -- -a.ray\n"[..]));
    let out = view(&bin, &other, &["--serve", "--port", "8000", "a.ray"]);
    assert_eq!((out.status.code(), &*out.stdout), (Some(0), &b"beside --serve --port 8000 -- a.ray\n"[..]));

    plant(&bin, "beside", 3);
    assert_eq!(view(&bin, &other, &["a.ray"]).status.code(), Some(1));
}

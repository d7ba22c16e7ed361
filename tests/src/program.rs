//! The program itself, run as a user runs it.

use crate::corpus::root;
use std::path::Path;
use std::path::PathBuf;
use std::process::Command;
use std::process::Output;
use std::sync::OnceLock;
use std::time::SystemTime;

/// The path of the program `dotray` of this build.
///
/// # Panics
/// If it is not there and cannot be built.
pub fn path() -> &'static Path {
    static PATH: OnceLock<PathBuf> = OnceLock::new();
    PATH.get_or_init(|| {
        // Tests run from `target/PROFILE/deps`; the program stands above.
        let test = std::env::current_exe().expect("a test knows its own path");
        let folder = test.parent().and_then(Path::parent).expect("target/PROFILE").to_owned();
        let program = folder.join(format!("dotray{}", std::env::consts::EXE_SUFFIX));
        // `cargo test --workspace` has built it; with this package alone it may be absent or old.
        let newest =
            SOURCES.iter().flat_map(|member| newest_below(&root().join("crates").join(member).join("src")));
        if modified(&program) < newest.max() {
            build(&folder);
        }
        assert!(program.exists(), "no program at {}", program.display());
        program
    })
}

/// The members that the program is made of.
const SOURCES: [&str; 8] = ["geometry", "image", "accel", "scene", "render", "grade", "lsp", "cli"];

fn modified(path: &Path) -> Option<SystemTime> {
    std::fs::metadata(path).and_then(|meta| meta.modified()).ok()
}

fn newest_below(folder: &Path) -> Option<SystemTime> {
    let entries = std::fs::read_dir(folder).into_iter().flatten().flatten().map(|entry| entry.path());
    entries.filter_map(|path| if path.is_dir() { newest_below(&path) } else { modified(&path) }).max()
}

fn build(profile_folder: &Path) {
    let cargo = std::env::var_os("CARGO").unwrap_or_else(|| "cargo".into());
    let mut command = Command::new(cargo);
    // With this package beside it, the same features are chosen as for the tests, and little is built anew.
    command.args([
        "build",
        "--locked",
        "--package",
        "dotray",
        "--package",
        "dotray-tests",
        "--bin",
        "dotray",
    ]);
    command.current_dir(root());
    command.arg("--target-dir").arg(profile_folder.parent().expect("target"));
    if profile_folder.ends_with("release") {
        command.arg("--release");
    }
    let status = command.status().expect("cargo can be run");
    assert!(status.success(), "the program could not be built");
}

/// Runs the program with these arguments in `folder`, without input and without a terminal.
///
/// # Panics
/// If it cannot be started.
pub fn run(folder: &Path, arguments: &[&str]) -> Output {
    let mut command = Command::new(path());
    command.args(arguments).current_dir(folder).stdin(std::process::Stdio::null()).env("NO_COLOR", "1");
    command.output().unwrap_or_else(|error| panic!("{}: {error}", path().display()))
}

/// Both outputs and the exit code, for messages of tests.
pub fn shown(output: &Output) -> String {
    let text = |bytes: &[u8]| String::from_utf8_lossy(bytes).into_owned();
    format!("{}\n{}\n{}", output.status, text(&output.stdout), text(&output.stderr))
}

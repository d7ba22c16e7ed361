//! What the tests of the program share: a folder of their own, the program run in it, scenes.

#![allow(dead_code, reason = "each test file uses a part")]

use std::io::Write;
use std::path::Path;
use std::path::PathBuf;
use std::process::Command;
use std::process::Stdio;

/// A small scene with one light, a mirror, glass and no fault.
pub const BALLS: &str = "\
#camera 0 0 4 0 0 -1 0 1 0 .5
#background .1 .2 .3
#ambient .2 .2 .2
#light_point 1 1 1 3 4 5 1 0 0
#material .2 .1 0 .7 .6 .1 .5 .5 .5 0 0 0 .5 0 1 -1 !!
#material .1 .1 .1 .1 .1 .1 .9 .9 .9 0 0 0 .2 .8 1.4 -1 !!
#group_begin 1 0 0 -.7 0 1 0 0 0 0 1 0 0 0 0 1
#shape_sphere 0 0 0 0 1
#group_end
#shape_sphere 1 .8 0 1 .5
";

/// A scene with a fault.
pub const WRONG: &str = "#light_dir 1 1 1 0 0 -1\n#shape_spere 0 0 0 0 1\n";

/// A scene with a warning: two cameras.
pub const WARNING: &str = "\
#camera 0 0 4 0 0 -1 0 1 0 .5
#camera 0 0 4 0 0 -1 0 1 0 .5
#light_dir 1 1 1 0 0 -1
#shape_sphere -1 0 0 0 1
";

/// How a run of the program ended.
pub struct Outcome {
    /// The exit code.
    pub code: Option<i32>,
    /// Standard output.
    pub stdout: Vec<u8>,
    /// Standard error.
    pub stderr: String,
}

impl Outcome {
    /// Standard output as text.
    pub fn text(&self) -> String {
        String::from_utf8_lossy(&self.stdout).into_owned()
    }

    /// Fails the test unless the program ended with `code`.
    #[track_caller]
    pub fn expect(self, code: i32) -> Self {
        assert_eq!(self.code, Some(code), "standard error: {}", self.stderr);
        self
    }

    /// Fails the test unless standard error holds `part`.
    #[track_caller]
    pub fn says(self, part: &str) -> Self {
        assert!(self.stderr.contains(part), "no `{part}` in: {}", self.stderr);
        self
    }
}

/// A folder that goes when the test ends.
pub struct Folder(tempfile::TempDir);

impl Folder {
    /// A folder with `balls.ray`, `wrong.ray` and `warning.ray`.
    pub fn new() -> Self {
        let folder = Self(tempfile::tempdir().expect("a temporary folder"));
        folder.put("balls.ray", BALLS.as_bytes());
        folder.put("wrong.ray", WRONG.as_bytes());
        folder.put("warning.ray", WARNING.as_bytes());
        folder
    }

    /// A path in it.
    pub fn path(&self, name: &str) -> PathBuf {
        self.0.path().join(name)
    }

    /// Writes a file.
    pub fn put(&self, name: &str, content: &[u8]) {
        std::fs::write(self.path(name), content).expect("a file in the temporary folder");
    }

    /// Reads a file.
    #[track_caller]
    pub fn get(&self, name: &str) -> Vec<u8> {
        std::fs::read(self.path(name)).unwrap_or_else(|error| panic!("{name}: {error}"))
    }

    /// The names of all files.
    pub fn names(&self) -> Vec<String> {
        let entries = std::fs::read_dir(self.0.path()).expect("the temporary folder");
        let mut names: Vec<String> =
            entries.flatten().map(|entry| entry.file_name().to_string_lossy().into_owned()).collect();
        names.sort();
        names
    }

    /// The program, ready to run here.
    pub fn command(&self, arguments: &str) -> Command {
        let mut command = Command::new(env!("CARGO_BIN_EXE_dotray"));
        command.args(arguments.split_whitespace()).current_dir(self.0.path()).env_remove("NO_COLOR");
        command
    }

    /// Runs the program with words separated by blanks.
    pub fn run(&self, arguments: &str) -> Outcome {
        self.run_with_input(arguments, b"")
    }

    /// The same with something on standard input.
    pub fn run_with_input(&self, arguments: &str, input: &[u8]) -> Outcome {
        let mut command = self.command(arguments);
        command.stdin(Stdio::piped()).stdout(Stdio::piped()).stderr(Stdio::piped());
        let mut child = command.spawn().expect("the program starts");
        let mut stdin = child.stdin.take().expect("a pipe");
        // A program that stops on a usage error reads nothing.
        let _ = stdin.write_all(input);
        drop(stdin);
        let output = child.wait_with_output().expect("the program ends");
        let stderr = String::from_utf8_lossy(&output.stderr).into_owned();
        Outcome { code: output.status.code(), stdout: output.stdout, stderr }
    }
}

/// The repository's root.
pub fn root() -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("../..")
}

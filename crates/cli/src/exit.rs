//! How a command can end other than well, and the exit code of each way.

use dotray::image::ImageError;
use dotray::render::RenderError;
use std::fmt;
use std::io;
use std::io::Write;
use std::path::Path;
use std::process::ExitCode;

/// Why a command stopped.
#[derive(Debug)]
pub enum Failure {
    /// The command line asks for something that cannot be: exit code 2.
    Usage(String),
    /// The scene, the picture or a file is at fault: exit code 1.
    Failed(String),
    /// The same, and the messages are printed already.
    Reported,
    /// Two pictures differ by more than is forgiven, which is printed already: exit code 3.
    Over,
    /// Ctrl-C: exit code 130, as shells report it.
    Interrupted,
    /// Whoever read our standard output has gone, as `head` does: no fault, exit code 0.
    ReaderGone,
}

impl Failure {
    /// A file could not be read or written; `doing` is such as `write`.
    pub fn file(doing: &str, path: &Path, error: &dyn fmt::Display) -> Self {
        Self::Failed(format!("cannot {doing} `{}`: {error}", path.display()))
    }

    /// Says why and gives the exit code.
    pub fn report(&self) -> ExitCode {
        match self {
            Self::Usage(message) => {
                say(&format!("error: {message}\n\nFor more information, try '--help'."));
                ExitCode::from(2)
            }
            Self::Failed(message) => {
                say(&format!("error: {message}"));
                ExitCode::from(1)
            }
            Self::Reported => ExitCode::from(1),
            Self::Over => ExitCode::from(3),
            Self::Interrupted => {
                say("interrupted; nothing was written");
                ExitCode::from(130)
            }
            Self::ReaderGone => ExitCode::SUCCESS,
        }
    }
}

impl From<RenderError> for Failure {
    fn from(error: RenderError) -> Self {
        match error {
            RenderError::Option { .. } => Self::Usage(format!("--{error}")),
            RenderError::Film { .. } | RenderError::Threads { .. } => Self::Failed(error.to_string()),
        }
    }
}

impl From<ImageError> for Failure {
    fn from(error: ImageError) -> Self {
        Self::Failed(error.to_string())
    }
}

/// Prints a line to standard error; if nobody reads there, nothing can be done about it.
pub fn say(line: &str) {
    let _ = writeln!(io::stderr().lock(), "{line}");
}

/// Writes to standard output, all of it.
pub fn put(bytes: &[u8]) -> Result<(), Failure> {
    let mut stdout = io::stdout().lock();
    stdout.write_all(bytes).and_then(|()| stdout.flush()).map_err(|error| stdout_failure(&error))
}

/// What a failed write to standard output means.
pub fn stdout_failure(error: &io::Error) -> Failure {
    if error.kind() == io::ErrorKind::BrokenPipe {
        Failure::ReaderGone
    } else {
        Failure::Failed(format!("cannot write to standard output: {error}"))
    }
}

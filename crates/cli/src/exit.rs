//! How a command can end other than well, and the exit code of each way.

use dotray::image::ImageError;
use dotray::render::RenderError;
use std::fmt;
use std::io;
use std::io::Write;
use std::path::Path;

pub use crate::log::say;

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
    /// Ctrl-C or SIGTERM: exit code 130 or 143, as shells report it.
    Interrupted {
        /// The signal's number.
        signal: u8,
        /// What is kept and how to go on; `None` where nothing was written.
        kept: Option<String>,
    },
    /// The time limit came first; this says what is there: exit code 4.
    TimeLimit(String),
    /// Whoever read our standard output has gone, as `head` does: no fault, exit code 0.
    ReaderGone,
}

impl Failure {
    /// A file could not be read or written; `doing` is such as `write`.
    pub fn file(doing: &str, path: &Path, error: &dyn fmt::Display) -> Self {
        Self::Failed(format!("cannot {doing} `{}`: {error}", path.display()))
    }

    /// Says why and gives the exit code.
    pub fn report(&self) -> u8 {
        match self {
            Self::Usage(message) => {
                say(&format!("error: {message}\n\nFor more information, try '--help'."));
                2
            }
            Self::Failed(message) => {
                say(&format!("error: {message}"));
                1
            }
            Self::Reported => 1,
            Self::Over => 3,
            Self::Interrupted { signal, kept } => {
                let what = if *signal == 15 { "terminated" } else { "interrupted" };
                say(&format!("{what}; {}", kept.as_deref().unwrap_or("nothing was written")));
                128 + signal.min(&127)
            }
            Self::TimeLimit(message) => {
                say(&format!("the time limit came first; {message}"));
                4
            }
            Self::ReaderGone => 0,
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

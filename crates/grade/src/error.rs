//! Why nothing can be graded.

use std::path::PathBuf;

/// The suite or the program's command line is at fault; faults of the program itself only cost points.
#[derive(Debug, thiserror::Error)]
pub enum GradeError {
    /// A file of the suite cannot be read.
    #[error("cannot read `{}`: {message}", .path.display())]
    Read {
        /// The file.
        path: PathBuf,
        /// Why not.
        message: String,
    },
    /// The suite's file says something that cannot be.
    #[error("`{}`: {message}", .path.display())]
    Suite {
        /// The file.
        path: PathBuf,
        /// What and what was expected.
        message: String,
    },
    /// A scene of the suite has no picture.
    #[error("test `{test}`: {message}")]
    Scene {
        /// The test.
        test: String,
        /// What is wrong with its scene.
        message: String,
    },
    /// The words of the program cannot be understood.
    #[error("{0}")]
    Program(String),
    /// The machine does not give what running programs needs.
    #[error("{0}")]
    Machine(String),
}

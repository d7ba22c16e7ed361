//! Why there is no picture.

/// A picture could not be made.
#[derive(Debug, thiserror::Error)]
pub enum RenderError {
    /// An option's value makes no sense.
    #[error("{option} is {value}; expected {expected}")]
    Option {
        /// Its name on the command line.
        option: &'static str,
        /// Its value.
        value: String,
        /// What it may be.
        expected: String,
    },
    /// The picture is too large for memory.
    #[error("a picture of {width}x{height} pixels cannot be held: {reason}")]
    Film {
        /// Columns.
        width: u32,
        /// Rows.
        height: u32,
        /// What went wrong.
        reason: String,
    },
    /// No threads could be started.
    #[error("cannot start {threads} threads: {reason}")]
    Threads {
        /// How many.
        threads: usize,
        /// What the system says.
        reason: String,
    },
}

//! What can be wrong with a picture or its file: each message names the thing, its value and what was expected.

/// Why a picture could not be made, read, written or compared.
#[derive(Debug, Clone, PartialEq, Eq, thiserror::Error)]
pub enum ImageError {
    /// A size of zero, or more pixels than the limit allows.
    #[error(
        "picture size {width} x {height} refused: both must be at least 1 and their product at most {max_pixels} pixels"
    )]
    Size {
        /// Columns asked for.
        width: u64,
        /// Rows asked for.
        height: u64,
        /// The limit on their product.
        max_pixels: u64,
    },
    /// The picture would need more memory than the limit allows, or than the system gives.
    #[error(
        "picture of {width} x {height} pixels refused: it needs {needed} bytes of memory, {max_bytes} are allowed"
    )]
    Memory {
        /// Columns of the picture.
        width: u64,
        /// Rows of the picture.
        height: u64,
        /// Bytes that decoding would take.
        needed: u64,
        /// The limit on them.
        max_bytes: u64,
    },
    /// The number of samples does not fit width, height and channels.
    #[error("{found} samples given, {expected} expected (width x height x channels)")]
    SampleCount {
        /// Samples that the size asks for.
        expected: u64,
        /// Samples that were given.
        found: u64,
    },
    /// A file name without an extension, so the format is unknown.
    #[error("file name `{name}` has no extension to tell the picture format by: use one of {known}")]
    NoExtension {
        /// The file name.
        name: String,
        /// All known extensions.
        known: String,
    },
    /// A file name whose extension names no known format.
    #[error("unknown picture format `.{extension}` of `{name}`: {}use one of {known}", suggestion_words(.suggestion))]
    UnknownExtension {
        /// The file name.
        name: String,
        /// Its extension.
        extension: String,
        /// All known extensions.
        known: String,
        /// The nearest known extension, if one is near.
        suggestion: Option<&'static str>,
    },
    /// Bytes that begin like no known picture format.
    #[error("not a picture: the file begins with {found}, which is no known format; known are {known}")]
    UnknownContent {
        /// The first bytes, as hexadecimal digits.
        found: String,
        /// Names of the known formats.
        known: String,
    },
    /// The format is known but was left out of this build.
    #[error("{format} is left out of this build: build with the cargo feature `formats`")]
    NotBuilt {
        /// Name of the format.
        format: &'static str,
    },
    /// The file ends too early.
    #[error(
        "{format} file ends at byte {length}, too early for {what}: {needed} bytes from byte {offset} on"
    )]
    Truncated {
        /// Name of the format.
        format: &'static str,
        /// What was being read.
        what: &'static str,
        /// Where it starts.
        offset: u64,
        /// Its size in bytes.
        needed: u64,
        /// Length of the file.
        length: u64,
    },
    /// A value in the file that cannot be right, or that is right but not read here.
    #[error("{format} file, byte {offset}: {what} is {value}, expected {expected}")]
    Invalid {
        /// Name of the format.
        format: &'static str,
        /// Where the value stands.
        offset: u64,
        /// What it is.
        what: &'static str,
        /// The value found.
        value: String,
        /// What would have been right.
        expected: String,
    },
    /// A decoder of another crate refused the file.
    #[error("{format} file cannot be read: {message}")]
    Decoder {
        /// Name of the format.
        format: &'static str,
        /// What the decoder said.
        message: String,
    },
    /// The picture cannot be stored in this format.
    #[error("picture of {width} x {height} pixels cannot be stored as {format}: {message}")]
    Encoder {
        /// Name of the format.
        format: &'static str,
        /// Columns of the picture.
        width: usize,
        /// Rows of the picture.
        height: usize,
        /// Why not.
        message: String,
    },
    /// A JPEG quality outside 1 to 100.
    #[error("JPEG quality is {quality}, expected 1 to 100")]
    JpegQuality {
        /// The value asked for.
        quality: u8,
    },
    /// Two pictures of different size cannot be compared.
    #[error("the pictures have different sizes: {expected_width} x {expected_height} and {width} x {height}")]
    SizesDiffer {
        /// Columns of the first picture.
        expected_width: usize,
        /// Rows of the first picture.
        expected_height: usize,
        /// Columns of the second picture.
        width: usize,
        /// Rows of the second picture.
        height: usize,
    },
}

fn suggestion_words(suggestion: &Option<&'static str>) -> String {
    suggestion.map(|near| format!("did you mean `.{near}`? Or ")).unwrap_or_default()
}

//! Where files go.

use std::path::Path;

/// Stores a file, whole or not at all.
///
/// # Errors
/// What the system says.
pub fn store(path: &Path, bytes: &[u8]) -> Result<(), String> {
    dotray_image::write_file(path, bytes)
        .map_err(|error| format!("cannot write `{}`: {error}", path.display()))
}

/// Whether the file on the disk is the one that was read.
pub fn is_as_read(path: &Path, read: &[u8]) -> bool {
    std::fs::read(path).is_ok_and(|now| now == read)
}

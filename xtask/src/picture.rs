//! Pictures of several programs, compared.

use dotray_image::Image;
use dotray_image::Limits;
use dotray_image::compare::compare;
use dotray_image::decode;
use std::path::Path;

fn load(path: &Path) -> Result<Image, String> {
    let told = |fault: String| format!("{}: {fault}", path.display());
    let bytes = std::fs::read(path).map_err(|fault| told(fault.to_string()))?;
    decode(&bytes, None, &Limits::default()).map_err(|fault| told(fault.to_string()))
}

/// The mean absolute difference of two pictures' channels, 1 being white.
///
/// # Errors
/// Where one cannot be read, or the sizes differ.
pub fn mean_difference(ours: &Path, theirs: &Path) -> Result<f64, String> {
    let figures = compare(&load(ours)?, &load(theirs)?, 0.0).map_err(|fault| fault.to_string())?;
    Ok(figures.mean)
}

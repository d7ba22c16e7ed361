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

/// The picture with left and right exchanged.
fn mirrored(image: &Image) -> Image {
    let mut other = image.clone();
    let width = image.width();
    for y in 0..image.height() {
        for x in 0..width {
            if let Some(pixel) = image.pixel(width - 1 - x, y) {
                other.set_pixel(x, y, pixel);
            }
        }
    }
    other
}

/// The mean absolute difference of two pictures' channels, 1 being white; theirs may be a mirror's.
///
/// # Errors
/// Where one cannot be read, or the sizes differ.
pub fn mean_difference(ours: &Path, theirs: &Path, is_mirrored: bool) -> Result<f64, String> {
    let theirs = load(theirs)?;
    let theirs = if is_mirrored { mirrored(&theirs) } else { theirs };
    let figures = compare(&load(ours)?, &theirs, 0.0).map_err(|fault| fault.to_string())?;
    Ok(figures.mean)
}

#[cfg(test)]
mod tests {
    use super::mirrored;
    use dotray_image::Channels;
    use dotray_image::Image;

    #[test]
    fn a_mirror_exchanges_left_and_right() {
        let mut image = Image::new(3, 2, Channels::Rgb).expect("a small picture");
        image.set_pixel(0, 1, [1.0, 0.5, 0.25, 1.0]);
        assert_eq!(mirrored(&image).pixel(2, 1), Some([1.0, 0.5, 0.25, 1.0]));
        assert_eq!(mirrored(&mirrored(&image)).samples(), image.samples());
    }
}

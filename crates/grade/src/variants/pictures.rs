//! Changes of a picture: that which was made, or a texture.

use dotray_image::Channels;
use dotray_image::Image;

/// A picture of `width` x `height` whose pixel (x, y) is that at `from(x, y)`.
fn moved(
    image: &Image,
    (width, height): (usize, usize),
    from: impl Fn(usize, usize) -> (usize, usize),
) -> Image {
    let mut moved = image.clone();
    if (width, height) != (image.width(), image.height()) {
        // The same number of samples, so it can be made.
        let samples = vec![0.0; image.samples().len()];
        moved = Image::from_samples(width, height, image.channels(), samples).unwrap_or(moved);
    }
    for y in 0..height {
        for x in 0..width {
            let (old_x, old_y) = from(x, y);
            moved.set_pixel(x, y, image.pixel(old_x, old_y).unwrap_or_default());
        }
    }
    moved
}

pub fn upside_down(image: &Image) -> Image {
    moved(image, (image.width(), image.height()), |x, y| (x, image.height() - 1 - y))
}

pub fn mirrored(image: &Image) -> Image {
    moved(image, (image.width(), image.height()), |x, y| (image.width() - 1 - x, y))
}

pub fn turned(image: &Image) -> Image {
    mirrored(&upside_down(image))
}

pub fn axes_exchanged(image: &Image) -> Image {
    moved(image, (image.height(), image.width()), |x, y| (y, x))
}

pub fn red_blue_swapped(image: &Image) -> Image {
    let mut swapped = image.clone();
    swapped.samples_mut().chunks_exact_mut(image.channels().count()).for_each(|pixel| pixel.swap(0, 2));
    swapped
}

/// The power 1/2.2, which an sRGB curve hardly differs from.
pub fn gamma(image: &Image) -> Image {
    let mut curved = image.clone();
    for pixel in curved.samples_mut().chunks_exact_mut(image.channels().count()) {
        let colors = pixel.iter_mut().take(Channels::Rgb.count());
        colors.for_each(|sample| *sample = libm::powf(sample.clamp(0.0, 1.0), 1.0 / 2.2));
    }
    curved
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn pixels_go_where_they_should() {
        let samples: Vec<f32> = (0..18).map(|value| value as f32).collect();
        let image = Image::from_samples(3, 2, Channels::Rgb, samples).unwrap();
        let red = |image: &Image, x, y| image.pixel(x, y).unwrap()[0];
        assert_eq!(red(&upside_down(&image), 0, 0), 9.0);
        assert_eq!(red(&mirrored(&image), 0, 0), 6.0);
        assert_eq!(red(&turned(&image), 0, 0), 15.0);
        let exchanged = axes_exchanged(&image);
        assert_eq!((exchanged.width(), exchanged.height(), red(&exchanged, 1, 2)), (2, 3, 15.0));
        assert_eq!(red(&red_blue_swapped(&image), 0, 0), 2.0);
        assert_eq!(red(&gamma(&image), 0, 0), 0.0);
    }
}

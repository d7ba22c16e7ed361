//! A picture behind a picture.

use dotray::Image;
use dotray::image::Channels;
use dotray::image::Format;
use dotray::image::ImageError;
use dotray::image::Limits;
use dotray::image::decode;
use dotray::render::Fingerprint;
use dotray::render::Options;
use std::path::Path;

use crate::exit::Failure;

/// The picture behind, and what it is recognised by.
#[derive(Clone, Debug)]
pub struct Back {
    /// The picture.
    pub image: Image,
    /// A hash of its file.
    hash: Fingerprint,
}

/// Reads the picture.
pub fn load(path: &Path, limits: &Limits) -> Result<Back, Failure> {
    let bytes = std::fs::read(path).map_err(|error| Failure::file("read", path, &error))?;
    let image = decode(&bytes, Format::from_path(path).ok(), limits)
        .map_err(|error| Failure::file("decode", path, &error))?;
    Ok(Back { image, hash: Fingerprint::default().with_hash_of("background image", &bytes) })
}

impl Back {
    /// What a picture with this one behind it depends on.
    pub fn added_to(&self, fingerprint: Fingerprint) -> Fingerprint {
        self.hash.entries().iter().fold(fingerprint, |all, (name, value)| all.with(name, value))
    }
}

/// `front` with `back`, stretched over the whole picture, showing through where `front` lets it.
pub fn composed(front: &Image, back: &Image, options: &Options) -> Result<Image, ImageError> {
    let window = options.window();
    let mut samples = Vec::with_capacity(3 * front.width() * front.height());
    for y in 0..front.height() {
        for x in 0..front.width() {
            let [r, g, b, alpha] = front.pixel(x, y).unwrap_or_default();
            let place =
                |at: usize, first: u32, whole: u32| (at as f64 + f64::from(first) + 0.5) / f64::from(whole);
            let behind =
                color_at(back, place(x, window.x, options.width), place(y, window.y, options.height));
            let over = |front: f32, back: f32| {
                if alpha >= 1.0 { front } else { front * alpha + back * (1.0 - alpha) }
            };
            samples.extend([r, g, b].into_iter().zip(behind).map(|(front, back)| over(front, back)));
        }
    }
    Image::from_samples(front.width(), front.height(), Channels::Rgb, samples)
}

/// Between the four pixels around a place given as fractions of the edges, from the upper left.
fn color_at(image: &Image, s: f64, t: f64) -> [f32; 3] {
    let along = |place: f64, count: usize| {
        let at = (place * count as f64 - 0.5).clamp(0.0, (count - 1) as f64);
        let first = at.floor();
        (first as usize, (first as usize + 1).min(count - 1), (at - first) as f32)
    };
    let (left, right, across) = along(s, image.width());
    let (top, bottom, down) = along(t, image.height());
    let pixel = |x: usize, y: usize| image.pixel(x, y).unwrap_or_default();
    let corners = [pixel(left, top), pixel(right, top), pixel(left, bottom), pixel(right, bottom)];
    [0, 1, 2].map(|k| {
        let [a, b, c, d] = corners.map(|pixel| pixel.get(k).copied().unwrap_or_default());
        let mix = |a: f32, b: f32, share: f32| if share == 0.0 { a } else { a * (1.0 - share) + b * share };
        mix(mix(a, b, across), mix(c, d, across), down)
    })
}

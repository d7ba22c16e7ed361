//! OpenEXR files with more than a colour: further channels, named `layer.channel`, beside R, G and B.

use crate::error::ImageError;
use crate::image::Channels;
use crate::image::Image;

/// One channel beside the colour.
#[derive(Clone, Debug, PartialEq)]
pub struct NamedChannel {
    /// `layer.channel`, such as `depth.Z`.
    pub name: String,
    /// Its numbers, pixel by pixel, upper row first.
    pub samples: Vec<f32>,
}

/// The bytes of an OpenEXR file whose default layer is the picture (multiplied by alpha where it has that) and whose
/// further channels follow it in one part, as programs for compositing expect it.
///
/// # Errors
/// [`ImageError::SampleCount`] for a channel that does not fit the picture, [`ImageError::Encoder`] if the format
/// cannot hold it, [`ImageError::NotBuilt`] where this build leaves OpenEXR out.
pub fn encode_exr_layers(image: &Image, channels: Vec<NamedChannel>) -> Result<Vec<u8>, ImageError> {
    let expected = image.width() as u64 * image.height() as u64;
    for channel in &channels {
        let found = channel.samples.len() as u64;
        if found != expected {
            return Err(ImageError::SampleCount { expected, found });
        }
    }
    let names: &[&str] = match image.channels() {
        Channels::Rgb => &["R", "G", "B"],
        Channels::Rgba => &["R", "G", "B", "A"],
    };
    let mut all: Vec<NamedChannel> =
        names.iter().map(|name| NamedChannel { name: (*name).to_owned(), samples: Vec::new() }).collect();
    for pixel in image.samples().chunks_exact(names.len()) {
        let stored = crate::image::premultiplied(pixel);
        all.iter_mut().zip(stored).for_each(|(channel, sample)| channel.samples.push(sample));
    }
    all.extend(channels);
    written(image, all)
}

#[cfg(feature = "formats")]
fn written(image: &Image, channels: Vec<NamedChannel>) -> Result<Vec<u8>, ImageError> {
    crate::openexr::encode_channels(
        image.width(),
        image.height(),
        channels.into_iter().map(|channel| (channel.name, channel.samples)),
    )
}

#[cfg(not(feature = "formats"))]
fn written(_: &Image, _: Vec<NamedChannel>) -> Result<Vec<u8>, ImageError> {
    Err(ImageError::NotBuilt { format: crate::format::Format::Exr.name() })
}

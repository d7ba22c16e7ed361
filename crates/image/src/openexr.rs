//! OpenEXR through the `exr` crate, in one thread so that nothing depends on how many there are.

use std::io::Cursor;

use exr::meta::MetaData;
use exr::meta::header::Header;
use exr::prelude::AnyChannel;
use exr::prelude::AnyChannels;
use exr::prelude::Compression;
use exr::prelude::Encoding;
use exr::prelude::FlatSamples;
use exr::prelude::Layer;
use exr::prelude::LayerAttributes;
use exr::prelude::LineOrder;
use exr::prelude::ReadChannels;
use exr::prelude::ReadLayers;
use exr::prelude::ReadSpecificChannel;
use exr::prelude::SpecificChannels;
use exr::prelude::Vec2;
use exr::prelude::WritableImage;
use exr::prelude::read;

use crate::error::ImageError;
use crate::guard::guarded;
use crate::image::Channels;
use crate::image::Image;
use crate::image::premultiplied;
use crate::image::straight;
use crate::limits::Limits;

const NAME: &str = "OpenEXR";

const ENCODING: Encoding = Encoding {
    compression: Compression::ZIP16,
    blocks: exr::image::Blocks::ScanLines,
    line_order: LineOrder::Increasing,
};

/// The bytes of a file with channels of these names, 32-bit floats in ZIP-compressed scan lines.
pub(crate) fn encode_channels(
    width: usize,
    height: usize,
    channels: impl Iterator<Item = (String, Vec<f32>)>,
) -> Result<Vec<u8>, ImageError> {
    let failed = |message: String| ImageError::Encoder { format: NAME, width, height, message };
    let mut list = exr::prelude::SmallVec::new();
    for (name, samples) in channels {
        let name = exr::prelude::Text::new_or_none(&name)
            .ok_or_else(|| failed(format!("`{name}` cannot be a channel's name")))?;
        list.push(AnyChannel::new(name, FlatSamples::F32(samples)));
    }
    let mut file = Vec::new();
    let written = guarded(|| {
        let layer =
            Layer::new((width, height), LayerAttributes::default(), ENCODING, AnyChannels::sort(list));
        let sink = Cursor::new(&mut file);
        let result = exr::image::Image::from_layer(layer).write().non_parallel().to_buffered(sink);
        result.map_err(|error| error.to_string())
    });
    written.map_err(failed)?;
    Ok(file)
}

/// The bytes of a file with 32-bit floats R, G, B and, where the picture has it, A, in ZIP-compressed scan lines.
/// Colours are multiplied by alpha, as the format has it.
pub(crate) fn encode(image: &Image) -> Result<Vec<u8>, ImageError> {
    let encoding = ENCODING;
    let size = (image.width(), image.height());
    let attributes = LayerAttributes::default();
    let pixel = |Vec2(x, y): Vec2<usize>| image.pixel(x, y).unwrap_or_default();
    let mut file = Vec::new();
    let written = guarded(|| {
        let sink = Cursor::new(&mut file);
        let result = match image.channels() {
            Channels::Rgb => {
                let channels = SpecificChannels::rgb(|place: Vec2<usize>| {
                    let [r, g, b, _] = pixel(place);
                    (r, g, b)
                });
                let layer = Layer::new(size, attributes, encoding, channels);
                exr::image::Image::from_layer(layer).write().non_parallel().to_buffered(sink)
            }
            Channels::Rgba => {
                let channels = SpecificChannels::rgba(|place: Vec2<usize>| {
                    let [r, g, b, a] = premultiplied(&pixel(place));
                    (r, g, b, a)
                });
                let layer = Layer::new(size, attributes, encoding, channels);
                exr::image::Image::from_layer(layer).write().non_parallel().to_buffered(sink)
            }
        };
        result.map_err(|error| error.to_string())
    });
    let (width, height) = size;
    written.map_err(|message| ImageError::Encoder { format: NAME, width, height, message })?;
    Ok(file)
}

/// The samples being filled.
struct Canvas {
    samples: Vec<f32>,
    width: usize,
    channels: usize,
}

impl Canvas {
    fn set(&mut self, Vec2(x, y): Vec2<usize>, rgba: [f32; 4]) {
        let start = (y * self.width + x) * self.channels;
        if let Some(pixel) = self.samples.get_mut(start..start + self.channels) {
            pixel.iter_mut().zip(rgba).for_each(|(sample, value)| *sample = value);
        }
    }
}

/// Reads the first layer that has the channels R, G, B or Y, with A if it is there, by which colours are divided.
pub(crate) fn decode(file: &[u8], limits: &Limits) -> Result<Image, ImageError> {
    let refused = |message: String| ImageError::Decoder { format: NAME, message };
    let meta =
        guarded(|| MetaData::read_from_buffered(Cursor::new(file), false).map_err(|error| error.to_string()));
    let meta = meta.map_err(refused)?;
    let is_grey = !meta.headers.iter().any(is_colour);
    // The first layer that fits is the one the crate takes below.
    let chosen =
        meta.headers.iter().find(|header| if is_grey { is_luminance(header) } else { is_colour(header) });
    let chosen = chosen.ok_or_else(|| refused(no_channels(&meta)))?;
    let channels = if has(chosen, "A") { Channels::Rgba } else { Channels::Rgb };
    // The samples and, for files of one block, the block's bytes once.
    let bytes_per_pixel = 4 * channels.count() as u64 + chosen.channels.bytes_per_pixel as u64;
    let Vec2(width, height) = chosen.layer_size;
    let (width, height) = limits.check(width as u64, height as u64, bytes_per_pixel)?;
    if chosen.channels.list.iter().any(|channel| channel.sampling != Vec2(1, 1)) {
        return Err(refused(
            "some of its channels are stored at a lower resolution, which is not read here".into(),
        ));
    }
    check_chunks(file, &meta)?;
    let samples = guarded(|| if is_grey { read_grey(file, channels) } else { read_colour(file, channels) });
    Image::from_samples(width, height, channels, samples.map_err(refused)?)
}

/// Every chunk has an offset in the file's table, so a file with fewer bytes than that lies about its size.
fn check_chunks(file: &[u8], meta: &MetaData) -> Result<(), ImageError> {
    let chunks = meta.headers.iter().fold(0_u64, |sum, header| sum.saturating_add(header.chunk_count as u64));
    let needed = chunks.saturating_mul(8);
    let length = file.len() as u64;
    if needed > length {
        return Err(ImageError::Truncated {
            format: NAME,
            what: "the table of chunks",
            offset: 0,
            needed,
            length,
        });
    }
    Ok(())
}

fn has(header: &Header, name: &str) -> bool {
    header.channels.list.iter().any(|channel| channel.name.eq(name))
}

fn is_colour(header: &Header) -> bool {
    !header.deep && ["R", "G", "B"].iter().all(|name| has(header, name))
}

fn is_luminance(header: &Header) -> bool {
    !header.deep && has(header, "Y")
}

fn no_channels(meta: &MetaData) -> String {
    let names: Vec<String> = meta
        .headers
        .iter()
        .flat_map(|header| header.channels.list.iter())
        .take(16)
        .map(|channel| channel.name.to_string())
        .collect();
    format!("its channels are {}, expected a flat layer with R, G, B or Y", names.join(", "))
}

fn canvas(Vec2(width, height): Vec2<usize>, channels: Channels) -> Canvas {
    // The size has been checked; a vector that cannot be had stays empty, and the sample count then is wrong.
    let samples = crate::image::zeroed(width, height, channels).unwrap_or_default();
    Canvas { samples, width, channels: channels.count() }
}

fn read_colour(file: &[u8], channels: Channels) -> Result<Vec<f32>, String> {
    let image = read()
        .no_deep_data()
        .largest_resolution_level()
        .rgba_channels(
            move |size, _| canvas(size, channels),
            |canvas: &mut Canvas, place, (r, g, b, a): (f32, f32, f32, f32)| {
                canvas.set(place, straight([r, g, b, a]));
            },
        )
        .first_valid_layer()
        .all_attributes()
        .non_parallel()
        .from_buffered(Cursor::new(file));
    image.map(|image| image.layer_data.channel_data.pixels.samples).map_err(|error| error.to_string())
}

fn read_grey(file: &[u8], channels: Channels) -> Result<Vec<f32>, String> {
    let image = read()
        .no_deep_data()
        .largest_resolution_level()
        .specific_channels()
        .required("Y")
        .optional("A", 1.0_f32)
        .collect_pixels(
            move |size, _| canvas(size, channels),
            |canvas: &mut Canvas, place, (y, a): (f32, f32)| canvas.set(place, straight([y, y, y, a])),
        )
        .first_valid_layer()
        .all_attributes()
        .non_parallel()
        .from_buffered(Cursor::new(file));
    image.map(|image| image.layer_data.channel_data.pixels.samples).map_err(|error| error.to_string())
}

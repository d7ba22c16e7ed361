//! Textures as a GPU wants them: layers of one size, eight bits a channel; and the heights of those that lean normals.

use dotray_image::Format;
use dotray_image::Image;
use dotray_image::Limits;
use dotray_scene::Files;
use dotray_scene::Resolved;
use dotray_scene::resolved::ResolvedTexture;
use std::collections::BTreeSet;

/// All textures, each a layer of `edge` × `edge` texels of red, green, blue and alpha.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Pictures {
    /// Texels along an edge.
    pub edge: u32,
    /// The layers.
    pub layers: Vec<Vec<u8>>,
    /// The textures that lean normals.
    pub heights: Vec<Heights>,
}

/// A texture as a height: what it leans is seen where its texels are off by a level, so it is kept as it was read.
#[derive(Clone, Debug, PartialEq)]
pub struct Heights {
    /// The texture's number.
    pub texture: u32,
    /// Columns and rows of the file.
    pub size: [usize; 2],
    /// Columns and rows that are kept.
    pub kept: [usize; 2],
    /// The brightness of each texel that is kept, the upper row first.
    pub brightness: Vec<f32>,
}

/// The largest edge of a layer: the preview need not show more.
const MOST: u32 = 1024;

/// Bytes that all layers may have together.
const MOST_BYTES: u64 = 256 << 20;

/// Texels that are kept as heights, of all textures together.
const MOST_HEIGHTS: usize = 1 << 21;

impl Pictures {
    /// Reads and decodes the textures; one that cannot be read is white, since the tracer tells what is wrong with it.
    pub fn load(resolved: &Resolved, files: &dyn Files) -> Self {
        let images: Vec<Option<Image>> =
            resolved.textures.iter().map(|texture| decoded(texture, files)).collect();
        let largest =
            images.iter().flatten().map(|image| image.width().max(image.height())).max().unwrap_or(1);
        let mut edge = u32::try_from(largest).unwrap_or(MOST).next_power_of_two().min(MOST);
        while edge > 16 && u64::from(edge) * u64::from(edge) * 4 * images.len() as u64 > MOST_BYTES {
            edge /= 2;
        }
        let layers = images.iter().map(|image| layer(image.as_ref(), edge)).collect();
        let bumps: BTreeSet<u32> =
            resolved.materials.iter().flat_map(|m| m.procedural.bump_textures()).collect();
        let most = MOST_HEIGHTS / bumps.len().max(1);
        let height = |number: &u32| Some(heights(*number, images.get(*number as usize)?.as_ref()?, most));
        Self { edge, layers, heights: bumps.iter().filter_map(height).collect() }
    }
}

fn decoded(texture: &ResolvedTexture, files: &dyn Files) -> Option<Image> {
    let limits = Limits::default();
    let mut candidates = texture.candidates.iter();
    let (bytes, path) =
        candidates.find_map(|path| Some((files.read_at_most(path, limits.max_bytes).ok()?, path)))?;
    dotray_image::decode(&bytes, Format::from_path(path).ok(), &limits).ok()
}

/// The mean of the texels that a texel of a smaller picture covers, or the nearest one.
fn mean(image: &Image, [column, row]: [usize; 2], [columns, rows]: [usize; 2]) -> [f32; 3] {
    let covered = |at: usize, edge: usize, size: usize| {
        let start = at * size / edge;
        start..((at + 1) * size / edge).max(start + 1).min(size.max(1))
    };
    let (mut sum, mut count) = ([0.0_f32; 3], 0.0_f32);
    for y in covered(row, rows, image.height()) {
        for x in covered(column, columns, image.width()) {
            let [r, g, b, _] = image.pixel(x, y).unwrap_or_default();
            sum = [sum[0] + r, sum[1] + g, sum[2] + b];
            count += 1.0;
        }
    }
    sum.map(|channel| channel / count.max(1.0))
}

/// The image as a height, halved until it has as few texels as there is room for.
fn heights(texture: u32, image: &Image, most: usize) -> Heights {
    let size = [image.width(), image.height()];
    let mut kept = size;
    while kept[0] * kept[1] > most.max(1) {
        kept = kept.map(|edge| edge.div_ceil(2));
    }
    let places = (0..kept[1]).flat_map(|row| (0..kept[0]).map(move |column| [column, row]));
    let brightness = places.map(|place| mean(image, place, kept).iter().sum::<f32>() / 3.0).collect();
    Heights { texture, size, kept, brightness }
}

/// The image stretched to a square.
fn layer(image: Option<&Image>, edge: u32) -> Vec<u8> {
    let mut texels = Vec::with_capacity(edge as usize * edge as usize * 4);
    let Some(image) = image else {
        texels.resize(texels.capacity(), 255);
        return texels;
    };
    let edge = edge as usize;
    for place in (0..edge).flat_map(|row| (0..edge).map(move |column| [column, row])) {
        let level = |channel: f32| (channel * 255.0).round().clamp(0.0, 255.0) as u8;
        texels.extend(mean(image, place, [edge; 2]).map(level));
        texels.push(255);
    }
    texels
}

#[cfg(test)]
mod tests {
    use super::*;
    use dotray_image::Channels;

    #[test]
    fn layers_keep_the_corners_and_the_mean() {
        let samples = vec![1.0, 0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 1.0, 1.0, 1.0, 1.0];
        let image = Image::from_samples(2, 2, Channels::Rgb, samples).unwrap();
        let large = layer(Some(&image), 4);
        assert_eq!((&large[..4], &large[60..]), (&[255, 0, 0, 255][..], &[255; 4][..]));
        assert_eq!(layer(Some(&image), 1), [128, 128, 128, 255]);
        assert_eq!(layer(None, 2), [255; 16]);
    }

    #[test]
    fn heights_are_kept_as_they_are_where_there_is_room() {
        let samples = (0..3 * 6 * 4).map(|k| k as f32 / 100.0).collect();
        let image = Image::from_samples(6, 4, Channels::Rgb, samples).unwrap();
        let all = heights(7, &image, 24);
        assert_eq!((all.texture, all.size, all.kept), (7, [6, 4], [6, 4]));
        assert!(
            all.brightness
                .iter()
                .enumerate()
                .all(|(k, height)| (height - (k as f32 * 3.0 + 1.0) / 100.0).abs() < 1e-6)
        );
        let few = heights(7, &image, 23);
        assert_eq!((few.size, few.kept, few.brightness.len()), ([6, 4], [3, 2], 6));
        assert!((few.brightness[0] - (all.brightness[0] + all.brightness[7]) / 2.0).abs() < 1e-6);
    }
}

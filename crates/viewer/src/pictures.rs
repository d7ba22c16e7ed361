//! Textures as a GPU wants them: layers of one size, eight bits a channel.

use dotray_image::Format;
use dotray_image::Image;
use dotray_image::Limits;
use dotray_scene::Files;
use dotray_scene::resolved::ResolvedTexture;

/// All textures, each a layer of `edge` × `edge` texels of red, green, blue and alpha.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Pictures {
    /// Texels along an edge.
    pub edge: u32,
    /// The layers.
    pub layers: Vec<Vec<u8>>,
}

/// The largest edge of a layer: the preview need not show more.
const MOST: u32 = 1024;

/// Bytes that all layers may have together.
const MOST_BYTES: u64 = 256 << 20;

impl Pictures {
    /// Reads and decodes the textures; one that cannot be read is white, since the tracer tells what is wrong with it.
    pub fn load(textures: &[ResolvedTexture], files: &dyn Files) -> Self {
        let images: Vec<Option<Image>> = textures.iter().map(|texture| decoded(texture, files)).collect();
        let largest =
            images.iter().flatten().map(|image| image.width().max(image.height())).max().unwrap_or(1);
        let mut edge = u32::try_from(largest).unwrap_or(MOST).next_power_of_two().min(MOST);
        while edge > 16 && u64::from(edge) * u64::from(edge) * 4 * images.len() as u64 > MOST_BYTES {
            edge /= 2;
        }
        let layers = images.iter().map(|image| layer(image.as_ref(), edge)).collect();
        Self { edge, layers }
    }
}

fn decoded(texture: &ResolvedTexture, files: &dyn Files) -> Option<Image> {
    let limits = Limits::default();
    let mut candidates = texture.candidates.iter();
    let (bytes, path) =
        candidates.find_map(|path| Some((files.read_at_most(path, limits.max_bytes).ok()?, path)))?;
    dotray_image::decode(&bytes, Format::from_path(path).ok(), &limits).ok()
}

/// The image stretched to a square: the mean of the texels that a texel covers, or the nearest one.
fn layer(image: Option<&Image>, edge: u32) -> Vec<u8> {
    let mut texels = Vec::with_capacity(edge as usize * edge as usize * 4);
    let Some(image) = image else {
        texels.resize(texels.capacity(), 255);
        return texels;
    };
    let covered = |at: u32, size: usize| {
        let start = at as usize * size / edge as usize;
        let end = ((at as usize + 1) * size / edge as usize).max(start + 1).min(size.max(1));
        start..end
    };
    for row in 0..edge {
        let rows = covered(row, image.height());
        for column in 0..edge {
            let columns = covered(column, image.width());
            let mut sum = [0.0_f32; 3];
            let mut count = 0.0_f32;
            for (x, y) in rows.clone().flat_map(|y| columns.clone().map(move |x| (x, y))) {
                let [r, g, b, _] = image.pixel(x, y).unwrap_or_default();
                (sum[0], sum[1], sum[2]) = (sum[0] + r, sum[1] + g, sum[2] + b);
                count += 1.0;
            }
            texels.extend(sum.map(|x| (x / count.max(1.0) * 255.0).round().clamp(0.0, 255.0) as u8));
            texels.push(255);
        }
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
}

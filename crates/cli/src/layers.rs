//! Layers as files: channels of an OpenEXR picture, or pictures that people can read.

use colorous::Gradient;
use dotray::Image;
use dotray::image::Channels;
use dotray::image::EncodeOptions;
use dotray::image::Format;
use dotray::image::ImageError;
use dotray::image::NamedChannel;
use dotray::image::encode;
use dotray::render::Fingerprint;
use dotray::render::Layer;
use dotray::render::LayerPicture;
use dotray::scene::number::General;
use font8x8::UnicodeFonts;
use std::path::Path;
use std::path::PathBuf;

/// The channels `layer.channel` of an OpenEXR file.
pub fn channels(layers: Vec<LayerPicture>) -> Vec<NamedChannel> {
    let mut all = Vec::new();
    for picture in layers {
        let names = picture.layer.channels();
        for (index, name) in names.iter().enumerate() {
            let samples = picture.samples.iter().skip(index).step_by(names.len()).copied().collect();
            all.push(NamedChannel { name: format!("{}.{name}", picture.layer.name()), samples });
        }
    }
    all
}

/// What a picture with these layers depends on: their bands have numbers that follow from which they are.
pub fn with_layers(fingerprint: Fingerprint, layers: &[Layer]) -> Fingerprint {
    if layers.is_empty() { fingerprint } else { fingerprint.with("layers", &names(layers)) }
}

/// The layers as they are typed.
pub fn names(layers: &[Layer]) -> String {
    let names: Vec<&str> = layers.iter().map(|layer| layer.name()).collect();
    names.join(",")
}

/// `folder/a.png` → `folder/a.depth.png`
pub fn path_of(picture: &Path, layer: Layer) -> PathBuf {
    picture.with_extension(format!("{}.png", layer.name()))
}

/// The bytes of a PNG that shows a layer.
pub fn png(picture: &LayerPicture) -> Result<Vec<u8>, ImageError> {
    encode(&shown(picture)?, Format::Png, &EncodeOptions::default())
}

/// A layer as a picture for people.
fn shown(picture: &LayerPicture) -> Result<Image, ImageError> {
    let pixels = || picture.samples.chunks_exact(picture.layer.channels().len());
    let rgb = |samples: Vec<f32>| Image::from_samples(picture.width, picture.height, Channels::Rgb, samples);
    match picture.layer {
        Layer::Depth => heat_map(picture, colorous::VIRIDIS, "t"),
        Layer::Rays | Layer::BoxTests | Layer::ShapeTests => {
            heat_map(picture, colorous::INFERNO, picture.layer.name())
        }
        Layer::Shape | Layer::Material => rgb(pixels().flatten().flat_map(|&id| color_of(id)).collect()),
        Layer::Normal => {
            let color = |normal: &[f32]| {
                let met = normal.iter().any(|&x| x != 0.0);
                normal.iter().map(|x| if met { 0.5 + 0.5 * x } else { 0.0 }).collect::<Vec<_>>()
            };
            rgb(pixels().flat_map(color).collect())
        }
        Layer::St => {
            let wrapped = |x: f32| x - x.floor();
            rgb(pixels().flat_map(|st| st.iter().map(|&x| wrapped(x)).chain([0.0])).collect())
        }
        Layer::Position | Layer::Object => rgb(stretched(picture)),
        Layer::Shadow | Layer::Direct | Layer::Reflected | Layer::Transmitted => rgb(picture.samples.clone()),
    }
}

/// Each channel from its least to its greatest number.
fn stretched(picture: &LayerPicture) -> Vec<f32> {
    let count = picture.layer.channels().len();
    let mut ranges = vec![(f32::INFINITY, f32::NEG_INFINITY); count];
    for pixel in picture.samples.chunks_exact(count) {
        for ((least, most), &sample) in ranges.iter_mut().zip(pixel) {
            (*least, *most) = (least.min(sample), most.max(sample));
        }
    }
    let scaled = |(&sample, (least, most)): (&f32, &(f32, f32))| {
        if most > least { (sample - least) / (most - least) } else { 0.5 }
    };
    picture
        .samples
        .chunks_exact(count)
        .flat_map(|pixel| pixel.iter().zip(&ranges).map(scaled).collect::<Vec<_>>())
        .collect()
}

/// Colours that tell numbers apart: turns of the golden angle around the circle of hues; -1 is black.
fn color_of(id: f32) -> [f32; 3] {
    if id < 0.0 {
        return [0.0; 3];
    }
    let hue = f64::from(id) * 0.618_033_988_749_895;
    let [r, g, b] = colorous::SINEBOW.eval_continuous(hue - hue.floor()).into_array();
    // Every other number darker, so that neighbours on the circle differ, too.
    let shade = if id % 2.0 == 0.0 { 255.0 } else { 340.0 };
    [r, g, b].map(|c| f32::from(c) / shade)
}

const LEGEND_ROWS: usize = 28;
const BAR_ROWS: usize = 12;

/// A picture by a perceptual colour map, what is not finite in black, and below it a bar with the least and the
/// greatest number.
fn heat_map(picture: &LayerPicture, map: Gradient, name: &str) -> Result<Image, ImageError> {
    let finite = || picture.samples.iter().copied().filter(|sample| sample.is_finite());
    let least = finite().fold(f32::INFINITY, f32::min);
    let most = finite().fold(f32::NEG_INFINITY, f32::max);
    let color = |share: f64| map.eval_continuous(share).into_array().map(|c| f32::from(c) / 255.0);
    let share = |sample: f32| {
        let range = f64::from(most) - f64::from(least);
        if range > 0.0 { (f64::from(sample) - f64::from(least)) / range } else { 0.5 }
    };
    let mut image = Image::new(picture.width, picture.height + LEGEND_ROWS, Channels::Rgb)?;
    let mut put = |x: usize, y: usize, [r, g, b]: [f32; 3]| {
        image.set_pixel(x, y, [r, g, b, 1.0]);
    };
    for (index, &sample) in picture.samples.iter().enumerate() {
        if sample.is_finite() {
            put(index % picture.width, index / picture.width, color(share(sample)));
        }
    }
    if least > most {
        return Ok(image);
    }
    for x in 0..picture.width {
        let share = if picture.width > 1 { x as f64 / (picture.width - 1) as f64 } else { 0.5 };
        (1..=BAR_ROWS).for_each(|y| put(x, picture.height + y, color(share)));
    }
    let [low, high] = [least, most].map(|number| General(f64::from(number)).to_string());
    let row = picture.height + BAR_ROWS + 4;
    let width = |text: &str| 8 * text.len();
    if width(&low) + width(&high) + 8 <= picture.width {
        write(&mut image, 1, row, &low);
        write(&mut image, picture.width - width(&high) - 1, row, &high);
        let middle = (picture.width - width(name).min(picture.width)) / 2;
        if width(&low) + 8 <= middle && middle + width(name) + 8 + width(&high) <= picture.width {
            write(&mut image, middle, row, name);
        }
    }
    Ok(image)
}

/// White letters of 8 x 8 pixels.
fn write(image: &mut Image, x: usize, y: usize, text: &str) {
    for (index, letter) in text.chars().enumerate() {
        let Some(rows) = font8x8::BASIC_FONTS.get(letter) else { continue };
        for (down, bits) in rows.into_iter().enumerate() {
            for across in (0..8).filter(|across| bits >> across & 1 == 1) {
                image.set_pixel(x + 8 * index + across, y + down, [1.0; 4]);
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn layer(layer: Layer, samples: &[f32]) -> LayerPicture {
        let width = samples.len() / layer.channels().len();
        LayerPicture { layer, width, height: 1, samples: samples.to_vec() }
    }

    fn pixels(picture: &LayerPicture) -> Vec<[f32; 3]> {
        let image = shown(picture).expect("a picture");
        (0..picture.width).filter_map(|x| image.pixel(x, 0)).map(|[r, g, b, _]| [r, g, b]).collect()
    }

    #[test]
    fn channels_keep_their_numbers() {
        let all = channels(vec![
            layer(Layer::Normal, &[1.0, 2.0, 3.0, 4.0, 5.0, 6.0]),
            layer(Layer::Shape, &[7.0, 8.0]),
        ]);
        let told: Vec<(&str, &[f32])> = all.iter().map(|c| (c.name.as_str(), c.samples.as_slice())).collect();
        let expected: [(&str, &[f32]); 4] = [
            ("normal.X", &[1.0, 4.0]),
            ("normal.Y", &[2.0, 5.0]),
            ("normal.Z", &[3.0, 6.0]),
            ("shape.id", &[7.0, 8.0]),
        ];
        assert_eq!(told, expected);
    }

    #[test]
    fn people_see_what_the_numbers_say() {
        assert_eq!(
            pixels(&layer(Layer::Normal, &[0.0, 0.0, 1.0, -1.0, 0.0, 0.0, 0.0, 0.0, 0.0])),
            [[0.5, 0.5, 1.0], [0.0, 0.5, 0.5], [0.0; 3]]
        );
        assert_eq!(
            pixels(&layer(Layer::St, &[0.25, 0.5, 1.25, -0.25])),
            [[0.25, 0.5, 0.0], [0.25, 0.75, 0.0]]
        );
        let stretched = pixels(&layer(Layer::Position, &[2.0, -1.0, 5.0, 4.0, 1.0, 5.0, 3.0, 0.0, 5.0]));
        assert_eq!(stretched, [[0.0, 0.0, 0.5], [1.0, 1.0, 0.5], [0.5, 0.5, 0.5]]);
        let ids = pixels(&layer(Layer::Shape, &[-1.0, 0.0, 1.0, 2.0, 0.0]));
        assert_eq!((ids[0], ids[1]), ([0.0; 3], ids[4]));
        let far = |a: [f32; 3], b: [f32; 3]| a.iter().zip(b).any(|(a, b)| (a - b).abs() > 0.1);
        assert!(far(ids[1], ids[2]) && far(ids[2], ids[3]) && far(ids[1], ids[3]), "{ids:?}");
    }

    #[test]
    fn a_legend_names_the_least_and_the_greatest() {
        let mut samples = vec![5.0; 200];
        samples[7] = 1234.0;
        let image = shown(&layer(Layer::Rays, &samples)).expect("a picture");
        let white = |columns: std::ops::Range<usize>| {
            let rows = BAR_ROWS..LEGEND_ROWS;
            let lit = rows.flat_map(|y| columns.clone().map(move |x| (x, y + 1)));
            lit.filter(|&(x, y)| image.pixel(x, y) == Some([1.0; 4])).count()
        };
        // A `5` on the left, `1234` on the right, the layer's name between.
        assert!((5..40).contains(&white(0..9)), "{}", white(0..9));
        assert_eq!(white(9..60), 0);
        assert!(white(160..200) > 40 && white(80..120) > 40);
        // The map runs from dark to bright.
        let [low, high] = [0, 7].map(|x| image.pixel(x, 0).expect("a pixel"));
        assert!(
            low.iter().take(3).sum::<f32>() < 0.1 && high.iter().take(3).sum::<f32>() > 2.0,
            "{low:?} {high:?}"
        );
    }
}

//! A crop is a part of the whole picture, bit for bit.

use crate::same_bytes::small_corpus;
use dotray_accel::Kind;
use dotray_render::Antialias;
use dotray_render::Crop;
use dotray_render::Options;
use dotray_tests::pictures;

#[test]
fn a_crop_is_a_part_of_the_whole() {
    for (i, (name, scene, options)) in small_corpus().into_iter().enumerate() {
        let world = pictures::world(scene, Kind::Bvh).unwrap_or_else(|error| panic!("{name}: {error}"));
        let antialias = match i % 3 {
            0 => options.antialias,
            1 => Antialias::ADAPTIVE,
            _ => Antialias::Grid(2),
        };
        let options = Options { antialias, tile_size: 16, ..options };
        let whole = pictures::picture(&world, &options).unwrap_or_else(|error| panic!("{name}: {error}"));
        let (w, h) = (options.width, options.height);
        let crops = [
            (0, 0, 1, 1),
            (w - 1, h - 1, 1, 1),
            (3, 5, w - 7, h - 6),
            (w / 2, 0, w / 2, h),
            (0, h / 3, w, 1),
        ];
        for (x, y, width, height) in crops {
            let options = Options { crop: Some(Crop { x, y, width, height }), ..options.clone() };
            let part = pictures::picture(&world, &options).unwrap_or_else(|error| panic!("{name}: {error}"));
            let expected =
                whole.crop(x as usize, y as usize, width as usize, height as usize).expect("inside");
            let difference = pictures::difference(&expected, &part);
            assert_eq!(difference, None, "{name}, crop {x},{y},{width},{height} at {antialias:?}");
        }
    }
}

//! No bytes make a reader panic, hang or take memory without bound.

#![allow(clippy::unwrap_used, clippy::indexing_slicing)]

use dotray_image::Channels;
use dotray_image::EncodeOptions;
use dotray_image::Format;
use dotray_image::Image;
use dotray_image::ImageError;
use dotray_image::Limits;
use dotray_image::decode;
use dotray_image::encode;
use proptest::prelude::*;

/// Small limits, so that a file that claims to be large costs nothing.
const LIMITS: Limits = Limits { max_pixels: 1 << 20, max_bytes: 64 << 20 };

fn built() -> impl Iterator<Item = Format> {
    Format::ALL.into_iter().filter(|format| format.is_built())
}

fn valid_file(format: Format, channels: Channels) -> Vec<u8> {
    let samples = (0..12 * 9 * channels.count()).map(|i| (i * 37 % 256) as f32 / 255.0).collect();
    let image = Image::from_samples(12, 9, channels, samples).unwrap();
    encode(&image, format, &EncodeOptions::default()).unwrap()
}

/// Headers of kinds that the writer never makes, to be filled with random bytes.
fn beginnings() -> Vec<Vec<u8>> {
    let bmp = |header: u32, bits: u16, compression: u32| {
        let mut file = b"BM\0\0\0\0\0\0\0\0".to_vec();
        [54_u32, header, 9, 5].iter().for_each(|field| file.extend(field.to_le_bytes()));
        [1, bits].iter().for_each(|field| file.extend(field.to_le_bytes()));
        [compression, 0, 0, 0, 4, 0].iter().for_each(|field| file.extend(field.to_le_bytes()));
        file.extend([0, 0, 255, 0].repeat(4));
        file
    };
    let mut all = vec![
        bmp(40, 8, 1),
        bmp(40, 4, 2),
        bmp(40, 1, 0),
        bmp(40, 2, 0),
        bmp(40, 4, 0),
        bmp(40, 16, 3),
        bmp(108, 32, 3),
        bmp(56, 16, 6),
        bmp(12, 8, 0),
        bmp(64, 24, 0),
    ];
    all.extend([&b"P1 5 4 "[..], b"P2 5 4 9 ", b"P3 2 4 9 ", b"P4 9 4\n", b"P5 5 4 9\n"].map(<[u8]>::to_vec));
    all.push(b"#?RADIANCE\n\n-Y 4 +X 9\n".to_vec());
    all.push(b"#?RADIANCE\n\n-Y 2 +X 9\n\x02\x02\x00\x09".to_vec());
    all.push(b"Pf 5 4 1\n".to_vec());
    all
}

/// Anything may come out, but it must be consistent, and a message must not be a novel.
fn check(bytes: &[u8], hint: Option<Format>) {
    match decode(bytes, hint, &LIMITS) {
        Ok(image) => {
            assert_eq!(image.samples().len(), image.width() * image.height() * image.channels().count());
        }
        Err(error) => assert!(error.to_string().len() < 600, "{error}"),
    }
}

#[test]
fn files_cut_anywhere() {
    for format in built() {
        for channels in [Channels::Rgb, Channels::Rgba] {
            let bytes = valid_file(format, channels);
            for length in 0..bytes.len() {
                check(&bytes[..length], Some(format));
            }
            // A quarter of any file is too little; JPEG decoders fill up what is missing.
            let quarter = decode(&bytes[..bytes.len() / 4], Some(format), &LIMITS);
            assert!(quarter.is_err() || format == Format::Jpeg, "{format:?}");
        }
    }
}

#[test]
fn every_byte_set_to_extremes() {
    for format in built() {
        let bytes = valid_file(format, Channels::Rgb);
        let places = (0..bytes.len()).filter(|place| *place < 128 || place % 7 == 0);
        for place in places {
            for value in [0, 1, 0x7f, 0x80, 0xff, bytes[place] ^ 0x10] {
                let mut broken = bytes.clone();
                broken[place] = value;
                check(&broken, Some(format));
            }
        }
    }
}

#[test]
fn claims_without_substance_are_refused_quickly() {
    // 2^28 pixels are within the default limits, but the files hold nothing.
    let claims: [&[u8]; 5] = [
        b"P6 16384 16384 255\n",
        b"P3 16384 16384 255\n1 2 3",
        b"PF 16384 16384 -1\n",
        b"#?RADIANCE\n\n-Y 16384 +X 16384\n",
        b"qoif\0\0\x40\0\0\0\x40\0\x03\0",
    ];
    for claim in claims {
        let hint = Format::sniff(claim).unwrap();
        let error = decode(claim, None, &Limits::default()).unwrap_err();
        let right = matches!(error, ImageError::Truncated { .. });
        assert!(right || !hint.is_built(), "{error}");
    }
}

proptest! {
    #![proptest_config(ProptestConfig { cases: 2000, failure_persistence: None, ..ProptestConfig::default() })]

    #[test]
    fn random_bytes(bytes in prop::collection::vec(any::<u8>(), 0..300)) {
        for format in built() {
            check(&bytes, Some(format));
        }
    }

    #[test]
    fn random_bytes_behind_a_valid_beginning(
        number in 0..1000_usize,
        kept in 0..200_usize,
        bytes in prop::collection::vec(any::<u8>(), 0..300),
    ) {
        let mut all = beginnings();
        let complete = all.len();
        all.extend(built().map(|format| valid_file(format, Channels::Rgb)));
        let number = number % all.len();
        let mut file = all.swap_remove(number);
        if number >= complete {
            file.truncate(kept);
        }
        file.extend(bytes);
        check(&file, None);
    }

    #[test]
    fn several_bytes_changed(
        number in 0..1000_usize,
        changes in prop::collection::vec((any::<prop::sample::Index>(), any::<u8>()), 1..6),
    ) {
        let formats: Vec<Format> = built().collect();
        let format = formats[number % formats.len()];
        let mut file = valid_file(format, if number % 2 == 0 { Channels::Rgb } else { Channels::Rgba });
        for (place, value) in changes {
            let place = place.index(file.len());
            file[place] = value;
        }
        check(&file, Some(format));
    }
}

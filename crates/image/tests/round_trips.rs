//! Every format gives back what it can hold.

#![allow(clippy::unwrap_used, clippy::indexing_slicing)]

use dotray_image::Channels;
use dotray_image::EncodeOptions;
use dotray_image::Format;
use dotray_image::Image;
use dotray_image::ImageError;
use dotray_image::Limits;
use dotray_image::compare::compare;
use dotray_image::decode;
use dotray_image::encode;

/// Smooth colours with some values outside 0…1.
fn picture(width: usize, height: usize, channels: Channels) -> Image {
    let mut image = Image::new(width, height, channels).unwrap();
    for y in 0..height {
        for x in 0..width {
            let (s, t) = ((x as f32 + 0.3) / width as f32, (y as f32 + 0.6) / height as f32);
            image.set_pixel(x, y, [1.2 * s - 0.1, t, 0.5 * (s + t), 1.0 - s * t]);
        }
    }
    image
}

fn again(image: &Image, format: Format) -> Image {
    let bytes = encode(image, format, &EncodeOptions::default()).unwrap();
    assert_eq!(
        bytes,
        encode(image, format, &EncodeOptions::default()).unwrap(),
        "{format:?} is not deterministic"
    );
    let sniffed = Format::sniff(&bytes).unwrap();
    let expected = if format == Format::Png16 { Format::Png } else { format };
    assert_eq!(sniffed, expected);
    decode(&bytes, None, &Limits::default()).unwrap()
}

/// What remains of a picture after quantisation to `levels` steps, without alpha if the format has none.
fn quantised(image: &Image, levels: f64, channels: Channels) -> Image {
    let round = |c: f32| (f64::from(c).clamp(0.0, 1.0) * levels).round() as f32 / levels as f32;
    let mut expected = Image::new(image.width(), image.height(), channels).unwrap();
    for y in 0..image.height() {
        for x in 0..image.width() {
            expected.set_pixel(x, y, image.pixel(x, y).unwrap().map(round));
        }
    }
    expected
}

#[test]
fn formats_of_whole_numbers_are_exact_to_the_level() {
    let all = [Format::Bmp, Format::Ppm, Format::Png, Format::Png16, Format::Qoi, Format::Tiff];
    for format in all.into_iter().filter(|format| format.is_built()) {
        for channels in [Channels::Rgb, Channels::Rgba] {
            for (width, height) in [(1, 1), (2, 3), (3, 2), (5, 1), (37, 23)] {
                let image = picture(width, height, channels);
                let keeps_alpha = !matches!(format, Format::Bmp | Format::Ppm);
                let kept = if keeps_alpha { channels } else { Channels::Rgb };
                let levels = if format == Format::Png16 { 65535.0 } else { 255.0 };
                assert_eq!(
                    again(&image, format),
                    quantised(&image, levels, kept),
                    "{format:?} {width}x{height}"
                );
            }
        }
    }
}

#[test]
fn float_formats_keep_values() {
    for format in [Format::Exr, Format::Pfm].into_iter().filter(|format| format.is_built()) {
        for channels in [Channels::Rgb, Channels::Rgba] {
            let mut image = picture(37, 23, channels);
            image.set_pixel(3, 4, [-7.5, 1e30, f32::INFINITY, 0.25]);
            let kept = if format == Format::Exr { channels } else { Channels::Rgb };
            let back = again(&image, format);
            assert_eq!(back.channels(), kept);
            let rgb = |image: &Image| -> Vec<[f32; 4]> {
                (0..37 * 23).map(|i| image.pixel(i % 37, i / 37).unwrap()).collect()
            };
            for (a, b) in rgb(&image).into_iter().zip(rgb(&back)) {
                // OpenEXR stores colours multiplied by alpha.
                let near = |(a, b): (&f32, &f32)| a == b || (a - b).abs() <= 1e-6 * a.abs();
                let exact = kept == Channels::Rgb;
                assert!(
                    if exact { a[..3] == b[..3] } else { a[..3].iter().zip(&b[..3]).all(near) },
                    "{format:?}"
                );
                assert!(kept == Channels::Rgb || a[3] == b[3]);
            }
        }
    }
}

#[test]
fn radiance_keeps_seven_bits() {
    for width in [1, 7, 8, 37, 300] {
        let mut image = picture(width, 5, Channels::Rgb);
        // Runs, short and long.
        (width / 3..width).for_each(|x| assert!(image.set_pixel(x, 2, [100.0, 0.5, 0.0, 1.0])));
        let back = again(&image, Format::Hdr);
        for (pixel, stored) in image.samples().chunks_exact(3).zip(back.samples().chunks_exact(3)) {
            let greatest = pixel.iter().fold(0.0_f32, |a, &b| a.max(b));
            for (value, stored) in pixel.iter().zip(stored) {
                assert!((value.max(0.0) - stored).abs() <= greatest / 255.0, "{pixel:?} {stored}");
            }
        }
    }
}

#[test]
fn jpeg_is_near() {
    if !Format::Jpeg.is_built() {
        return;
    }
    let image = picture(64, 48, Channels::Rgba);
    let back = again(&image, Format::Jpeg);
    let figures = compare(&quantised(&image, 255.0, Channels::Rgb), &back, 0.0).unwrap();
    assert!(figures.max < 0.03 && figures.psnr > 40.0, "{figures:?}");
    let options = EncodeOptions { jpeg_quality: 101, ..EncodeOptions::default() };
    assert_eq!(encode(&image, Format::Jpeg, &options), Err(ImageError::JpegQuality { quality: 101 }));
}

#[test]
fn srgb_changes_whole_numbers_only() {
    let image = Image::from_samples(1, 1, Channels::Rgba, vec![0.214_041_14, 0.0, 1.0, 0.5]).unwrap();
    let options = EncodeOptions { srgb: true, ..EncodeOptions::default() };
    for format in Format::ALL.into_iter().filter(|format| format.is_built()) {
        let back = decode(&encode(&image, format, &options).unwrap(), None, &Limits::default()).unwrap();
        let [red, _, _, alpha] = back.pixel(0, 0).unwrap();
        let expected = if format.is_float() { 0.214 } else { 0.5 };
        assert!((red - expected).abs() < 0.01, "{format:?} {red}");
        assert!(alpha == 1.0 || (alpha - 0.5).abs() < 0.01, "{format:?} {alpha}");
    }
}

#[test]
fn limits_come_before_memory() {
    let image = picture(40, 30, Channels::Rgb);
    for format in Format::ALL.into_iter().filter(|format| format.is_built()) {
        let bytes = encode(&image, format, &EncodeOptions::default()).unwrap();
        let few_pixels = Limits { max_pixels: 1199, ..Limits::default() };
        let error = decode(&bytes, None, &few_pixels).unwrap_err();
        assert_eq!(error, ImageError::Size { width: 40, height: 30, max_pixels: 1199 }, "{format:?}");
        let few_bytes = Limits { max_bytes: 14_000, ..Limits::default() };
        let error = decode(&bytes, None, &few_bytes).unwrap_err();
        assert!(matches!(error, ImageError::Memory { .. }), "{format:?} {error}");
    }
}

#[test]
fn hostile_headers_are_refused() {
    let png = b"\x89PNG\r\n\x1a\n\0\0\0\x0dIHDR\0\0\xff\xff\0\0\xff\xff\x08\x02\0\0\0\x2e\xa8\x2c\x5b";
    let mut bmp = encode(&picture(1, 1, Channels::Rgb), Format::Bmp, &EncodeOptions::default()).unwrap();
    bmp[18..26].copy_from_slice(&[0xff, 0xff, 0, 0, 0xff, 0xff, 0, 0]);
    let refused = |bytes: &[u8]| decode(bytes, None, &Limits::default()).unwrap_err().to_string();
    let size = "picture size 65535 x 65535 refused";
    assert!(refused(&bmp).starts_with(size), "{}", refused(&bmp));
    if Format::Png.is_built() {
        // The crate checks the chunk's sum first on some versions; either way nothing is decoded.
        let message = refused(png);
        assert!(message.starts_with(size) || message.starts_with("PNG file cannot be read"), "{message}");
        let qoi = b"qoif\0\0\x40\0\0\0\x40\0\x03\0\0\0\0\0\0\0\0\x01";
        assert!(refused(qoi).starts_with("QOI file ends at byte 22"), "{}", refused(qoi));
        let qoi = b"qoif\0\0\xff\xff\0\0\x1f\xff\x03\0\0\0\0\0\0\0\0\x01";
        assert!(refused(qoi).contains("refused") || refused(qoi).contains("QOI"), "{}", refused(qoi));
    }
}

#[test]
fn content_counts_before_the_hint() {
    let bmp = encode(&picture(3, 2, Channels::Rgb), Format::Bmp, &EncodeOptions::default()).unwrap();
    assert!(decode(&bmp, Some(Format::Png), &Limits::default()).is_ok());
    let message = decode(b"hello", None, &Limits::default()).unwrap_err().to_string();
    assert!(message.starts_with("not a picture: the file begins with 68 65 6c 6c 6f,"), "{message}");
    let message = decode(b"hello", Some(Format::Bmp), &Limits::default()).unwrap_err().to_string();
    assert_eq!(message, "BMP file, byte 0: the signature is `he`, expected `BM`");
    assert!(decode(b"", None, &Limits::default()).unwrap_err().to_string().contains("begins with nothing"));
}

#[cfg(feature = "formats")]
#[test]
fn grey_and_deep_files_of_other_programs() {
    use image::ExtendedColorType;
    use image::ImageEncoder;
    let read = |bytes: &[u8]| decode(bytes, None, &Limits::default()).unwrap();
    let png = |data: &[u8], colour| {
        let mut bytes = Vec::new();
        image::codecs::png::PngEncoder::new(&mut bytes).write_image(data, 2, 1, colour).unwrap();
        bytes
    };
    let grey = read(&png(&[0, 255], ExtendedColorType::L8));
    assert_eq!((grey.channels(), grey.samples()), (Channels::Rgb, &[0.0, 0.0, 0.0, 1.0, 1.0, 1.0][..]));
    let grey = read(&png(&[0, 51, 255, 0], ExtendedColorType::La8));
    assert_eq!(grey.samples(), [0.0, 0.0, 0.0, 0.2, 1.0, 1.0, 1.0, 0.0]);
    let words: Vec<u8> = [0_u16, 13107, 65535, 0].iter().flat_map(|word| word.to_ne_bytes()).collect();
    let grey = read(&png(&words, ExtendedColorType::La16));
    assert_eq!(grey.samples(), [0.0, 0.0, 0.0, 0.2, 1.0, 1.0, 1.0, 0.0]);
    let grey = read(&png(&words[2..6], ExtendedColorType::L16));
    assert_eq!(grey.samples(), [0.2, 0.2, 0.2, 1.0, 1.0, 1.0]);
    let floats: Vec<u8> = [0.5_f32, -2.0, 7.0].iter().flat_map(|value| value.to_ne_bytes()).collect();
    let mut tiff = std::io::Cursor::new(Vec::new());
    let encoder = image::codecs::tiff::TiffEncoder::new(&mut tiff);
    encoder.write_image(&floats, 1, 1, ExtendedColorType::Rgb32F).unwrap();
    assert_eq!(read(tiff.get_ref()).samples(), [0.5, -2.0, 7.0]);
}

#[cfg(feature = "formats")]
#[test]
fn exr_of_other_programs() {
    use exr::prelude::*;
    let read = |bytes: &[u8]| decode(bytes, None, &Limits::default());
    let stored = |channels: Vec<AnyChannel<FlatSamples>>, compression: Compression| {
        let encoding = Encoding { compression, ..Encoding::FAST_LOSSLESS };
        let layer =
            Layer::new((2, 1), LayerAttributes::default(), encoding, AnyChannels::sort(channels.into()));
        let mut bytes = std::io::Cursor::new(Vec::new());
        Image::from_layer(layer).write().non_parallel().to_buffered(&mut bytes).unwrap();
        bytes.into_inner()
    };
    let half = |values: [f32; 2]| FlatSamples::F16(values.map(f16::from_f32).to_vec());
    let floats = |values: [f32; 2]| FlatSamples::F32(values.to_vec());
    for compression in [Compression::Uncompressed, Compression::RLE, Compression::ZIP1, Compression::PIZ] {
        let mixed = vec![
            AnyChannel::new("R", half([0.5, -2.0])),
            AnyChannel::new("G", floats([0.1, 1e20])),
            AnyChannel::new("B", FlatSamples::U32(vec![3, 4])),
            AnyChannel::new("A", half([0.25, 1.0])),
        ];
        let image = read(&stored(mixed, compression)).unwrap();
        // Divided by alpha.
        assert_eq!(image.samples(), [2.0, 0.4, 12.0, 0.25, -2.0, 1e20, 4.0, 1.0], "{compression:?}");
    }
    let grey = stored(vec![AnyChannel::new("Y", half([0.5, 2.0]))], Compression::ZIP16);
    assert_eq!(read(&grey).unwrap().samples(), [0.5, 0.5, 0.5, 2.0, 2.0, 2.0]);
    let depth = stored(vec![AnyChannel::new("Z", half([0.5, 2.0]))], Compression::ZIP16);
    let message = read(&depth).unwrap_err().to_string();
    assert_eq!(
        message,
        "OpenEXR file cannot be read: its channels are Z, expected a flat layer with R, G, B or Y"
    );
}

//! Hand-made BMP files of every kind that is read, and broken ones.

#![allow(clippy::unwrap_used, clippy::indexing_slicing)]

use dotray_image::Channels;
use dotray_image::EncodeOptions;
use dotray_image::Format;
use dotray_image::Image;
use dotray_image::ImageError;
use dotray_image::Limits;

/// What a hand-made file says about itself.
#[derive(Clone)]
struct Kind {
    header: usize,
    width: i32,
    height: i32,
    bits: u16,
    compression: u32,
    used: u32,
    /// Masks in or behind the header.
    masks: Vec<u32>,
    /// Blue, green, red of each entry.
    palette: Vec<[u8; 3]>,
    pixels: Vec<u8>,
}

const RED: [u8; 3] = [0, 0, 255];
const GREEN: [u8; 3] = [0, 255, 0];
const BLUE: [u8; 3] = [255, 0, 0];
const WHITE: [u8; 3] = [255, 255, 255];

fn kind(width: i32, height: i32, bits: u16, pixels: &[u8]) -> Kind {
    let palette = if bits <= 8 { vec![RED, GREEN, BLUE, WHITE] } else { vec![] };
    let used = palette.len() as u32;
    Kind {
        header: 40,
        width,
        height,
        bits,
        compression: 0,
        used,
        masks: vec![],
        palette,
        pixels: pixels.to_vec(),
    }
}

impl Kind {
    fn bytes(&self) -> Vec<u8> {
        let mut info = Vec::new();
        if self.header == 12 {
            [12, 0, self.width as u16, self.height as u16, 1, self.bits]
                .iter()
                .for_each(|field| info.extend(field.to_le_bytes()));
        } else {
            [self.header as i32, self.width, self.height]
                .iter()
                .for_each(|field| info.extend(field.to_le_bytes()));
            [1, self.bits].iter().for_each(|field| info.extend(field.to_le_bytes()));
            [self.compression, 0, 0, 0, self.used, 0]
                .iter()
                .for_each(|field| info.extend(field.to_le_bytes()));
            self.masks.iter().for_each(|mask| info.extend(mask.to_le_bytes()));
            let masks = if self.header > 40 { 0 } else { 4 * self.masks.len() };
            info.resize(self.header.max(16) + masks, 0);
            // A short header holds fewer fields.
            info.truncate(self.header + masks);
        }
        for &[blue, green, red] in &self.palette {
            info.extend([blue, green, red]);
            info.extend((self.header > 12).then_some(0));
        }
        let offset = 14 + info.len() as u32;
        let mut file = b"BM".to_vec();
        [offset + self.pixels.len() as u32, 0, offset]
            .iter()
            .for_each(|field| file.extend(field.to_le_bytes()));
        file.extend(info);
        file.extend(&self.pixels);
        file
    }

    fn read(&self) -> Result<Image, ImageError> {
        decode(&self.bytes())
    }

    /// The picture as letters, row by row from above.
    fn letters(&self) -> String {
        letters(&self.read().unwrap())
    }
}

fn decode(bytes: &[u8]) -> Result<Image, ImageError> {
    dotray_image::decode(bytes, None, &Limits::default())
}

fn letters(image: &Image) -> String {
    let letter = |pixel: &[f32]| match pixel {
        [1.0, 0.0, 0.0] => 'R',
        [0.0, 1.0, 0.0] => 'G',
        [0.0, 0.0, 1.0] => 'B',
        [1.0, 1.0, 1.0] => 'W',
        _ => '?',
    };
    let row = |row: &[f32]| row.chunks_exact(3).map(letter).collect::<String>();
    image.samples().chunks_exact(3 * image.width()).map(row).collect::<Vec<_>>().join("/")
}

#[test]
fn palettes_of_1_2_4_and_8_bits() {
    assert_eq!(kind(10, 2, 1, &[0xff, 0xc0, 0, 0, 0x80, 0x40, 0, 0]).letters(), "GRRRRRRRRG/GGGGGGGGGG");
    assert_eq!(kind(5, 1, 2, &[0b00_01_10_11, 0b01_00_00_00, 0, 0]).letters(), "RGBWG");
    assert_eq!(kind(3, 2, 4, &[0x01, 0x20, 0, 0, 0x32, 0x10, 0, 0]).letters(), "WBG/RGB");
    assert_eq!(kind(3, 2, 8, &[0, 1, 2, 99, 3, 2, 1, 99]).letters(), "WBG/RGB");
    // The padding of the last row may be missing.
    assert_eq!(kind(3, 2, 8, &[0, 1, 2, 99, 3, 2, 1]).letters(), "WBG/RGB");
}

#[test]
fn top_down_and_headers_of_all_lengths() {
    let top_down = Kind { height: -2, ..kind(3, 2, 8, &[0, 1, 2, 99, 3, 2, 1, 99]) };
    assert_eq!(top_down.letters(), "RGB/WBG");
    for header in [12, 16, 40, 52, 56, 64, 108, 124] {
        // The header of OS/2 1 has no number of palette entries: there are always 256, here cut short by the offset.
        let kind = Kind { header, ..kind(3, 2, 8, &[0, 1, 2, 99, 3, 2, 1, 99]) };
        assert_eq!(kind.letters(), "WBG/RGB", "{header}");
    }
}

#[test]
fn sixteen_bits() {
    let mut stored: Vec<u8> =
        [0x7c00_u16, 0x03e0, 0x001f, 0x7fff].iter().flat_map(|p| p.to_le_bytes()).collect();
    assert_eq!(kind(4, 1, 16, &stored).letters(), "RGBW");
    stored = [0xf800_u16, 0x07e0, 0x001f, 0xffff].iter().flat_map(|p| p.to_le_bytes()).collect();
    let masked = Kind { compression: 3, masks: vec![0xf800, 0x07e0, 0x001f], ..kind(4, 1, 16, &stored) };
    assert_eq!(masked.letters(), "RGBW");
    assert_eq!(Kind { header: 56, ..masked.clone() }.letters(), "RGBW");
    let middle = Kind { width: 1, pixels: vec![0x00, 0x84, 0, 0], ..masked };
    assert_eq!(middle.read().unwrap().samples(), [16.0 / 31.0, 32.0 / 63.0, 0.0]);
}

#[test]
fn twenty_four_and_thirty_two_bits() {
    let stored = [[0, 0, 255, 7], [0, 255, 0, 7], [255, 0, 0, 7], [255, 255, 255, 7]].concat();
    assert_eq!(kind(4, 1, 32, &stored).letters(), "RGBW");
    assert_eq!(Kind { header: 124, ..kind(4, 1, 32, &stored) }.letters(), "RGBW");
    let stored = [0, 0, 255, 0, 255, 0, 255, 0, 0, 9, 9, 9];
    assert_eq!(kind(3, 1, 24, &stored).letters(), "RGB");
    // Alpha counts where a mask names it.
    let masks = vec![0xff00_0000, 0x00ff_0000, 0x0000_ff00, 0x0000_00ff];
    let pixel = [51, 255, 0, 255];
    for (header, compression) in [(40, 6), (56, 3), (108, 3), (124, 3)] {
        let with_alpha = Kind { header, compression, masks: masks.clone(), ..kind(1, 1, 32, &pixel) };
        let image = with_alpha.read().unwrap();
        assert_eq!((image.channels(), image.samples()), (Channels::Rgba, &[1.0, 0.0, 1.0, 0.2][..]));
    }
    let without = Kind { header: 52, compression: 3, masks: masks[..3].to_vec(), ..kind(1, 1, 32, &pixel) };
    assert_eq!(without.read().unwrap().samples(), [1.0, 0.0, 1.0]);
    let ten_bits = vec![0x3ff0_0000, 0x000f_fc00, 0x0000_03ff];
    let deep =
        Kind { compression: 3, masks: ten_bits, ..kind(1, 1, 32, &(1023_u32 << 20 | 341).to_le_bytes()) };
    assert_eq!(deep.read().unwrap().samples(), [1.0, 0.0, 1.0 / 3.0]);
}

#[test]
fn run_lengths_of_8_bits() {
    // A run, an absolute run with a fill byte, the end of the line, a jump, a run, the end.
    let code = [3, 1, 0, 3, 0, 2, 3, 99, 0, 0, 0, 2, 2, 1, 4, 2, 0, 1];
    let rle = Kind { compression: 1, ..kind(6, 3, 8, &code) };
    assert_eq!(rle.letters(), "RRBBBB/RRRRRR/GGGRBW");
    // The end mark may be missing when all pixels are there.
    let complete = Kind { compression: 1, ..kind(3, 2, 8, &[3, 1, 0, 0, 3, 2]) };
    assert_eq!(complete.letters(), "BBB/GGG");
    let top_down = Kind { compression: 1, ..kind(3, -2, 8, &[3, 1, 0, 0, 3, 2]) };
    assert_eq!(top_down.letters(), "GGG/BBB");
}

#[test]
fn run_lengths_of_4_bits() {
    // Two entries take turns in a run; five absolute entries take three bytes and a fill byte.
    let code = [5, 0x12, 0, 0, 0, 5, 0x01, 0x23, 0x30, 99, 0, 1];
    let rle = Kind { compression: 2, ..kind(5, 2, 4, &code) };
    assert_eq!(rle.letters(), "RGBWW/GBGBG");
}

#[test]
fn wrong_offsets_of_the_pixels() {
    let good = kind(3, 2, 8, &[0, 1, 2, 99, 3, 2, 1, 99]);
    for wrong in [0_u32, 1, 53, 54, 60, 9999, u32::MAX] {
        let mut bytes = good.bytes();
        bytes[10..14].copy_from_slice(&wrong.to_le_bytes());
        // 60 cuts the palette after its first entry, and what lies behind the end of the file has been cut off.
        let expected = if matches!(wrong, 60 | 9999 | u32::MAX) { None } else { Some("WBG/RGB".to_string()) };
        assert_eq!(decode(&bytes).ok().map(|image| letters(&image)), expected, "{wrong}");
    }
    // A declared palette that reaches into the pixels is cut where they begin.
    assert_eq!(Kind { used: 0, ..good.clone() }.letters(), "WBG/RGB");
    assert_eq!(Kind { used: 7777, ..good }.letters(), "WBG/RGB");
}

#[test]
fn faults_are_named_with_place_and_value() {
    let message = |kind: Kind| kind.read().unwrap_err().to_string();
    let rle8 = |code: &[u8]| Kind { compression: 1, ..kind(3, 2, 8, code) };
    assert_eq!(
        message(kind(3, 2, 8, &[0, 1, 2, 99, 3, 5, 1, 99])),
        "BMP file, byte 75: a pixel's palette entry is 5, expected less than 4, the length of the palette"
    );
    assert_eq!(
        message(kind(3, 2, 8, &[0, 1])),
        "BMP file ends at byte 72, too early for the pixels: 7 bytes from byte 70 on"
    );
    assert_eq!(
        message(rle8(&[4, 1, 0, 1])),
        "BMP file, byte 70: a place for pixels is column 3, row 0, expected one inside the 3 x 2 picture"
    );
    assert!(message(rle8(&[0, 2, 1, 9, 0, 1])).contains("column 1, row 9"));
    assert!(message(rle8(&[0, 0, 0, 0, 1, 1])).contains("column 0, row 2"));
    assert!(message(rle8(&[3, 1, 0, 0])).contains("a run of pixels: 1 bytes from byte 74 on"));
    assert!(message(rle8(&[0, 3, 1])).contains("an absolute run of pixels: 3 bytes from byte 72 on"));
    assert!(message(rle8(&[3, 9, 0, 1])).contains("palette entry is 9"));
    assert!(message(kind(3, 2, 7, &[])).contains("byte 28: the number of bits per pixel is 7"));
    assert!(
        message(Kind { compression: 5, ..kind(3, 2, 24, &[]) }).contains("the compression is 5 with 24 bits")
    );
    assert!(
        message(Kind { header: 200, ..kind(3, 2, 24, &[]) }).contains("header is 200, expected 12 (OS/2)")
    );
    assert!(message(kind(-3, 2, 24, &[])).contains("byte 18: the width is -3"));
    assert!(message(kind(0, 2, 24, &[])).contains("picture size 0 x 2 refused"));
    assert!(message(kind(i32::MAX, i32::MIN, 24, &[])).contains("2147483647 x 2147483648 refused"));
    let torn = Kind { compression: 3, masks: vec![0xf0f0, 0, 0], ..kind(1, 1, 16, &[0; 4]) };
    assert!(message(torn).contains("byte 54: the red mask is 0x0000f0f0, expected neighbouring bits"));
    let no_palette = Kind { palette: vec![], used: 0, ..kind(1, 1, 8, &[]) };
    assert!(message(no_palette).contains("the palette: 1024 bytes from byte 54 on"));
}

#[test]
fn written_as_the_course_does() {
    let samples = vec![1.0, 0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 1.0, 1.0, 1.0, 1.0];
    let image = Image::from_samples(2, 2, Channels::Rgb, samples).unwrap();
    let bytes = dotray_image::encode(&image, Format::Bmp, &EncodeOptions::default()).unwrap();
    let header = [
        &b"BM"[..],
        &[70, 0, 0, 0, 0, 0, 0, 0, 54, 0, 0, 0],
        &[40, 0, 0, 0, 2, 0, 0, 0, 2, 0, 0, 0, 1, 0, 24, 0, 0, 0, 0, 0, 16, 0, 0, 0],
        &[18, 11, 0, 0, 18, 11, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0],
    ];
    assert_eq!(bytes[..54], header.concat());
    assert_eq!(bytes[54..], [255, 0, 0, 255, 255, 255, 0, 0, 0, 0, 255, 0, 255, 0, 0, 0]);
}

#[test]
fn files_cut_anywhere_are_refused() {
    let kinds = [
        kind(3, 2, 8, &[0, 1, 2, 99, 3, 2, 1]),
        kind(10, 2, 1, &[0xff, 0xc0, 0, 0, 0x80, 0x40]),
        kind(3, 1, 24, &[0, 0, 255, 0, 255, 0, 255, 0, 0]),
        Kind { compression: 1, ..kind(3, 2, 8, &[3, 1, 0, 0, 1, 2, 0, 1]) },
        Kind { compression: 2, ..kind(5, 2, 4, &[5, 0x12, 0, 0, 0, 5, 0x01, 0x23, 0x30, 99, 0, 0, 0, 1]) },
        Kind { compression: 3, masks: vec![0xf800, 0x07e0, 0x001f], ..kind(1, 1, 16, &[1, 2]) },
        Kind { header: 124, ..kind(1, 1, 32, &[1, 2, 3, 4]) },
    ];
    for (number, kind) in kinds.iter().enumerate() {
        let bytes = kind.bytes();
        assert!(decode(&bytes).is_ok(), "{number}");
        for length in 0..bytes.len() {
            let result = decode(&bytes[..length]);
            // The two run-length files are complete without the marks at their end.
            let complete = matches!(number, 3 | 4) && length + 5 >= bytes.len() && result.is_ok();
            assert!(complete || result.is_err(), "kind {number} cut to {length} of {} bytes", bytes.len());
        }
    }
}

//! The headers of a BMP file, its palette and its bit masks, down to where the pixels begin.

use crate::bytes::Bytes;
use crate::error::ImageError;

const FILE_HEADER_BYTES: usize = 14;

/// What the headers say, checked as far as it can be without looking at the pixels.
#[derive(Debug)]
pub(crate) struct Header {
    pub(crate) width: u32,
    pub(crate) height: u32,
    /// True if the upper row is stored first.
    pub(crate) top_down: bool,
    pub(crate) pixels: Pixels,
    /// Red, green, blue; empty where pixels hold colours.
    pub(crate) palette: Vec<[f32; 3]>,
    /// Where the pixels begin in the file.
    pub(crate) data_offset: usize,
}

/// How pixels are stored.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum Pixels {
    /// Palette entries of 1, 2, 4 or 8 bits.
    Indexed { bits: u32 },
    /// Run-length coded palette entries of 8 bits.
    Rle8,
    /// Run-length coded palette entries of 4 bits.
    Rle4,
    /// A byte each of blue, green and red.
    Bgr,
    /// Whole numbers of 16 or 32 bits that hold the channels where the masks say.
    Masked { bits: u32, masks: Masks },
}

/// Where the channels lie inside a pixel; a mask of 0 is a channel that is not there.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) struct Masks {
    pub(crate) red: u32,
    pub(crate) green: u32,
    pub(crate) blue: u32,
    pub(crate) alpha: u32,
}

const MASKS_555: Masks = Masks { red: 0x7c00, green: 0x03e0, blue: 0x001f, alpha: 0 };
const MASKS_888: Masks = Masks { red: 0x00ff_0000, green: 0x0000_ff00, blue: 0x0000_00ff, alpha: 0 };

const BI_RGB: u32 = 0;
const BI_RLE8: u32 = 1;
const BI_RLE4: u32 = 2;
const BI_BITFIELDS: u32 = 3;
const BI_ALPHABITFIELDS: u32 = 6;

/// The numbers of the information header, whichever of its sizes it has.
struct Info {
    width: u32,
    height: u32,
    top_down: bool,
    bits: u32,
    compression: u32,
    palette_used: u32,
    /// Size of a palette entry in the file.
    entry_bytes: usize,
    /// Where the information header ends.
    end: usize,
}

/// Reads everything that stands before the pixels.
pub(crate) fn read(file: &[u8]) -> Result<Header, ImageError> {
    let mut bytes = Bytes::new(file, "BMP");
    let magic = bytes.take(2, "the signature `BM`")?;
    if magic != b"BM" {
        return Err(bytes.invalid(0, "the signature", crate::bytes::shown(magic), "`BM`"));
    }
    bytes.take(8, "the file header")?;
    let stated_offset = bytes.u32_le("the offset of the pixels")? as usize;
    let info = info(&mut bytes)?;
    let masks = masks(&mut bytes, &info)?;
    let pixels = pixels(&bytes, &info, masks)?;
    let palette_start = bytes.position();
    let palette = match pixels {
        Pixels::Indexed { .. } | Pixels::Rle8 | Pixels::Rle4 => {
            palette(&mut bytes.clone(), &info, stated_offset)?
        }
        Pixels::Bgr | Pixels::Masked { .. } => Vec::new(),
    };
    let palette_end = palette_start + palette.len() * info.entry_bytes;
    // An offset of zero, or one that points into the headers, cannot be meant: the pixels then follow the palette.
    let data_offset = stated_offset.max(palette_end);
    Ok(Header {
        width: info.width,
        height: info.height,
        top_down: info.top_down,
        pixels,
        palette,
        data_offset,
    })
}

fn info(bytes: &mut Bytes<'_>) -> Result<Info, ImageError> {
    let size_offset = bytes.position();
    let size = bytes.u32_le("the size of the information header")?;
    match size {
        12 => core_info(bytes),
        16..=124 => windows_info(bytes, size),
        _ => {
            let expected = "12 (OS/2), 40 (Windows), 52, 56, 108, 124 or 16 to 64 (OS/2 2)";
            Err(bytes.invalid(size_offset, "the size of the information header", size, expected))
        }
    }
}

/// The 12-byte header of OS/2 1.
fn core_info(bytes: &mut Bytes<'_>) -> Result<Info, ImageError> {
    let width = u32::from(bytes.u16_le("the width")?);
    let height = u32::from(bytes.u16_le("the height")?);
    bytes.u16_le("the number of planes")?;
    let bits = u32::from(bytes.u16_le("the bits per pixel")?);
    let end = bytes.position();
    Ok(Info {
        width,
        height,
        top_down: false,
        bits,
        compression: BI_RGB,
        palette_used: 0,
        entry_bytes: 3,
        end,
    })
}

/// The 40-byte header of Windows, its longer successors and its cut-off OS/2 cousins.
fn windows_info(bytes: &mut Bytes<'_>, size: u32) -> Result<Info, ImageError> {
    let end = FILE_HEADER_BYTES + size as usize;
    let width_offset = bytes.position();
    let width = bytes.i32_le("the width")?;
    let width = u32::try_from(width)
        .map_err(|_| bytes.invalid(width_offset, "the width", width, "a number above 0"))?;
    let height = bytes.i32_le("the height")?;
    bytes.u16_le("the number of planes")?;
    let bits = u32::from(bytes.u16_le("the bits per pixel")?);
    // Fields that a short header leaves out are zero.
    let field = |offset: usize, what: &'static str| {
        let mut field = bytes.at(FILE_HEADER_BYTES + offset);
        if offset + 4 <= size as usize { field.u32_le(what) } else { Ok(0) }
    };
    let compression = field(16, "the compression")?;
    let palette_used = field(32, "the number of palette entries")?;
    bytes.take(end - bytes.position(), "the information header")?;
    let top_down = height < 0;
    Ok(Info {
        width,
        height: height.unsigned_abs(),
        top_down,
        bits,
        compression,
        palette_used,
        entry_bytes: 4,
        end,
    })
}

/// The bit masks: in a long header, or behind a header of 40 bytes. None where the compression asks for none.
fn masks(bytes: &mut Bytes<'_>, info: &Info) -> Result<Option<Masks>, ImageError> {
    let in_header = info.end - FILE_HEADER_BYTES;
    let (behind, with_alpha) = match (info.compression, in_header) {
        (BI_BITFIELDS, 52..56) => (false, false),
        (BI_BITFIELDS | BI_ALPHABITFIELDS, 56..) => (false, true),
        (BI_BITFIELDS, _) => (true, false),
        (BI_ALPHABITFIELDS, _) => (true, true),
        (_, _) => return Ok(None),
    };
    let mut at_masks = bytes.at(FILE_HEADER_BYTES + 40);
    let source = if behind { bytes } else { &mut at_masks };
    Ok(Some(Masks {
        red: mask(source, "the red mask")?,
        green: mask(source, "the green mask")?,
        blue: mask(source, "the blue mask")?,
        alpha: if with_alpha { mask(source, "the alpha mask")? } else { 0 },
    }))
}

fn mask(bytes: &mut Bytes<'_>, what: &'static str) -> Result<u32, ImageError> {
    let offset = bytes.position();
    let mask = bytes.u32_le(what)?;
    let run = mask.checked_shr(mask.trailing_zeros()).unwrap_or(0);
    if run & run.wrapping_add(1) != 0 {
        return Err(bytes.invalid(offset, what, format!("{mask:#010x}"), "neighbouring bits"));
    }
    Ok(mask)
}

fn pixels(bytes: &Bytes<'_>, info: &Info, masks: Option<Masks>) -> Result<Pixels, ImageError> {
    match (info.bits, info.compression, masks) {
        (bits @ (1 | 2 | 4 | 8), BI_RGB, _) => Ok(Pixels::Indexed { bits }),
        (8, BI_RLE8, _) => Ok(Pixels::Rle8),
        (4, BI_RLE4, _) => Ok(Pixels::Rle4),
        (24, BI_RGB, _) => Ok(Pixels::Bgr),
        (16, BI_RGB, _) => Ok(Pixels::Masked { bits: 16, masks: MASKS_555 }),
        (32, BI_RGB, _) => Ok(Pixels::Masked { bits: 32, masks: MASKS_888 }),
        (bits @ (16 | 32), _, Some(masks)) => Ok(Pixels::Masked { bits, masks }),
        (bits @ (1 | 2 | 4 | 8 | 16 | 24 | 32), compression, _) => {
            let expected =
                "0 (none), 1 (RLE8 with 8 bits a pixel), 2 (RLE4 with 4), 3 or 6 (bit masks with 16 or 32)";
            let value = format!("{compression} with {bits} bits a pixel");
            Err(bytes.invalid(FILE_HEADER_BYTES + 16, "the compression", value, expected))
        }
        (bits, _, _) => {
            let offset = if info.entry_bytes == 3 { 10 } else { 14 };
            let expected = "1, 2, 4, 8, 16, 24 or 32";
            Err(bytes.invalid(FILE_HEADER_BYTES + offset, "the number of bits per pixel", bits, expected))
        }
    }
}

/// The palette as far as it is there: it may be declared longer than the room before the pixels.
fn palette(bytes: &mut Bytes<'_>, info: &Info, stated_offset: usize) -> Result<Vec<[f32; 3]>, ImageError> {
    let most = 1_usize << info.bits;
    let declared = match info.palette_used as usize {
        0 => most,
        used => used.min(most),
    };
    let start = bytes.position();
    // Only an offset behind at least one entry can tell that the palette is shorter than declared.
    let room = match stated_offset.checked_sub(start) {
        Some(room) if room >= info.entry_bytes && stated_offset <= bytes.length() => room,
        Some(_) | None => bytes.remaining(),
    };
    let entries = declared.min(room / info.entry_bytes);
    if entries == 0 {
        return Err(bytes.truncated("the palette", (declared * info.entry_bytes) as u64));
    }
    let stored = bytes.take(entries * info.entry_bytes, "the palette")?;
    let colour = |entry: &[u8]| match entry {
        &[blue, green, red, ..] => [red, green, blue].map(|value| f32::from(value) / 255.0),
        _ => [0.0; 3],
    };
    Ok(stored.chunks_exact(info.entry_bytes).map(colour).collect())
}

//! The picture formats: their names, their file name extensions and how their files begin.

use std::path::Path;

use crate::error::ImageError;

/// A picture file format.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
pub enum Format {
    /// Windows bitmap, written with 24 bits a pixel, uncompressed.
    Bmp,
    /// Portable Network Graphics, written with 8 bits a channel.
    Png,
    /// The same, written with 16 bits a channel; no file name tells it from [`Format::Png`].
    Png16,
    /// JPEG, with losses.
    Jpeg,
    /// Portable pixmap (`P6`); reading takes `P1` to `P6`.
    Ppm,
    /// The Quite OK Image format.
    Qoi,
    /// TIFF, written with 8 bits a channel.
    Tiff,
    /// OpenEXR, written with 32-bit floats.
    Exr,
    /// Radiance RGBE.
    Hdr,
    /// Portable float map.
    Pfm,
}

impl Format {
    /// Every format, in the order in which messages list them.
    pub const ALL: [Format; 10] = [
        Format::Bmp,
        Format::Png,
        Format::Png16,
        Format::Jpeg,
        Format::Ppm,
        Format::Qoi,
        Format::Tiff,
        Format::Exr,
        Format::Hdr,
        Format::Pfm,
    ];

    /// The name as it stands in messages.
    pub fn name(self) -> &'static str {
        match self {
            Format::Bmp => "BMP",
            Format::Png => "PNG",
            Format::Png16 => "PNG-16",
            Format::Jpeg => "JPEG",
            Format::Ppm => "PPM",
            Format::Qoi => "QOI",
            Format::Tiff => "TIFF",
            Format::Exr => "OpenEXR",
            Format::Hdr => "Radiance HDR",
            Format::Pfm => "PFM",
        }
    }

    /// The file name extensions that choose it, the usual one first; none for PNG-16.
    pub fn extensions(self) -> &'static [&'static str] {
        match self {
            Format::Bmp => &["bmp", "dib"],
            Format::Png => &["png"],
            Format::Png16 => &[],
            Format::Jpeg => &["jpg", "jpeg"],
            Format::Ppm => &["ppm", "pnm"],
            Format::Qoi => &["qoi"],
            Format::Tiff => &["tif", "tiff"],
            Format::Exr => &["exr"],
            Format::Hdr => &["hdr"],
            Format::Pfm => &["pfm"],
        }
    }

    /// True if it stores unclamped floats, which `--srgb` leaves as they are.
    pub fn is_float(self) -> bool {
        match self {
            Format::Exr | Format::Hdr | Format::Pfm => true,
            Format::Bmp
            | Format::Png
            | Format::Png16
            | Format::Jpeg
            | Format::Ppm
            | Format::Qoi
            | Format::Tiff => false,
        }
    }

    /// True if this build reads and writes it.
    pub fn is_built(self) -> bool {
        match self {
            Format::Bmp | Format::Ppm | Format::Hdr | Format::Pfm => true,
            Format::Png | Format::Png16 | Format::Jpeg | Format::Qoi | Format::Tiff | Format::Exr => {
                cfg!(feature = "formats")
            }
        }
    }

    /// The format that a file name's extension chooses, in upper or lower case.
    ///
    /// # Errors
    /// [`ImageError::NoExtension`] or [`ImageError::UnknownExtension`], which list the known extensions.
    pub fn from_path(path: &Path) -> Result<Format, ImageError> {
        let name = path.file_name().unwrap_or(path.as_os_str()).to_string_lossy().into_owned();
        let Some(extension) = path.extension() else {
            return Err(ImageError::NoExtension { name, known: known_extensions() });
        };
        let extension = extension.to_string_lossy().to_lowercase();
        let found = Format::ALL.into_iter().find(|format| format.extensions().contains(&extension.as_str()));
        found.ok_or_else(|| {
            let suggestion = nearest_extension(&extension);
            ImageError::UnknownExtension { name, extension, known: known_extensions(), suggestion }
        })
    }

    /// The format whose files begin as these bytes do.
    pub fn sniff(bytes: &[u8]) -> Option<Format> {
        let magics: [(&[u8], Format); 13] = [
            (b"BM", Format::Bmp),
            (b"\x89PNG\r\n\x1a\n", Format::Png),
            (b"\xff\xd8\xff", Format::Jpeg),
            (b"qoif", Format::Qoi),
            (b"II*\0", Format::Tiff),
            (b"MM\0*", Format::Tiff),
            (b"II+\0", Format::Tiff),
            (b"MM\0+", Format::Tiff),
            (b"\x76\x2f\x31\x01", Format::Exr),
            (b"#?RADIANCE", Format::Hdr),
            (b"#?RGBE", Format::Hdr),
            (b"PF", Format::Pfm),
            (b"Pf", Format::Pfm),
        ];
        let begins = magics.into_iter().find(|(magic, _)| bytes.starts_with(magic)).map(|(_, format)| format);
        match (begins, bytes) {
            (None, [b'P', b'1'..=b'6', next, ..]) if next.is_ascii_whitespace() || *next == b'#' => {
                Some(Format::Ppm)
            }
            (begins, _) => begins,
        }
    }
}

fn extensions() -> impl Iterator<Item = &'static str> {
    Format::ALL.into_iter().flat_map(|format| format.extensions()).copied()
}

fn known_extensions() -> String {
    extensions().map(|extension| format!(".{extension}")).collect::<Vec<_>>().join(" ")
}

/// The known extension that differs by the fewest letters, if it shares at least one with what was typed.
fn nearest_extension(typed: &str) -> Option<&'static str> {
    // A long word is no slip of the finger, and its distance would cost time.
    if typed.len() > 16 {
        return None;
    }
    let near = extensions().map(|known| (edit_distance(typed, known), known));
    let allowed = if typed.chars().count() < 3 { 1 } else { 2 };
    near.min_by_key(|(distance, _)| *distance)
        .filter(|(distance, _)| *distance <= allowed)
        .map(|(_, known)| known)
}

/// Levenshtein's distance, row by row.
fn edit_distance(a: &str, b: &str) -> usize {
    let mut row: Vec<usize> = (0..=b.chars().count()).collect();
    for (i, letter_a) in a.chars().enumerate() {
        let mut diagonal = i;
        let mut left = i + 1;
        let mut next = vec![left];
        for (letter_b, &above) in b.chars().zip(row.iter().skip(1)) {
            let substituted = diagonal + usize::from(letter_a != letter_b);
            left = substituted.min(above + 1).min(left + 1);
            diagonal = above;
            next.push(left);
        }
        row = next;
    }
    row.last().copied().unwrap_or(0)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn extensions_choose_formats() {
        for format in Format::ALL {
            for extension in format.extensions() {
                let name = format!("some.dir/a.b.{}", extension.to_uppercase());
                assert_eq!(Format::from_path(Path::new(&name)), Ok(format));
            }
        }
    }

    #[test]
    fn unknown_extensions_are_explained() {
        let message = |name: &str| Format::from_path(Path::new(name)).unwrap_err().to_string();
        assert_eq!(
            message("out/a.pgn"),
            "unknown picture format `.pgn` of `a.pgn`: did you mean `.png`? Or use one of \
             .bmp .dib .png .jpg .jpeg .ppm .pnm .qoi .tif .tiff .exr .hdr .pfm"
        );
        assert!(message("a.jepg").contains("did you mean `.jpg`"), "{}", message("a.jepg"));
        assert!(message("a.webp").starts_with("unknown picture format `.webp` of `a.webp`: "));
        assert!(!message("a.something").contains("did you mean"));
        assert!(message("dir.png/picture").starts_with("file name `picture` has no extension"));
        assert!(message("").contains("no extension"));
    }

    #[test]
    fn distances() {
        assert_eq!(edit_distance("", "png"), 3);
        assert_eq!(edit_distance("pgn", "png"), 2);
        assert_eq!(edit_distance("jpg", "jpeg"), 1);
        assert_eq!(edit_distance("kitten", "sitting"), 3);
    }

    #[test]
    fn contents_are_told_apart() {
        assert_eq!(Format::sniff(b"P6\n1 1"), Some(Format::Ppm));
        assert_eq!(Format::sniff(b"P7\n1 1"), None);
        assert_eq!(Format::sniff(b"PF\n1 1"), Some(Format::Pfm));
        assert_eq!(Format::sniff(b"P6"), None);
        assert_eq!(Format::sniff(b""), None);
    }
}

//! Run-length coded BMP pixels: 8 and 4 bits, runs, absolute runs, deltas, ends of lines.

use crate::bytes::Bytes;
use crate::error::ImageError;

/// Bits of a palette entry in the code.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum Depth {
    Four,
    Eight,
}

/// The palette entries being filled, in the order of the file's rows, and the place of the next pixel.
struct Canvas {
    entries: Vec<u8>,
    width: usize,
    height: usize,
    x: usize,
    y: usize,
}

/// Decodes to one palette entry a pixel, in the order of the file's rows; pixels that the code skips are entry 0.
pub(crate) fn decode(
    bytes: &mut Bytes<'_>,
    depth: Depth,
    width: usize,
    height: usize,
) -> Result<Vec<u8>, ImageError> {
    let mut canvas = Canvas { entries: vec![0; width * height], width, height, x: 0, y: 0 };
    loop {
        // A file that stops behind its last pixel lacks only the end mark.
        let complete = canvas.y >= height || (canvas.y + 1 == height && canvas.x == width);
        if complete && bytes.remaining() == 0 {
            return Ok(canvas.entries);
        }
        let offset = bytes.position();
        let count = bytes.u8("a run of pixels")?;
        let second = bytes.u8("a run of pixels")?;
        match (count, second) {
            (0, 0) => (canvas.x, canvas.y) = (0, canvas.y + 1),
            (0, 1) => return Ok(canvas.entries),
            (0, 2) => {
                let right = bytes.u8("a jump to the right")?;
                let down = bytes.u8("a jump to another row")?;
                canvas.jump(right, down).map_err(|value| outside(bytes, offset, &canvas, value))?;
            }
            (0, length) => absolute(bytes, depth, length, &mut canvas)?,
            (length, value) => {
                let entries = repeated(depth, value, length);
                canvas.put(entries).map_err(|value| outside(bytes, offset, &canvas, value))?;
            }
        }
    }
}

/// An absolute run: `length` entries as they are, filled up to a whole number of 16-bit words.
fn absolute(bytes: &mut Bytes<'_>, depth: Depth, length: u8, canvas: &mut Canvas) -> Result<(), ImageError> {
    let offset = bytes.position();
    let length = usize::from(length);
    let stored_bytes = match depth {
        Depth::Eight => length,
        Depth::Four => length.div_ceil(2),
    };
    let stored = bytes.take(stored_bytes, "an absolute run of pixels")?;
    let result = match depth {
        Depth::Eight => canvas.put(stored.iter().copied()),
        Depth::Four => canvas.put(stored.iter().flat_map(|&byte| [byte >> 4, byte & 15]).take(length)),
    };
    result.map_err(|value| outside(bytes, offset, canvas, value))?;
    if stored_bytes % 2 == 1 && bytes.remaining() > 0 {
        bytes.take(1, "a fill byte")?;
    }
    Ok(())
}

/// The entries of an encoded run: one value over and over, or with 4 bits two that take turns.
fn repeated(depth: Depth, value: u8, length: u8) -> impl Iterator<Item = u8> {
    let pair = match depth {
        Depth::Eight => [value, value],
        Depth::Four => [value >> 4, value & 15],
    };
    pair.into_iter().cycle().take(usize::from(length))
}

fn outside(bytes: &Bytes<'_>, offset: usize, canvas: &Canvas, value: String) -> ImageError {
    let expected = format!("one inside the {} x {} picture", canvas.width, canvas.height);
    bytes.invalid(offset, "a place for pixels", value, expected)
}

impl Canvas {
    /// Writes entries from the present place to the right; tells the place that lies outside.
    fn put(&mut self, entries: impl Iterator<Item = u8>) -> Result<(), String> {
        for entry in entries {
            let inside = self.x < self.width && self.y < self.height;
            let slot = if inside { self.entries.get_mut(self.y * self.width + self.x) } else { None };
            match slot {
                Some(slot) => *slot = entry,
                None => return Err(format!("column {}, row {}", self.x, self.y)),
            }
            self.x += 1;
        }
        Ok(())
    }

    fn jump(&mut self, right: u8, down: u8) -> Result<(), String> {
        self.x += usize::from(right);
        self.y += usize::from(down);
        if self.x > self.width || self.y > self.height {
            return Err(format!("column {}, row {}", self.x, self.y));
        }
        Ok(())
    }
}

//! Lines and columns as editors count them: from 0, columns in units of UTF-16.

use lsp_types::Position;
use lsp_types::Range;
use std::cell::Cell;

/// A text with the places of its lines.
#[derive(Clone, Debug)]
pub struct Text<'a> {
    bytes: &'a [u8],
    /// The first byte of each line; there is always one.
    starts: Vec<usize>,
    /// The last place asked for: places are mostly asked for in order, and lines may be long.
    last: Cell<(usize, usize, u32)>,
}

impl<'a> Text<'a> {
    /// Looks for the lines. A line ends with `\n`, `\r\n` or `\r`.
    pub fn new(bytes: &'a [u8]) -> Self {
        let mut starts = vec![0];
        let mut rest = bytes.iter().enumerate().peekable();
        while let Some((at, &byte)) = rest.next() {
            let ends =
                byte == b'\n' || (byte == b'\r' && rest.peek().is_none_or(|(_, next)| **next != b'\n'));
            if ends {
                starts.push(at + 1);
            }
        }
        Self { bytes, starts, last: Cell::new((0, 0, 0)) }
    }

    /// The text itself.
    pub fn bytes(&self) -> &'a [u8] {
        self.bytes
    }

    /// The place of byte `at`; that of the end where there is no such byte.
    pub fn position(&self, at: usize) -> Position {
        let at = at.min(self.bytes.len());
        let line = self.starts.partition_point(|&start| start <= at).saturating_sub(1);
        let start = self.starts.get(line).copied().unwrap_or(0);
        let (last_line, last_at, last_units) = self.last.get();
        let (from, before) = if last_line == line && (start..=at).contains(&last_at) {
            (last_at, last_units)
        } else {
            (start, 0)
        };
        let units: usize = self.bytes.get(from..at).unwrap_or_default().iter().map(|&byte| units(byte)).sum();
        let character = before.saturating_add(u32::try_from(units).unwrap_or(u32::MAX));
        self.last.set((line, at, character));
        Position::new(u32::try_from(line).unwrap_or(u32::MAX), character)
    }

    /// The places of bytes `start .. end`.
    pub fn range(&self, start: usize, end: usize) -> Range {
        Range::new(self.position(start), self.position(end.max(start)))
    }

    /// The byte at a place. What lies behind the end of its line is the line's end, behind the last line the text's; a
    /// place inside a character is its beginning.
    pub fn offset(&self, position: Position) -> usize {
        let line = usize::try_from(position.line).unwrap_or(usize::MAX);
        let Some(&start) = self.starts.get(line) else { return self.bytes.len() };
        let end = self.line_end(line);
        let wanted = usize::try_from(position.character).unwrap_or(usize::MAX);
        let (mut at, mut before) = (start, 0);
        while let Some(&byte) = self.bytes.get(at).filter(|_| at < end) {
            let width = units(byte);
            if before == wanted || before + width > wanted {
                break;
            }
            before += width;
            at += 1;
            // The bytes that continue a character belong to it.
            while at < end && self.bytes.get(at).is_some_and(|&next| units(next) == 0) {
                at += 1;
            }
        }
        at
    }

    /// The bytes of line `line` without its end.
    pub fn line(&self, line: usize) -> &'a [u8] {
        let start = self.starts.get(line).copied().unwrap_or(self.bytes.len());
        self.bytes.get(start..self.line_end(line)).unwrap_or_default()
    }

    /// The place behind the last character.
    pub fn end(&self) -> Position {
        self.position(self.bytes.len())
    }

    fn line_end(&self, line: usize) -> usize {
        let Some(&next) = self.starts.get(line + 1) else { return self.bytes.len() };
        let sign = |back: usize| self.bytes.get(next.saturating_sub(back)).copied();
        match (sign(2), sign(1)) {
            (Some(b'\r'), Some(b'\n')) => next.saturating_sub(2),
            _ => next.saturating_sub(1),
        }
    }
}

/// How many units of UTF-16 a character has whose UTF-8 begins with this byte; 0 for bytes that continue one.
fn units(byte: u8) -> usize {
    usize::from(byte & 0xC0 != 0x80) + usize::from(byte >= 0xF0)
}

/// Puts `new` in the place of a range.
pub fn replace(bytes: &mut Vec<u8>, range: Range, new: &str) {
    let text = Text::new(bytes);
    let (start, end) = (text.offset(range.start), text.offset(range.end));
    bytes.splice(start.min(end)..end.max(start), new.bytes());
}

#[cfg(test)]
#[allow(clippy::unwrap_used, clippy::indexing_slicing)]
mod tests {
    use super::*;

    #[test]
    fn columns_count_units_of_utf_16() {
        let source = "a\u{e4}\u{20ac}\u{1d11e}z\r\n#b\rc\n";
        let text = Text::new(source.as_bytes());
        let cases = [("a", 0, 0), ("\u{e4}", 0, 1), ("\u{20ac}", 0, 2), ("\u{1d11e}", 0, 3), ("z", 0, 5)];
        for (sign, line, character) in cases.into_iter().chain([("#", 1, 0), ("c", 2, 0)]) {
            let at = source.find(sign).unwrap();
            assert_eq!(text.position(at), Position::new(line, character), "{sign}");
            assert_eq!(text.offset(Position::new(line, character)), at, "{sign}");
        }
        assert_eq!(text.end(), Position::new(3, 0));
        // Inside the pair of units, behind the line, behind the text.
        assert_eq!(text.offset(Position::new(0, 4)), source.find('\u{1d11e}').unwrap());
        assert_eq!(text.offset(Position::new(0, 99)), source.find('\r').unwrap());
        assert_eq!(text.offset(Position::new(9, 0)), source.len());
        assert_eq!(text.line(1), b"#b");
    }

    #[test]
    fn places_asked_for_in_any_order_are_the_same() {
        let source = "\u{1d11e}\u{e4} 1 2 3\n4 \u{20ac} 5".as_bytes();
        let text = Text::new(source);
        let alone = |at| Text::new(source).position(at);
        for at in (0..=source.len()).chain((0..=source.len()).rev()).chain([5, 2, 9, 9, 1]) {
            assert_eq!(text.position(at), alone(at), "{at}");
        }
    }

    #[test]
    fn any_bytes_have_places() {
        let bytes: Vec<u8> = (0..=255).chain(0..=255).rev().collect();
        let text = Text::new(&bytes);
        for at in 0..bytes.len() {
            // A place inside a character is the character's end.
            let next = (at..bytes.len()).find(|&next| units(bytes[next]) > 0).unwrap_or(bytes.len());
            assert!(text.offset(text.position(at)) <= next, "{at}");
        }
        assert_eq!(Text::new(b"").position(7), Position::new(0, 0));
    }

    #[test]
    fn changes_are_put_in_place() {
        let mut bytes = "\u{1d11e} one\ntwo".as_bytes().to_vec();
        replace(&mut bytes, Range::new(Position::new(0, 3), Position::new(1, 1)), "X");
        assert_eq!(bytes, "\u{1d11e} Xwo".as_bytes());
        replace(&mut bytes, Range::new(Position::new(5, 0), Position::new(0, 0)), "");
        assert_eq!(bytes, b"");
    }
}

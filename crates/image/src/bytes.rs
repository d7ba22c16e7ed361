//! A place in the bytes of a file: reads numbers and words and says where the file is wrong.

use crate::error::ImageError;

/// A reading position in the bytes of one file.
#[derive(Debug, Clone)]
pub(crate) struct Bytes<'a> {
    data: &'a [u8],
    position: usize,
    format: &'static str,
}

impl<'a> Bytes<'a> {
    /// Starts at the first byte; `format` stands in the messages.
    pub(crate) fn new(data: &'a [u8], format: &'static str) -> Self {
        Bytes { data, position: 0, format }
    }

    pub(crate) fn position(&self) -> usize {
        self.position
    }

    pub(crate) fn length(&self) -> usize {
        self.data.len()
    }

    /// Bytes from the position to the end of the file.
    pub(crate) fn remaining(&self) -> usize {
        self.data.len().saturating_sub(self.position)
    }

    /// The same file at another position, which may lie past the end: the next read then fails.
    pub(crate) fn at(&self, position: usize) -> Self {
        Bytes { data: self.data, position, format: self.format }
    }

    /// The error for `needed` bytes of `what` that are not there.
    pub(crate) fn truncated(&self, what: &'static str, needed: u64) -> ImageError {
        ImageError::Truncated {
            format: self.format,
            what,
            offset: self.position as u64,
            needed,
            length: self.data.len() as u64,
        }
    }

    /// The error for a wrong value that stands at `offset`.
    pub(crate) fn invalid(
        &self,
        offset: usize,
        what: &'static str,
        value: impl ToString,
        expected: impl ToString,
    ) -> ImageError {
        ImageError::Invalid {
            format: self.format,
            offset: offset as u64,
            what,
            value: value.to_string(),
            expected: expected.to_string(),
        }
    }

    /// The next `count` bytes.
    pub(crate) fn take(&mut self, count: usize, what: &'static str) -> Result<&'a [u8], ImageError> {
        let end = self.position.checked_add(count);
        match end.and_then(|end| Some((end, self.data.get(self.position..end)?))) {
            Some((end, taken)) => {
                self.position = end;
                Ok(taken)
            }
            None => Err(self.truncated(what, count as u64)),
        }
    }

    fn array<const N: usize>(&mut self, what: &'static str) -> Result<[u8; N], ImageError> {
        let mut array = [0; N];
        array.copy_from_slice(self.take(N, what)?);
        Ok(array)
    }

    pub(crate) fn u8(&mut self, what: &'static str) -> Result<u8, ImageError> {
        self.array::<1>(what).map(|[byte]| byte)
    }

    pub(crate) fn u16_le(&mut self, what: &'static str) -> Result<u16, ImageError> {
        self.array(what).map(u16::from_le_bytes)
    }

    pub(crate) fn u32_le(&mut self, what: &'static str) -> Result<u32, ImageError> {
        self.array(what).map(u32::from_le_bytes)
    }

    pub(crate) fn i32_le(&mut self, what: &'static str) -> Result<i32, ImageError> {
        self.array(what).map(i32::from_le_bytes)
    }

    pub(crate) fn rgbe(&mut self, what: &'static str) -> Result<[u8; 4], ImageError> {
        self.array(what)
    }

    /// The next byte without taking it.
    pub(crate) fn peek(&self) -> Option<u8> {
        self.data.get(self.position).copied()
    }

    /// The bytes up to the next line feed, which is taken too.
    pub(crate) fn line(&mut self, what: &'static str) -> Result<&'a [u8], ImageError> {
        let rest = self.data.get(self.position..).unwrap_or_default();
        let end = rest.iter().position(|&byte| byte == b'\n');
        match end {
            Some(end) => {
                let line = self.take(end, what)?;
                self.position += 1;
                Ok(line)
            }
            None => Err(self.truncated(what, rest.len() as u64 + 1)),
        }
    }

    /// Skips white space and `#` comments, then takes the bytes up to the next white space or comment.
    pub(crate) fn word(&mut self, what: &'static str) -> Result<&'a [u8], ImageError> {
        let mut in_comment = false;
        while let Some(byte) = self.peek() {
            match byte {
                b'\n' | b'\r' => in_comment = false,
                b'#' => in_comment = true,
                byte if in_comment || byte.is_ascii_whitespace() => {}
                _ => break,
            }
            self.position += 1;
        }
        let rest = self.data.get(self.position..).unwrap_or_default();
        let length =
            rest.iter().position(|byte| byte.is_ascii_whitespace() || *byte == b'#').unwrap_or(rest.len());
        if length == 0 {
            return Err(self.truncated(what, 1));
        }
        self.take(length, what)
    }

    /// A whole number written in decimal digits, from 1 to `max`.
    pub(crate) fn decimal(&mut self, what: &'static str, max: u32) -> Result<u32, ImageError> {
        let word = self.word(what)?;
        let number = std::str::from_utf8(word).ok().and_then(|text| text.parse::<u32>().ok());
        match number {
            Some(number) if (1..=max).contains(&number) => Ok(number),
            Some(_) | None => {
                let offset = self.position - word.len();
                Err(self.invalid(offset, what, shown(word), format!("a whole number from 1 to {max}")))
            }
        }
    }
}

/// A word of a file as it may stand in a message: in backquotes, printable, and not too long.
pub(crate) fn shown(word: &[u8]) -> String {
    let start: String =
        word.iter().take(32).map(|&byte| std::ascii::escape_default(byte).to_string()).collect();
    let more = if word.len() > 32 { "…" } else { "" };
    format!("`{start}{more}`")
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn words_skip_comments() {
        let mut bytes = Bytes::new(b"# a comment\n 12 # b\r\n34#c", "PPM");
        assert_eq!(bytes.decimal("width", 99), Ok(12));
        assert_eq!(bytes.decimal("height", 99), Ok(34));
        assert!(matches!(bytes.decimal("maxval", 99), Err(ImageError::Truncated { .. })));
    }

    #[test]
    fn wrong_numbers_are_named_with_place() {
        let mut bytes = Bytes::new(b" 70000", "PPM");
        let message = bytes.decimal("maxval", 65535).unwrap_err().to_string();
        assert_eq!(message, "PPM file, byte 1: maxval is `70000`, expected a whole number from 1 to 65535");
    }
}

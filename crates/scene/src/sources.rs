//! The text of the files that were read, and the lines and columns of places in it.

use crate::span::FileId;
use crate::span::Span;
use std::path::Path;
use std::path::PathBuf;
use std::sync::OnceLock;

/// A place as people count: both from 1, columns in characters.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub struct Position {
    /// The line.
    pub line: usize,
    /// The character in the line.
    pub column: usize,
}

/// The files that were read; their numbers are those of the scene.
#[derive(Debug, Default)]
pub struct Sources {
    files: Vec<Source>,
}

#[derive(Debug)]
struct Source {
    path: PathBuf,
    bytes: Vec<u8>,
    /// The number of line ends before each chunk of the file: made when the first line number is asked for.
    lines_before_chunk: OnceLock<Vec<usize>>,
}

const CHUNK: usize = 1 << 16;
const BYTE_ORDER_MARK: &[u8] = b"\xef\xbb\xbf";

impl Sources {
    /// Takes a file and gives its number.
    pub fn add(&mut self, path: PathBuf, bytes: Vec<u8>) -> FileId {
        let number = u32::try_from(self.files.len()).unwrap_or(u32::MAX);
        self.files.push(Source { path, bytes, lines_before_chunk: OnceLock::new() });
        FileId(number)
    }

    /// Takes away the content of a file, of which nothing more is to be said.
    pub fn take_bytes(&mut self, file: FileId) -> Vec<u8> {
        self.files
            .get_mut(file.0 as usize)
            .map(|source| std::mem::take(&mut source.bytes))
            .unwrap_or_default()
    }

    /// How many files there are.
    pub fn len(&self) -> usize {
        self.files.len()
    }

    /// Whether there is none.
    pub fn is_empty(&self) -> bool {
        self.files.is_empty()
    }

    /// The path of a file; empty where there is no such file.
    pub fn path(&self, file: FileId) -> &Path {
        self.source(file).map_or(Path::new(""), |source| &source.path)
    }

    /// The content of a file; empty where there is no such file.
    pub fn bytes(&self, file: FileId) -> &[u8] {
        self.source(file).map_or(&[], |source| &source.bytes)
    }

    /// The line and column where a span starts.
    pub fn position(&self, span: Span) -> Position {
        let bytes = self.bytes(span.file);
        let start = usize::try_from(span.start).unwrap_or(usize::MAX).min(bytes.len());
        let line_start = self.line_start(span).min(start);
        let before = bytes.get(line_start..start).unwrap_or_default();
        let line = self.source(span.file).map_or(0, |source| source.line_ends_before(start));
        Position { line: line + 1, column: characters(before) + 1 }
    }

    /// The first byte of the line where a span starts, after a byte order mark.
    pub fn line_start(&self, span: Span) -> usize {
        let bytes = self.bytes(span.file);
        let at = usize::try_from(span.start).unwrap_or(usize::MAX).min(bytes.len());
        let before = bytes.get(..at).unwrap_or_default();
        match before.iter().rposition(|&byte| byte == b'\n') {
            Some(end) => end + 1,
            None if bytes.starts_with(BYTE_ORDER_MARK) => BYTE_ORDER_MARK.len(),
            None => 0,
        }
    }

    /// `path:line:column` of the place where a span starts.
    pub fn place(&self, span: Span) -> String {
        let Position { line, column } = self.position(span);
        format!("{}:{line}:{column}", self.path(span.file).display())
    }

    fn source(&self, file: FileId) -> Option<&Source> {
        self.files.get(file.0 as usize)
    }
}

impl Source {
    fn line_ends_before(&self, at: usize) -> usize {
        let before_chunk = self.lines_before_chunk.get_or_init(|| {
            let mut sum = 0;
            let counts = self.bytes.chunks(CHUNK).map(|chunk| {
                let before = sum;
                sum += line_ends(chunk);
                before
            });
            counts.collect()
        });
        let chunk = at / CHUNK;
        let whole = before_chunk.get(chunk).copied();
        // A place at the very end of a file of whole chunks has no chunk of its own.
        let (whole, from) = match whole {
            Some(whole) => (whole, chunk * CHUNK),
            None => (before_chunk.last().copied().unwrap_or(0), before_chunk.len().saturating_sub(1) * CHUNK),
        };
        whole + line_ends(self.bytes.get(from..at).unwrap_or_default())
    }
}

fn line_ends(bytes: &[u8]) -> usize {
    count(bytes, |byte| byte == b'\n')
}

/// Characters of UTF-8 text: bytes that do not continue one.
pub(crate) fn characters(bytes: &[u8]) -> usize {
    count(bytes, |byte| byte & 0xC0 != 0x80)
}

/// Short runs summed in one byte, which compilers turn into vector code.
fn count(bytes: &[u8], wanted: impl Fn(u8) -> bool) -> usize {
    bytes.chunks(255).map(|run| usize::from(run.iter().map(|&byte| u8::from(wanted(byte))).sum::<u8>())).sum()
}

#[cfg(test)]
mod tests {
    use super::*;

    fn position_of(text: &[u8], at: usize) -> (usize, usize) {
        let mut sources = Sources::default();
        let file = sources.add(PathBuf::from("a.ray"), text.to_vec());
        let Position { line, column } = sources.position(Span::new(file, at, at));
        (line, column)
    }

    #[test]
    fn lines_and_columns_count_from_one_and_in_characters() {
        assert_eq!(position_of(b"ab\ncd", 4), (2, 2));
        assert_eq!(position_of(b"ab\r\ncd", 4), (2, 1));
        assert_eq!(position_of("äö#".as_bytes(), 4), (1, 3));
        assert_eq!(position_of(b"\xef\xbb\xbf#a", 3), (1, 1));
        assert_eq!(position_of(b"", 0), (1, 1));
        assert_eq!(position_of(b"a\n", 2), (2, 1));
    }

    #[test]
    fn lines_are_right_on_both_sides_of_chunks() {
        let text = b"x\n".repeat(CHUNK);
        for at in [0, 1, 2, CHUNK - 1, CHUNK, CHUNK + 1, 2 * CHUNK - 1, 2 * CHUNK] {
            assert_eq!(position_of(&text, at), (at / 2 + 1, at % 2 + 1), "{at}");
        }
    }

    #[test]
    fn a_line_begins_after_the_mark() {
        let mut sources = Sources::default();
        let file = sources.add(PathBuf::from("a.ray"), b"\xef\xbb\xbfab\r\ncd".to_vec());
        assert_eq!(sources.line_start(Span::new(file, 3, 4)), 3);
        assert_eq!(sources.line_start(Span::new(file, 7, 8)), 7);
        assert_eq!(sources.place(Span::new(file, 8, 9)), "a.ray:2:2");
    }
}

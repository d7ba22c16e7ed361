//! Finished tiles in a file: what is added once stays, whatever happens to the program or to other parts of the file.
//!
//! A file is a row of records. A head says by its [`Fingerprint`] to which picture the tiles belong; it stands at the
//! start and again before each group of tiles that was added, so that no single damage makes the rest worthless. A
//! record carries a checksum; what is between two whole records is skipped.

use crate::fingerprint::Fingerprint;
use crate::tile;
use crate::tile::Tile;
use crate::tile::TilePixels;
use dotray_image::write_file;
use std::fs::File;
use std::fs::OpenOptions;
use std::fs::TryLockError;
use std::io;
use std::io::Cursor;
use std::io::ErrorKind;
use std::io::Read;
use std::io::Seek;
use std::io::SeekFrom;
use std::io::Write;
use std::path::Path;
use xxhash_rust::xxh3::xxh3_64;

/// The four bytes that a head starts with; its checksum and the length of its text follow.
const HEAD_MARK: [u8; 4] = *b"dth1";
const HEAD_START: usize = 4 + 8 + 4;
/// The longest text of a head.
const MAX_TEXT: usize = 1 << 20;

/// A file of finished tiles, open for more.
#[derive(Debug)]
pub struct TileFile {
    file: File,
    head: Vec<u8>,
    /// Where the last whole record ends.
    end: u64,
}

/// Tiles that a file may hold, the first of which has the number that follows those of the tiles known before.
#[derive(Clone, Copy, Debug)]
pub struct Known<'a> {
    /// The tiles, in the order of their numbers.
    pub tiles: &'a [Tile],
    /// Numbers a pixel.
    pub channels: u32,
}

impl Known<'_> {
    /// The tile of a number, and its numbers a pixel.
    fn find(known: &[Self], number: u32) -> Option<(Tile, u32)> {
        let mut left = number as usize;
        for Known { tiles, channels } in known {
            match tiles.get(left) {
                Some(tile) => return Some((*tile, *channels)),
                None => left -= tiles.len(),
            }
        }
        None
    }
}

/// What was found in a file.
#[derive(Debug)]
pub struct Contents {
    /// The picture that the tiles belong to; `None` where no whole head is there.
    pub fingerprint: Option<Fingerprint>,
    /// Bytes that belong to no whole record: damaged ones, or the last ones of a program that was killed.
    pub lost_bytes: u64,
}

impl TileFile {
    /// A new file, which appears whole, without tiles.
    ///
    /// # Errors
    /// What the system says.
    pub fn create(path: &Path, fingerprint: &Fingerprint) -> io::Result<Self> {
        let head = head_bytes(fingerprint);
        write_file(path, &head)?;
        let mut file = open(path)?;
        let end = file.seek(SeekFrom::End(0))?;
        Ok(Self { file, head, end })
    }

    /// A file that is there, to be continued after what `read` found in it.
    ///
    /// # Errors
    /// What the system says; that another program is using the file.
    pub fn open(path: &Path, fingerprint: &Fingerprint) -> io::Result<Self> {
        Ok(Self { file: open(path)?, head: head_bytes(fingerprint), end: 0 })
    }

    /// Reads what is there: shows each whole tile that is `known`. Takes no more memory than a tile.
    ///
    /// # Errors
    /// What the system says.
    pub fn read(&mut self, known: &[Known<'_>], mut take: impl FnMut(TilePixels)) -> io::Result<Contents> {
        let (contents, end) = read_all(&mut self.file, known, &mut take)?;
        self.end = end;
        Ok(contents)
    }

    /// Adds tiles, as [`TilePixels::to_bytes`] gives them one after another; they are on the disk when it returns.
    ///
    /// # Errors
    /// What the system says, such as that the disk is full; the file is then as it was.
    pub fn append(&mut self, tiles: &[u8]) -> io::Result<()> {
        self.file.seek(SeekFrom::Start(self.end))?;
        let head: &[u8] = if self.end == self.head.len() as u64 { &[] } else { &self.head };
        let written = self.file.write_all(head).and_then(|()| self.file.write_all(tiles));
        let kept = written.and_then(|()| {
            let end = self.file.stream_position()?;
            // What a killed program left behind here must not follow.
            self.file.set_len(end)?;
            self.file.sync_data()?;
            Ok(end)
        });
        match kept {
            Ok(end) => {
                self.end = end;
                Ok(())
            }
            Err(error) => {
                // A record that is not whole is skipped anyway, should this fail, too.
                let _ = self.file.set_len(self.end);
                Err(error)
            }
        }
    }
}

/// The picture that a file's tiles belong to; `None` where no whole head is there.
///
/// # Errors
/// What the system says.
pub fn fingerprint_of(path: &Path) -> io::Result<Option<Fingerprint>> {
    let mut file = TileFile { file: File::open(path)?, head: Vec::new(), end: 0 };
    Ok(file.read(&[], |_| {})?.fingerprint)
}

/// Reads a file of tiles that nothing is added to; see [`TileFile::read`].
///
/// # Errors
/// What the system says.
pub fn read_tiles(path: &Path, known: &[Known<'_>], take: impl FnMut(TilePixels)) -> io::Result<Contents> {
    let mut file = TileFile { file: File::open(path)?, head: Vec::new(), end: 0 };
    file.read(known, take)
}

/// Reads what such a file holds from its bytes; see [`TileFile::read`].
pub fn read_bytes(bytes: &[u8], known: &[Known<'_>], mut take: impl FnMut(TilePixels)) -> Contents {
    // Bytes in memory can always be read.
    let nothing = Contents { fingerprint: None, lost_bytes: bytes.len() as u64 };
    read_all(&mut Cursor::new(bytes), known, &mut take).map_or(nothing, |(contents, _)| contents)
}

/// The bytes of a head, as a file starts with them.
pub fn head_bytes(fingerprint: &Fingerprint) -> Vec<u8> {
    let text = fingerprint.to_text().into_bytes();
    let mut bytes = HEAD_MARK.to_vec();
    bytes.extend(xxh3_64(&text).to_le_bytes());
    bytes.extend((text.len() as u32).to_le_bytes());
    bytes.extend(text);
    bytes
}

fn open(path: &Path) -> io::Result<File> {
    let file = OpenOptions::new().read(true).write(true).open(path)?;
    match file.try_lock() {
        Ok(()) => Ok(file),
        Err(TryLockError::WouldBlock) => {
            Err(io::Error::new(ErrorKind::WouldBlock, "another program is adding to it"))
        }
        // Some network file systems have no locks.
        Err(TryLockError::Error(_)) => Ok(file),
    }
}

/// What is there, and where the last whole record ends.
fn read_all(
    file: &mut (impl Read + Seek),
    known: &[Known<'_>],
    take: &mut dyn FnMut(TilePixels),
) -> io::Result<(Contents, u64)> {
    let length = file.seek(SeekFrom::End(0))?;
    let mut contents = Contents { fingerprint: None, lost_bytes: 0 };
    let (mut at, mut end) = (0, 0);
    while at < length {
        let read = match record_at(file, at, known)? {
            Some(Record::Head(fingerprint, read)) => {
                contents.fingerprint.get_or_insert(fingerprint);
                read
            }
            Some(Record::Tile(pixels, read)) => {
                take(pixels);
                read
            }
            None => {
                let next = next_mark(file, at + 1, length)?;
                contents.lost_bytes += next - at;
                at = next;
                continue;
            }
        };
        at += read;
        end = at;
    }
    Ok((contents, end))
}

enum Record {
    Head(Fingerprint, u64),
    Tile(TilePixels, u64),
}

/// The whole record that starts here, if one does.
fn record_at(file: &mut (impl Read + Seek), at: u64, known: &[Known<'_>]) -> io::Result<Option<Record>> {
    let start = read_at_most(file, at, tile::HEAD)?;
    if let Some(rest) = start.strip_prefix(&HEAD_MARK) {
        let (Some(sum), Some(length)) = (rest.get(..8), rest.get(8..12).and_then(|l| l.try_into().ok()))
        else {
            return Ok(None);
        };
        let length = u32::from_le_bytes(length) as usize;
        if length > MAX_TEXT {
            return Ok(None);
        }
        let text = read_at_most(file, at + HEAD_START as u64, length)?;
        if text.len() != length || xxh3_64(&text).to_le_bytes() != sum {
            return Ok(None);
        }
        let fingerprint = Fingerprint::from_text(&String::from_utf8_lossy(&text));
        return Ok(Some(Record::Head(fingerprint, (HEAD_START + length) as u64)));
    }
    let number = TilePixels::number_in(&start);
    let Some((tile, channels)) = number.and_then(|number| Known::find(known, number)) else {
        return Ok(None);
    };
    let length = TilePixels::byte_length(&tile, channels);
    let bytes = read_at_most(file, at, usize::try_from(length).unwrap_or(usize::MAX))?;
    let pixels =
        TilePixels::from_bytes(&bytes).filter(|pixels| pixels.tile == tile && pixels.channels == channels);
    Ok(pixels.map(|pixels| Record::Tile(pixels, length)))
}

fn read_at_most(file: &mut (impl Read + Seek), at: u64, length: usize) -> io::Result<Vec<u8>> {
    file.seek(SeekFrom::Start(at))?;
    let mut bytes = Vec::new();
    file.take(length as u64).read_to_end(&mut bytes)?;
    Ok(bytes)
}

/// The next place at or after `at` where a record may start; `end` where there is none.
fn next_mark(file: &mut (impl Read + Seek), at: u64, end: u64) -> io::Result<u64> {
    const WINDOW: usize = 1 << 16;
    let mut at = at;
    while at < end {
        let window = read_at_most(file, at, WINDOW)?;
        let found = window.windows(4).position(|four| four == HEAD_MARK || four == tile::MARK);
        if let Some(found) = found {
            return Ok(at + found as u64);
        }
        if window.len() < WINDOW {
            break;
        }
        // A mark may stand across the border of two windows.
        at += (WINDOW - 3) as u64;
    }
    Ok(end)
}

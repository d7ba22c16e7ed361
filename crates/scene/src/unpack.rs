//! Compressed scenes: told by how they begin, not by their names.

use std::io;
use std::io::Read;

const GZIP: [u8; 3] = [0x1f, 0x8b, 8];
const ZSTANDARD: [u8; 4] = [0x28, 0xb5, 0x2f, 0xfd];

/// The content of a gzip or Zstandard file; other bytes as they are. A few bytes can stand for any number of them, so
/// that no more than `limit` are unpacked.
///
/// # Errors
/// [`io::ErrorKind::FileTooLarge`] beyond the limit, [`io::ErrorKind::InvalidData`] for damaged files.
pub(crate) fn unpacked(bytes: Vec<u8>, limit: u64) -> io::Result<Vec<u8>> {
    if bytes.starts_with(&GZIP) {
        within(flate2::read::MultiGzDecoder::new(bytes.as_slice()), limit)
            .map_err(|fault| damaged("gzip", fault))
    } else if bytes.starts_with(&ZSTANDARD) {
        zstandard(&bytes, limit).map_err(|fault| damaged("Zstandard", fault))
    } else {
        Ok(bytes)
    }
}

fn within(packed: impl Read, limit: u64) -> io::Result<Vec<u8>> {
    let mut content = Vec::new();
    let read = packed.take(limit.saturating_add(1)).read_to_end(&mut content)?;
    if read as u64 > limit { Err(io::ErrorKind::FileTooLarge.into()) } else { Ok(content) }
}

/// Frame after frame, as `zstd` itself and its parallel sisters write them.
fn zstandard(bytes: &[u8], limit: u64) -> io::Result<Vec<u8>> {
    let mut content = Vec::new();
    let mut rest = bytes;
    while !rest.is_empty() {
        if let Some(after) = skippable(rest) {
            rest = after;
            continue;
        }
        let before = rest.len();
        let frame = ruzstd::decoding::StreamingDecoder::new(&mut rest).map_err(io::Error::other)?;
        content.extend(within(frame, limit.saturating_sub(content.len() as u64))?);
        if rest.len() == before {
            return Err(io::Error::other("a frame without content"));
        }
    }
    Ok(content)
}

/// What follows a frame that holds no content but, say, a table of places.
fn skippable(bytes: &[u8]) -> Option<&[u8]> {
    let (head, rest) = bytes.split_first_chunk::<8>()?;
    let [0x50..=0x5f, 0x2a, 0x4d, 0x18, length @ ..] = *head else { return None };
    rest.get(usize::try_from(u32::from_le_bytes(length)).ok()?..)
}

fn damaged(format: &str, fault: io::Error) -> io::Error {
    if fault.kind() == io::ErrorKind::FileTooLarge {
        return fault;
    }
    io::Error::new(io::ErrorKind::InvalidData, format!("the {format} data is damaged: {fault}"))
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::io::Write;

    fn gzip(text: &[u8]) -> Vec<u8> {
        let mut encoder = flate2::write::GzEncoder::new(Vec::new(), flate2::Compression::default());
        encoder.write_all(text).unwrap();
        encoder.finish().unwrap()
    }

    fn zstd(text: &[u8]) -> Vec<u8> {
        ruzstd::encoding::compress_to_vec(text, ruzstd::encoding::CompressionLevel::Fastest)
    }

    #[test]
    fn packed_bytes_come_back_and_others_stay() {
        let text = b"#ambient 1 1 1\n".repeat(1000);
        for packed in [text.clone(), gzip(&text), zstd(&text)] {
            assert!(unpacked(packed.clone(), 15_000).unwrap() == text);
        }
        for pack in [gzip, zstd] {
            let two = [pack(&text), pack(b"tail")].concat();
            assert!(unpacked(two.clone(), 15_004).unwrap().ends_with(b"1\ntail"));
            assert_eq!(unpacked(two, 15_003).unwrap_err().kind(), io::ErrorKind::FileTooLarge);
        }
        let with_table = [zstd(&text), vec![0x5e, 0x2a, 0x4d, 0x18, 3, 0, 0, 0, 7, 7, 7]].concat();
        assert!(unpacked(with_table, 15_000).unwrap() == text);
    }

    #[test]
    fn bombs_and_damage_are_errors() {
        let text = vec![b' '; 1 << 24];
        for pack in [gzip, zstd] {
            let packed = pack(&text);
            assert!(packed.len() < 1 << 17);
            assert_eq!(unpacked(packed.clone(), 1 << 20).unwrap_err().kind(), io::ErrorKind::FileTooLarge);
            let small = pack(b"#ambient .1 .2 .3 and so on and so on");
            for end in 4..small.len() {
                assert!(unpacked(small[..end].to_vec(), 1 << 20).is_err(), "{end}");
            }
            for at in 4..small.len() {
                let mut flipped = small.clone();
                flipped[at] ^= 0x55;
                // Whatever comes of it, it comes to an end.
                let _ = unpacked(flipped, 1 << 20);
            }
        }
    }
}

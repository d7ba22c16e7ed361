//! Windows bitmaps, the course's own format: read in all their kinds, written as the course's `bmp.c` does.

mod header;

mod rle;

mod read;

mod write;

pub(crate) use read::decode;
pub(crate) use write::encode;

//! The squares that a picture is computed in, and what one of them holds once it is computed.

use crate::options::Options;
use crate::stats::Stats;
use xxhash_rust::xxh3::xxh3_64;

/// A part of a picture that is computed at once. Pixels are counted from the upper left of the whole picture.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub struct Tile {
    /// Its number in the picture: its place on the Morton curve.
    pub number: u32,
    /// The first column.
    pub x: u32,
    /// The first row from above.
    pub y: u32,
    /// Columns.
    pub width: u32,
    /// Rows.
    pub height: u32,
}

impl Tile {
    /// How many pixels it has.
    pub fn pixels(&self) -> u64 {
        u64::from(self.width) * u64::from(self.height)
    }
}

/// The window in tiles along a Morton curve, so that tiles computed one after another look at the same part of the
/// scene. The grid of tiles starts at the picture's lower left corner.
pub fn tiles(options: &Options) -> Vec<Tile> {
    let window = options.window();
    let size = options.tile_size;
    let bottom = options.height - window.y - window.height;
    let columns = window.x / size..(window.x + window.width).div_ceil(size);
    let rows = bottom / size..(bottom + window.height).div_ceil(size);
    let mut tiles: Vec<(u64, Tile)> = Vec::new();
    for row in rows {
        for column in columns.clone() {
            let (left, low) = ((column * size).max(window.x), (row * size).max(bottom));
            let right = ((column + 1) * size).min(window.x + window.width);
            let high = ((row + 1) * size).min(bottom + window.height);
            let (width, height) = (right - left, high - low);
            let tile = Tile { number: 0, x: left, y: options.height - high, width, height };
            tiles.push((spread(column) | spread(row) << 1, tile));
        }
    }
    tiles.sort_by_key(|(key, _)| *key);
    (0..).zip(tiles).map(|(number, (_, tile))| Tile { number, ..tile }).collect()
}

/// The bits of a number on every other place.
fn spread(number: u32) -> u64 {
    (0..32).fold(0, |sum, bit| sum | u64::from(number >> bit & 1) << (2 * bit))
}

/// A tile that is computed.
#[derive(Clone, Debug, PartialEq)]
pub struct TilePixels {
    /// Which part of the picture it is.
    pub tile: Tile,
    /// Numbers a pixel: 3, or 4 with alpha.
    pub channels: u32,
    /// The pixels row by row from the upper left, as the picture's image holds them.
    pub samples: Vec<f32>,
    /// The rays and tests that it took. Samples on the border between two tiles are counted where they were traced.
    pub counts: Stats,
}

/// The four bytes that a stored tile starts with.
pub(crate) const MARK: [u8; 4] = *b"dtt1";
/// Mark, checksum, tile, channels, counts.
pub(crate) const HEAD: usize = 4 + 8 + 5 * 4 + 4 + 6 * 8;

impl TilePixels {
    /// The tile as bytes, the same on every machine: a mark, a checksum of all that follows it, the tile's five
    /// numbers, its channels, its six counts, its samples; little endian.
    pub fn to_bytes(&self) -> Vec<u8> {
        let mut bytes = Vec::with_capacity(HEAD + 4 * self.samples.len());
        bytes.extend(MARK);
        bytes.extend([0; 8]);
        let Tile { number, x, y, width, height } = self.tile;
        for value in [number, x, y, width, height, self.channels] {
            bytes.extend(value.to_le_bytes());
        }
        for count in counts(&self.counts) {
            bytes.extend(count.to_le_bytes());
        }
        for sample in &self.samples {
            bytes.extend(sample.to_le_bytes());
        }
        let sum = xxh3_64(&bytes[12..]);
        bytes[4..12].copy_from_slice(&sum.to_le_bytes());
        bytes
    }

    /// The tile that [`TilePixels::to_bytes`] made these bytes of; `None` where they are not whole or not as they were.
    pub fn from_bytes(bytes: &[u8]) -> Option<Self> {
        let (head, pixels) = bytes.split_at_checked(HEAD)?;
        let (mark, head) = head.split_at_checked(4)?;
        let (sum, head) = head.split_at_checked(8)?;
        if mark != MARK || sum != xxh3_64(bytes.get(12..)?).to_le_bytes() {
            return None;
        }
        let (tile, head) = head.split_at_checked(6 * 4)?;
        let mut numbers =
            tile.chunks_exact(4).filter_map(|four| Some(u32::from_le_bytes(four.try_into().ok()?)));
        let mut next = || numbers.next();
        let tile = Tile { number: next()?, x: next()?, y: next()?, width: next()?, height: next()? };
        let channels = next()?;
        let mut numbers =
            head.chunks_exact(8).filter_map(|eight| Some(u64::from_le_bytes(eight.try_into().ok()?)));
        let mut next = || numbers.next();
        let counts = Stats {
            eye_rays: next()?,
            shadow_rays: next()?,
            reflected_rays: next()?,
            refracted_rays: next()?,
            box_tests: next()?,
            shape_tests: next()?,
            ..Stats::default()
        };
        let samples =
            pixels.chunks_exact(4).filter_map(|four| Some(f32::from_le_bytes(four.try_into().ok()?)));
        let pixels = Self { tile, channels, samples: samples.collect(), counts };
        pixels.is_whole().then_some(pixels)
    }

    /// The number of the tile that such bytes are of, if they begin like those of a tile.
    pub(crate) fn number_in(head: &[u8]) -> Option<u32> {
        let number = head.strip_prefix(&MARK)?.get(8..12)?;
        Some(u32::from_le_bytes(number.try_into().ok()?))
    }

    /// How many bytes [`TilePixels::to_bytes`] makes of a tile.
    pub fn byte_length(tile: &Tile, channels: u32) -> u64 {
        HEAD as u64 + tile.pixels() * u64::from(channels) * 4
    }

    /// Whether there are as many samples as the tile has pixels.
    pub(crate) fn is_whole(&self) -> bool {
        let samples = self.tile.pixels().checked_mul(u64::from(self.channels));
        self.channels > 0 && samples == Some(self.samples.len() as u64)
    }
}

fn counts(stats: &Stats) -> [u64; 6] {
    let Stats { eye_rays, shadow_rays, reflected_rays, refracted_rays, box_tests, shape_tests, .. } = *stats;
    [eye_rays, shadow_rays, reflected_rays, refracted_rays, box_tests, shape_tests]
}

#[cfg(test)]
mod tests {
    use super::*;

    fn some() -> TilePixels {
        let tile = Tile { number: 7, x: 3, y: 4, width: 2, height: 3 };
        let samples = (0..18).map(|k| k as f32 * 0.37 - 1.0).collect();
        let counts = Stats { eye_rays: 6, shape_tests: u64::MAX, ..Stats::default() };
        TilePixels { tile, channels: 3, samples, counts }
    }

    #[test]
    fn a_tile_comes_back_from_its_bytes() {
        let bytes = some().to_bytes();
        assert_eq!(bytes.len() as u64, TilePixels::byte_length(&some().tile, 3));
        assert_eq!(TilePixels::from_bytes(&bytes), Some(some()));
    }

    #[test]
    fn no_change_of_a_byte_goes_unseen() {
        let whole = some().to_bytes();
        for place in 0..whole.len() {
            for flip in [1, 0x80, 0xff] {
                let mut bytes = whole.clone();
                bytes[place] ^= flip;
                assert_eq!(TilePixels::from_bytes(&bytes), None, "byte {place}");
            }
            assert_eq!(TilePixels::from_bytes(&whole[..place]), None, "cut at {place}");
        }
        let longer: Vec<u8> = whole.iter().copied().chain([0; 4]).collect();
        assert_eq!(TilePixels::from_bytes(&longer), None);
    }

    #[test]
    fn tiles_cover_the_window_once() {
        let crop = crate::options::Crop { x: 7, y: 5, width: 50, height: 41 };
        let options =
            Options { width: 100, height: 90, crop: Some(crop), tile_size: 16, ..Options::default() };
        let mut covered = vec![0; 100 * 90];
        for (number, tile) in (0..).zip(tiles(&options)) {
            assert_eq!(tile.number, number);
            for y in tile.y..tile.y + tile.height {
                (tile.x..tile.x + tile.width).for_each(|x| covered[(y * 100 + x) as usize] += 1);
            }
        }
        for (at, count) in (0_u32..).zip(covered) {
            let inside = (7..57).contains(&(at % 100)) && (5..46).contains(&(at / 100));
            assert_eq!(count, u32::from(inside), "{at}");
        }
    }
}

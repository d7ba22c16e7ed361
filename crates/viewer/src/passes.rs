//! In which order pixels are traced: coarse to fine, and every pixel once.

use dotray_render::Crop;

/// The distances of the pixels of successive passes.
const STRIDES: [u32; 5] = [16, 8, 4, 2, 1];

/// The edge of a tile in samples of the pass.
const TILE: u32 = 16;

/// The pixels of a window pass after pass, each a pixel that no earlier pass had: row from above, column, and the edge
/// of the square that it stands for until finer passes come.
#[derive(Clone, Debug)]
pub struct Passes {
    window: Crop,
    finest: u32,
    pass: usize,
    /// The tiles of the pass, those in the middle of the window first.
    tiles: Vec<(u32, u32)>,
    next_tile: usize,
    /// Pixels of a tile that were too many for the last portion.
    left: Vec<Spot>,
}

/// A pixel to trace.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Spot {
    /// Column within the window.
    pub x: u32,
    /// Row within the window, from above.
    pub y: u32,
    /// The edge of the square that it stands for.
    pub size: u32,
}

impl Passes {
    /// All pixels of a window, or only those `finest` apart.
    pub fn new(window: Crop, finest: u32) -> Self {
        let mut passes = Self { window, finest, pass: 0, tiles: Vec::new(), next_tile: 0, left: Vec::new() };
        passes.tiles = passes.tiles_of(0);
        passes
    }

    fn tiles_of(&self, pass: usize) -> Vec<(u32, u32)> {
        let Some(&stride) = STRIDES.get(pass).filter(|stride| **stride >= self.finest) else {
            return Vec::new();
        };
        let edge = stride * TILE;
        let (columns, rows) = (self.window.width.div_ceil(edge), self.window.height.div_ceil(edge));
        let mut tiles: Vec<(u32, u32)> = (0..rows).flat_map(|y| (0..columns).map(move |x| (x, y))).collect();
        // Twice the distance of the tile's middle from the window's, squared.
        let off = |at: u32, size: u32| i64::from((2 * at + 1) * edge) - i64::from(size);
        tiles.sort_by_key(|&(x, y)| off(x, self.window.width).pow(2) + off(y, self.window.height).pow(2));
        tiles
    }

    /// The next pixels, about `most`; none at the end.
    pub fn next(&mut self, most: usize) -> Vec<Spot> {
        let mut spots = std::mem::take(&mut self.left);
        while spots.len() < most {
            let Some(&tile) = self.tiles.get(self.next_tile) else {
                if !spots.is_empty() || STRIDES.get(self.pass).is_none() {
                    break;
                }
                self.pass += 1;
                (self.tiles, self.next_tile) = (self.tiles_of(self.pass), 0);
                continue;
            };
            self.next_tile += 1;
            self.push_tile(tile, &mut spots);
        }
        if spots.len() > most {
            self.left = spots.split_off(most.max(1));
        }
        spots
    }

    /// Takes back pixels that were not traced after all; they come next.
    pub fn give_back(&mut self, spots: impl IntoIterator<Item = Spot>) {
        self.left.splice(0..0, spots);
    }

    fn push_tile(&self, (column, row): (u32, u32), spots: &mut Vec<Spot>) {
        let size = STRIDES.get(self.pass).copied().unwrap_or(1);
        let edge = size * TILE;
        let (left, top) = (column * edge, row * edge);
        for y in (top..(top + edge).min(self.window.height)).step_by(size as usize) {
            for x in (left..(left + edge).min(self.window.width)).step_by(size as usize) {
                let earlier = self.pass > 0 && x % (2 * size) == 0 && y % (2 * size) == 0;
                if !earlier {
                    spots.push(Spot { x, y, size });
                }
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_pixel_comes_once_and_squares_shrink() {
        for (width, height) in [(1, 1), (16, 16), (37, 53), (300, 17)] {
            let mut passes = Passes::new(Crop { x: 5, y: 9, width, height }, 1);
            let mut seen = vec![0_u32; (width * height) as usize];
            let mut last = u32::MAX;
            loop {
                let spots = passes.next(41);
                if spots.is_empty() {
                    break;
                }
                assert!(spots.len() <= 41);
                for Spot { x, y, size } in spots {
                    seen[(y * width + x) as usize] += 1;
                    assert!(size <= last);
                    last = size;
                }
            }
            assert!(seen.iter().all(|count| *count == 1), "{width}x{height}");
        }
    }

    #[test]
    fn a_coarse_pass_alone_ends_early() {
        let mut passes = Passes::new(Crop { x: 0, y: 0, width: 64, height: 64 }, 8);
        assert_eq!(passes.next(1000).len(), 16);
        assert_eq!(passes.next(1000).len(), 48);
        assert_eq!(passes.next(1000).len(), 0);
    }
}

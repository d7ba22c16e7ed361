//! Where a pixel's samples lie, and how they become its colour (SPEC 3 and 4). Pure: whoever calls says what colour
//! a place has.

use dotray_geometry::Vec3;
use dotray_geometry::Vec4;
use std::collections::HashMap;
use std::iter::Sum;
use std::ops::Add;
use std::ops::Div;
use std::ops::Mul;

/// What a sample is: a colour, or a colour times its alpha and that alpha.
pub trait Sample:
    Copy
    + PartialEq
    + Send
    + Sync
    + Add<Output = Self>
    + Mul<f64, Output = Self>
    + Div<f64, Output = Self>
    + for<'a> Sum<&'a Self>
{
    /// The largest difference of a channel among samples.
    fn spread(samples: [Self; 4]) -> f64;
}

impl Sample for Vec3 {
    fn spread(samples: [Self; 4]) -> f64 {
        let least = samples.into_iter().fold(Self::INFINITY, Self::min);
        let most = samples.into_iter().fold(Self::NEG_INFINITY, Self::max);
        (most - least).max_element()
    }
}

impl Sample for Vec4 {
    fn spread(samples: [Self; 4]) -> f64 {
        let least = samples.into_iter().fold(Self::INFINITY, Self::min);
        let most = samples.into_iter().fold(Self::NEG_INFINITY, Self::max);
        (most - least).max_element()
    }
}

/// A place in the picture in units of a pixel's finest division, from the lower left corner.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, PartialOrd, Ord)]
pub struct LatticePoint {
    /// To the right.
    pub x: u64,
    /// Up.
    pub y: u64,
}

/// Pixels `x .. x + width`, `y .. y + height`, counted from the lower left.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Block {
    /// The first column.
    pub x: u32,
    /// The first row from below.
    pub y: u32,
    /// Columns.
    pub width: u32,
    /// Rows.
    pub height: u32,
}

impl Block {
    /// The pixels in the order in which they are traced: bricks of 4 × 2, eight bricks to a brick of 16 × 4, so that
    /// rays that follow each other stay together.
    pub fn pixels(&self) -> Vec<(u32, u32)> {
        let mut pixels = Vec::with_capacity(self.width as usize * self.height as usize);
        for corner in self.bricks([16, 4]) {
            for brick in corner.bricks([4, 2]) {
                for j in brick.y..brick.y + brick.height {
                    for i in brick.x..brick.x + brick.width {
                        pixels.push((i, j));
                    }
                }
            }
        }
        pixels
    }

    /// The block in bricks of this size, row by row from below; the last ones may be smaller.
    fn bricks(&self, [columns, rows]: [u32; 2]) -> Vec<Self> {
        let mut bricks = Vec::new();
        for y in (self.y..self.y + self.height).step_by(rows as usize) {
            for x in (self.x..self.x + self.width).step_by(columns as usize) {
                let (width, height) = (self.x + self.width - x, self.y + self.height - y);
                bricks.push(Self { x, y, width: width.min(columns), height: height.min(rows) });
            }
        }
        bricks
    }
}

/// The centres of n × n sub-pixels of each pixel, pixel by pixel.
pub fn grid_places(pixels: &[(u32, u32)], n: u32) -> Vec<(f64, f64)> {
    let at = |whole: u32, part: u32| f64::from(whole) + (f64::from(part) + 0.5) / f64::from(n);
    if n == 1 {
        return pixels.iter().map(|&(i, j)| (f64::from(i) + 0.5, f64::from(j) + 0.5)).collect();
    }
    let mut places = Vec::with_capacity(pixels.len() * (n * n) as usize);
    for &(i, j) in pixels {
        places.extend((0..n).flat_map(|b| (0..n).map(move |a| (at(i, a), at(j, b)))));
    }
    places
}

/// The mean of each pixel's n × n colours.
pub fn grid_means<T: Sample>(colors: Vec<T>, n: u32) -> Vec<T> {
    if n == 1 {
        return colors;
    }
    let count = (n * n) as usize;
    colors.chunks_exact(count).map(|samples| samples.iter().sum::<T>() / count as f64).collect()
}

/// A square of the lattice whose corners are known.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Quad {
    /// Its corner.
    pub lower_left: LatticePoint,
    /// Its edge in units of the lattice.
    pub edge: u64,
}

impl Quad {
    fn point(&self, right: u64, up: u64) -> LatticePoint {
        LatticePoint { x: self.lower_left.x + right, y: self.lower_left.y + up }
    }

    /// Lower left, lower right, upper left, upper right.
    pub fn corners(&self) -> [LatticePoint; 4] {
        let e = self.edge;
        [self.point(0, 0), self.point(e, 0), self.point(0, e), self.point(e, e)]
    }

    /// The four edges' middles and the centre.
    fn middles(&self) -> [LatticePoint; 5] {
        let (h, e) = (self.edge / 2, self.edge);
        [self.point(h, 0), self.point(0, h), self.point(h, h), self.point(e, h), self.point(h, e)]
    }

    fn quadrants(&self) -> [Self; 4] {
        let edge = self.edge / 2;
        let at = |right, up| Self { lower_left: self.point(right, up), edge };
        [at(0, 0), at(edge, 0), at(0, edge), at(edge, edge)]
    }
}

/// Adaptive oversampling of a block: the colours of its pixels, in the order of [`Block::pixels`].
///
/// `trace` gives the colours of places it has not been asked for before in this call. Squares are divided level by
/// level, so that a level's places are traced together.
pub fn adaptive<T: Sample>(
    block: Block,
    threshold: f64,
    depth: u32,
    trace: impl FnMut(&[LatticePoint]) -> Vec<T>,
) -> Vec<T> {
    Division::new(block, threshold, depth, trace).means()
}

/// The squares of a level and, for those divided, where their quadrants begin in the next level.
type DividedSquares = Vec<(Quad, Option<usize>)>;

/// A block's pixels, divided where their corners differ.
pub struct Division<T> {
    levels: Vec<DividedSquares>,
    known: HashMap<LatticePoint, T>,
}

impl<T: Sample> Division<T> {
    /// Divides; arguments as for [`adaptive`].
    pub fn new(
        block: Block,
        threshold: f64,
        depth: u32,
        mut trace: impl FnMut(&[LatticePoint]) -> Vec<T>,
    ) -> Self {
        let edge = 1u64 << depth;
        let pixel = |(i, j): (u32, u32)| Quad {
            lower_left: LatticePoint { x: u64::from(i) * edge, y: u64::from(j) * edge },
            edge,
        };
        let mut known = HashMap::new();
        let pixels: Vec<Quad> = block.pixels().into_iter().map(pixel).collect();
        learn(pixels.iter().flat_map(Quad::corners), &mut known, &mut trace);
        let mut levels: Vec<DividedSquares> = Vec::new();
        let mut current = pixels;
        for level in 0..=depth {
            let mut next: Vec<Quad> = Vec::new();
            let mut squares = Vec::with_capacity(current.len());
            for quad in &current {
                let divide = level < depth && differ(quad.corners().map(|p| known[&p]), threshold);
                squares.push((*quad, divide.then_some(next.len())));
                if divide {
                    next.extend(quad.quadrants());
                }
            }
            let divided = squares.iter().filter(|(_, quadrants)| quadrants.is_some());
            learn(divided.flat_map(|(quad, _)| quad.middles()), &mut known, &mut trace);
            levels.push(squares);
            current = next;
        }
        Self { levels, known }
    }

    /// The colours of the pixels, in the order of [`Block::pixels`].
    pub fn means(&self) -> Vec<T> {
        let mut below: Vec<T> = Vec::new();
        for squares in self.levels.iter().rev() {
            let mean = |(quad, quadrants): &(Quad, Option<usize>)| match quadrants {
                Some(first) => {
                    quarter_sum([below[*first], below[first + 1], below[first + 2], below[first + 3]])
                }
                None => quarter_sum(quad.corners().map(|p| self.known[&p])),
            };
            let means = squares.iter().map(mean).collect();
            below = means;
        }
        below
    }

    /// The squares that were not divided further, coarse ones first, each with its level: it weighs 4^-level of its
    /// pixel, and each of its corners a quarter of that.
    pub fn squares(&self) -> Vec<(u32, Quad)> {
        let levels = (0..).zip(&self.levels);
        let whole = |(level, squares): (u32, &DividedSquares)| {
            let whole = squares.iter().filter(|(_, quadrants)| quadrants.is_none());
            whole.map(move |(quad, _)| (level, *quad)).collect::<Vec<_>>()
        };
        levels.flat_map(whole).collect()
    }

    /// The colour of every place that was traced.
    pub fn color(&self, point: LatticePoint) -> Option<T> {
        self.known.get(&point).copied()
    }
}

fn quarter_sum<T: Sample>([a, b, c, d]: [T; 4]) -> T {
    (a + b + c + d) * 0.25
}

/// Whether the largest channel difference exceeds the threshold.
fn differ<T: Sample>(corners: [T; 4], threshold: f64) -> bool {
    T::spread(corners) > threshold
}

fn learn<T: Sample>(
    wanted: impl Iterator<Item = LatticePoint>,
    known: &mut HashMap<LatticePoint, T>,
    trace: &mut impl FnMut(&[LatticePoint]) -> Vec<T>,
) {
    let mut unknown: Vec<LatticePoint> = wanted.filter(|point| !known.contains_key(point)).collect();
    unknown.sort_unstable_by_key(|point| (point.y, point.x));
    unknown.dedup();
    let colors = trace(&unknown);
    known.extend(unknown.into_iter().zip(colors));
}

#[cfg(test)]
mod tests {
    use super::*;

    const BLOCK: Block = Block { x: 3, y: 5, width: 4, height: 2 };

    #[test]
    fn an_even_picture_costs_its_corners() {
        let mut traced = 0;
        let colors = adaptive(BLOCK, 0.1, 3, |points| {
            traced += points.len();
            vec![Vec3::splat(0.25); points.len()]
        });
        assert_eq!(traced, 5 * 3);
        assert_eq!(colors, vec![Vec3::splat(0.25); 8]);
    }

    /// The definition of SPEC 4, word for word, without sharing.
    fn by_definition(
        quad: Quad,
        level: u32,
        depth: u32,
        threshold: f64,
        color: &impl Fn(LatticePoint) -> Vec3,
    ) -> Vec3 {
        let corners = quad.corners().map(color);
        if level == depth || !differ(corners, threshold) {
            return quarter_sum(corners);
        }
        quarter_sum(quad.quadrants().map(|q| by_definition(q, level + 1, depth, threshold, color)))
    }

    #[test]
    fn levels_give_what_the_definition_gives_and_trace_nothing_twice() {
        let color = |p: LatticePoint| {
            let (x, y) = (p.x as f64 / 8.0 - 4.6, p.y as f64 / 8.0 - 5.7);
            if x * x + y * y < 1.0 { Vec3::new(1.0, x, y) } else { Vec3::splat(0.1) }
        };
        for depth in 0..=3 {
            let scale = 8 >> depth;
            let scaled = |p: LatticePoint| color(LatticePoint { x: p.x * scale, y: p.y * scale });
            let mut seen = std::collections::HashSet::new();
            let colors = adaptive(BLOCK, 0.1, depth, |points| {
                assert!(points.iter().all(|p| seen.insert(*p)));
                points.iter().map(|p| scaled(*p)).collect()
            });
            let edge = 1 << depth;
            let expected: Vec<Vec3> = BLOCK
                .pixels()
                .into_iter()
                .map(|(i, j)| {
                    let lower_left = LatticePoint { x: u64::from(i) * edge, y: u64::from(j) * edge };
                    by_definition(Quad { lower_left, edge }, 0, depth, 0.1, &scaled)
                })
                .collect();
            assert_eq!(colors, expected);
        }
    }

    #[test]
    fn every_pixel_stands_once_in_the_order() {
        let mut pixels = Block { x: 5, y: 3, width: 37, height: 9 }.pixels();
        assert_eq!(pixels[..9], [(5, 3), (6, 3), (7, 3), (8, 3), (5, 4), (6, 4), (7, 4), (8, 4), (9, 3)]);
        pixels.sort_unstable_by_key(|&(i, j)| (j, i));
        let expected: Vec<_> = (3..12).flat_map(|j| (5..42).map(move |i| (i, j))).collect();
        assert_eq!(pixels, expected);
    }

    #[test]
    fn grid_places_are_centres() {
        let places = grid_places(&[(7, 1)], 2);
        assert_eq!(places, [(7.25, 1.25), (7.75, 1.25), (7.25, 1.75), (7.75, 1.75)]);
    }
}

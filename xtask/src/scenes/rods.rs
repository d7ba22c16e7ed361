//! Cylinders, cones and boxes that lie anywhere at any angle.

use crate::random::Random;
use crate::scenes::Block;
use crate::scenes::Rod;
use crate::scenes::across;
use crate::scenes::particles::MATERIALS;
use std::f64::consts::PI;

/// What a rod of length 1 and radius ⅛ hides seen from the side, as a mean over all directions: ¼ · π/4.
const SHADOW: f64 = PI / 16.0;

/// `count` rods of one length, radius an eighth of it, as many as hide an optical depth of 2.
pub fn rods(count: usize, seed: u64) -> Vec<Rod> {
    let mut random = Random::new(seed + count as u64);
    let length = (2.0 / (count as f64 * SHADOW)).sqrt();
    (0..count)
        .map(|_| {
            let (center, axis) = (random.point(), random.direction());
            let end = |sign: f64| [0, 1, 2].map(|i| (center[i] + sign * 0.5 * length * axis[i]) as f32);
            let material = random.below(MATERIALS) as u8;
            Rod { base: end(-1.0), top: end(1.0), radius: (length * 0.125) as f32, material }
        })
        .collect()
}

/// `count` boxes as long as the rods, a quarter as wide and deep, turned at random.
pub fn blocks(count: usize) -> Vec<Block> {
    let mut random = Random::new(31 + count as u64);
    let length = (2.0 / (count as f64 * SHADOW)).sqrt();
    (0..count)
        .map(|_| {
            let (center, axis) = (random.point(), random.direction());
            let [x, z] = across(axis);
            let material = random.below(MATERIALS) as u8;
            let size = [0.25, 1.0, 0.25].map(|part| (part * length) as f32);
            Block { center: center.map(|x| x as f32), size, axes: [x, axis, z], material }
        })
        .collect()
}

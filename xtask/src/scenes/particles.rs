//! Spheres: random ones and packed ones.

use crate::random::Random;
use crate::scenes::Ball;
use std::f64::consts::PI;

/// How many materials particles have.
pub const MATERIALS: usize = 8;

fn material(random: &mut Random) -> u8 {
    random.below(MATERIALS) as u8
}

/// `count` spheres with centres anywhere in the unit cube and radii within a quarter of r, where N·π·r² = 2: the
/// same optical depth for every N.
pub fn random(count: usize) -> Vec<Ball> {
    let mut random = Random::new(1 + count as u64);
    let radius = (2.0 / (PI * count as f64)).sqrt();
    (0..count)
        .map(|_| {
            let center = random.point().map(|x| x as f32);
            let radius = (radius * (0.75 + 0.5 * random.unit())) as f32;
            Ball { center, radius, material: material(&mut random) }
        })
        .collect()
}

/// About `count` equal spheres on a jittered cubic lattice, none of which meets another, in random order: what a
/// snapshot of particles looks like; a quarter of the volume is full.
pub fn packed(count: usize) -> Vec<Ball> {
    let mut random = Random::new(7 + count as u64);
    let edge = libm::cbrt(count as f64).round() as usize;
    let cell = 1.0 / edge as f64;
    let mut balls: Vec<_> = (0..edge * edge * edge)
        .map(|i| {
            let place = [i % edge, i / edge % edge, i / (edge * edge)];
            let center = place.map(|p| ((p as f64 + 0.4 + 0.2 * random.unit()) * cell) as f32);
            Ball { center, radius: (0.39 * cell) as f32, material: material(&mut random) }
        })
        .collect();
    for last in (1..balls.len()).rev() {
        balls.swap(last, random.below(last + 1));
    }
    balls
}

#[cfg(test)]
mod tests {
    use super::packed;
    use super::random;
    use std::f64::consts::PI;

    #[test]
    fn optical_depth_is_two_for_every_number() {
        for count in [1000, 100_000] {
            let depth: f64 = random(count).iter().map(|ball| PI * f64::from(ball.radius * ball.radius)).sum();
            // The mean of (¾ + u/2)² is 1 + 1/48.
            assert!((depth - 2.0 * (1.0 + 1.0 / 48.0)).abs() < 0.05, "{depth}");
        }
    }

    #[test]
    fn packed_spheres_do_not_meet() {
        let balls = packed(1000);
        assert_eq!(balls.len(), 1000);
        for (i, a) in balls.iter().enumerate() {
            for b in &balls[..i] {
                let square: f32 =
                    (0..3).map(|k| (a.center[k] - b.center[k]) * (a.center[k] - b.center[k])).sum();
                assert!(square > (a.radius + b.radius) * (a.radius + b.radius));
            }
        }
    }
}

//! The same random numbers on every machine.

/// A stream of numbers: Steele, Lea and Flood's SplitMix64.
pub struct Random(u64);

impl Random {
    /// The stream of a seed.
    pub const fn new(seed: u64) -> Self {
        Self(seed)
    }

    /// 64 random bits.
    pub fn bits(&mut self) -> u64 {
        self.0 = self.0.wrapping_add(0x9E37_79B9_7F4A_7C15);
        let mixed = (self.0 ^ (self.0 >> 30)).wrapping_mul(0xBF58_476D_1CE4_E5B9);
        let mixed = (mixed ^ (mixed >> 27)).wrapping_mul(0x94D0_49BB_1331_11EB);
        mixed ^ (mixed >> 31)
    }

    /// A number in [0, 1).
    pub fn unit(&mut self) -> f64 {
        (self.bits() >> 11) as f64 / (1_u64 << 53) as f64
    }

    /// A whole number below `limit`.
    pub fn below(&mut self, limit: usize) -> usize {
        ((self.unit() * limit as f64) as usize).min(limit.saturating_sub(1))
    }

    /// A point of the unit cube.
    pub fn point(&mut self) -> [f64; 3] {
        [self.unit(), self.unit(), self.unit()]
    }

    /// A unit vector, all directions alike.
    pub fn direction(&mut self) -> [f64; 3] {
        loop {
            let p = self.point().map(|x| 2.0 * x - 1.0);
            let square = p[0] * p[0] + p[1] * p[1] + p[2] * p[2];
            if 1e-6 < square && square <= 1.0 {
                return p.map(|x| x / square.sqrt());
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::Random;

    #[test]
    fn the_stream_is_the_published_one() {
        let mut random = Random::new(1_234_567);
        assert_eq!(random.bits(), 6_457_827_717_110_365_317);
        assert_eq!(random.bits(), 3_203_168_211_198_807_973);
    }

    #[test]
    fn directions_are_unit_vectors() {
        let mut random = Random::new(5);
        for _ in 0..100 {
            let d = random.direction();
            assert!((d[0] * d[0] + d[1] * d[1] + d[2] * d[2] - 1.0).abs() < 1e-12);
            assert!((0.0..1.0).contains(&random.unit()) && random.below(3) < 3);
        }
    }
}

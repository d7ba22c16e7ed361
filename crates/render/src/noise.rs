//! Perlin's improved noise (Ken Perlin, "Improving Noise", SIGGRAPH 2002, with the published permutation), its
//! gradient, and the sums of octaves that SPEC 7 builds from it.

use dotray_geometry::Vec3;

/// The permutation of the reference implementation.
#[rustfmt::skip]
pub const PERMUTATION: [u8; 256] = [
    151, 160, 137, 91, 90, 15, 131, 13, 201, 95, 96, 53, 194, 233, 7, 225, 140, 36, 103, 30, 69, 142, 8, 99, 37, 240,
    21, 10, 23, 190, 6, 148, 247, 120, 234, 75, 0, 26, 197, 62, 94, 252, 219, 203, 117, 35, 11, 32, 57, 177, 33, 88,
    237, 149, 56, 87, 174, 20, 125, 136, 171, 168, 68, 175, 74, 165, 71, 134, 139, 48, 27, 166, 77, 146, 158, 231, 83,
    111, 229, 122, 60, 211, 133, 230, 220, 105, 92, 41, 55, 46, 245, 40, 244, 102, 143, 54, 65, 25, 63, 161, 1, 216,
    80, 73, 209, 76, 132, 187, 208, 89, 18, 169, 200, 196, 135, 130, 116, 188, 159, 86, 164, 100, 109, 198, 173, 186,
    3, 64, 52, 217, 226, 250, 124, 123, 5, 202, 38, 147, 118, 126, 255, 82, 85, 212, 207, 206, 59, 227, 47, 16, 58, 17,
    182, 189, 28, 42, 223, 183, 170, 213, 119, 248, 152, 2, 44, 154, 163, 70, 221, 153, 101, 155, 167, 43, 172, 9, 129,
    22, 39, 253, 19, 98, 108, 110, 79, 113, 224, 232, 178, 185, 112, 104, 218, 246, 97, 228, 251, 34, 242, 193, 238,
    210, 144, 12, 191, 179, 162, 241, 81, 51, 145, 235, 249, 14, 239, 107, 49, 192, 214, 31, 181, 199, 106, 157, 184,
    84, 204, 176, 115, 121, 50, 45, 127, 4, 150, 254, 138, 236, 205, 93, 222, 114, 67, 29, 24, 72, 243, 141, 128, 195,
    78, 66, 215, 61, 156, 180,
];

fn permuted(i: usize) -> usize {
    usize::from(PERMUTATION[i & 255])
}

/// The gradient that belongs to a hash: one of twelve edge directions, four of them twice.
fn gradient(hash: usize) -> Vec3 {
    #[rustfmt::skip]
    const GRADIENTS: [[f64; 3]; 16] = [
        [1.0, 1.0, 0.0], [-1.0, 1.0, 0.0], [1.0, -1.0, 0.0], [-1.0, -1.0, 0.0],
        [1.0, 0.0, 1.0], [-1.0, 0.0, 1.0], [1.0, 0.0, -1.0], [-1.0, 0.0, -1.0],
        [0.0, 1.0, 1.0], [0.0, -1.0, 1.0], [0.0, 1.0, -1.0], [0.0, -1.0, -1.0],
        [1.0, 1.0, 0.0], [0.0, -1.0, 1.0], [-1.0, 1.0, 0.0], [0.0, -1.0, -1.0],
    ];
    Vec3::from_array(GRADIENTS[hash & 15])
}

fn fade(t: f64) -> f64 {
    t * t * t * (t * (t * 6.0 - 15.0) + 10.0)
}

fn fade_slope(t: f64) -> f64 {
    30.0 * t * t * (t * (t - 2.0) + 1.0)
}

/// The lattice cell of a coordinate, modulo 256, and the place in it.
fn cell(q: f64) -> (usize, f64) {
    let floor = q.floor();
    ((floor - 256.0 * (floor / 256.0).floor()) as usize, q - floor)
}

/// The eight corners of the cell around `q` by their gradients, and the place in the cell.
fn corners(q: Vec3) -> ([Vec3; 8], Vec3) {
    let ((x, fx), (y, fy), (z, fz)) = (cell(q.x), cell(q.y), cell(q.z));
    let mut gradients = [Vec3::ZERO; 8];
    for (i, g) in gradients.iter_mut().enumerate() {
        let a = permuted(x + (i & 1)) + y + (i >> 1 & 1);
        *g = gradient(permuted(permuted(a) + z + (i >> 2)));
    }
    (gradients, Vec3::new(fx, fy, fz))
}

fn corner_offset(i: usize) -> Vec3 {
    Vec3::new((i & 1) as f64, (i >> 1 & 1) as f64, (i >> 2) as f64)
}

fn lerp(t: f64, a: f64, b: f64) -> f64 {
    a + t * (b - a)
}

/// N(q): 0 on the lattice, within -1 … 1. 0 where a coordinate is not finite.
pub fn noise(q: Vec3) -> f64 {
    if !q.is_finite() {
        return 0.0;
    }
    let (gradients, f) = corners(q);
    let value = |i: usize| gradients[i].dot(f - corner_offset(i));
    let (u, v, w) = (fade(f.x), fade(f.y), fade(f.z));
    let low = lerp(v, lerp(u, value(0), value(1)), lerp(u, value(2), value(3)));
    let high = lerp(v, lerp(u, value(4), value(5)), lerp(u, value(6), value(7)));
    lerp(w, low, high)
}

/// The exact gradient of [`noise`].
pub fn noise_gradient(q: Vec3) -> Vec3 {
    if !q.is_finite() {
        return Vec3::ZERO;
    }
    let (gradients, f) = corners(q);
    let (fades, slopes) =
        ([fade(f.x), fade(f.y), fade(f.z)], [fade_slope(f.x), fade_slope(f.y), fade_slope(f.z)]);
    let mut sum = Vec3::ZERO;
    for (i, g) in gradients.iter().enumerate() {
        // N = Σ weight_i · value_i with weight_i a product over the axes: the product rule, corner by corner.
        let value = g.dot(f - corner_offset(i));
        let along = |axis: usize| if i >> axis & 1 == 1 { fades[axis] } else { 1.0 - fades[axis] };
        let slope = |axis: usize| if i >> axis & 1 == 1 { slopes[axis] } else { -slopes[axis] };
        let (wx, wy, wz) = (along(0), along(1), along(2));
        sum += *g * (wx * wy * wz)
            + Vec3::new(slope(0) * wy * wz, wx * slope(1) * wz, wx * wy * slope(2)) * value;
    }
    sum
}

/// Σ N(2^k q) / 2^k over k < `octaves`.
pub fn fbm(q: Vec3, octaves: u32) -> f64 {
    let (mut sum, mut frequency) = (0.0, 1.0);
    for _ in 0..octaves {
        sum += noise(q * frequency) / frequency;
        frequency *= 2.0;
    }
    sum
}

/// Σ |N(2^k q)| / 2^k over k < `octaves`.
pub fn turbulence(q: Vec3, octaves: u32) -> f64 {
    let (mut sum, mut frequency) = (0.0, 1.0);
    for _ in 0..octaves {
        sum += noise(q * frequency).abs() / frequency;
        frequency *= 2.0;
    }
    sum
}

/// The gradient of [`fbm`]: the factors 2^k and 1 / 2^k cancel.
pub fn fbm_gradient(q: Vec3, octaves: u32) -> Vec3 {
    let (mut sum, mut frequency) = (Vec3::ZERO, 1.0);
    for _ in 0..octaves {
        sum += noise_gradient(q * frequency);
        frequency *= 2.0;
    }
    sum
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn permutation_is_one() {
        let mut seen = [false; 256];
        PERMUTATION.iter().for_each(|&p| seen[usize::from(p)] = true);
        assert!(seen.iter().all(|&s| s));
    }

    #[test]
    fn values_by_hand() {
        assert_eq!(noise(Vec3::new(3.0, -7.0, 12.0)), 0.0);
        // Cell (0, 0, 0), its centre: the mean of the eight gradients' values with offsets of ±½.
        let by_hand: f64 = (0..8)
            .map(|i| {
                let a = permuted(i & 1) + (i >> 1 & 1);
                gradient(permuted(permuted(a) + (i >> 2))).dot(Vec3::splat(0.5) - corner_offset(i))
            })
            .sum::<f64>()
            / 8.0;
        assert!((noise(Vec3::splat(0.5)) - by_hand).abs() < 1e-15);
    }

    #[test]
    fn gradient_is_the_slope() {
        for i in 0..500 {
            let x = f64::from(i) * 0.377 - 60.0;
            let q = Vec3::new(x, x * 0.713 + 1.1, 3.0 - x * 1.31);
            let h = 1e-6;
            let slope = |e: Vec3| (fbm(q + e * h, 3) - fbm(q - e * h, 3)) / (2.0 * h);
            let numeric = Vec3::new(slope(Vec3::X), slope(Vec3::Y), slope(Vec3::Z));
            assert!((fbm_gradient(q, 3) - numeric).length() < 1e-7, "{q}");
        }
    }

    #[test]
    fn period_and_extremes() {
        let q = Vec3::new(0.3, 0.6, 0.1);
        assert!((noise(q) - noise(q + Vec3::new(256.0, -512.0, 0.0))).abs() < 1e-12);
        for q in [Vec3::splat(f64::INFINITY), Vec3::splat(1e300), Vec3::splat(-1e18)] {
            assert!(noise(q).is_finite() && noise_gradient(q).is_finite());
        }
    }
}

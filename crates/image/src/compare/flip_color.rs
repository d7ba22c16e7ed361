//! The colour spaces of FLIP: display values, linear light, opponent channels (YCxCz),
//! and CIELAB under the Hunt effect.

/// CIE XYZ of the sRGB primaries (white at D65), as fractions of one denominator.
const XYZ_OF_RGB: [[f64; 3]; 3] = [
    [10_135_552.0 / 24_577_794.0, 8_788_810.0 / 24_577_794.0, 4_435_075.0 / 24_577_794.0],
    [2_613_072.0 / 12_288_897.0, 8_788_810.0 / 12_288_897.0, 887_015.0 / 12_288_897.0],
    [1_425_312.0 / 73_733_382.0, 8_788_810.0 / 73_733_382.0, 70_074_185.0 / 73_733_382.0],
];

/// The inverse of [`XYZ_OF_RGB`], rounded.
const RGB_OF_XYZ: [[f64; 3]; 3] = [
    [3.241_003_232_976_358, -1.537_398_969_488_785, -0.498_615_881_996_363],
    [-0.969_224_252_202_516, 1.875_929_983_695_176, 0.041_554_226_340_085],
    [0.055_639_419_851_975, -0.204_011_206_123_910, 1.057_148_977_187_533],
];

fn product(matrix: [[f64; 3]; 3], vector: [f64; 3]) -> [f64; 3] {
    matrix.map(|row| row.iter().zip(vector).map(|(weight, value)| weight * value).sum())
}

/// XYZ of linear light, as fractions of white.
fn relative_xyz(linear: [f64; 3]) -> [f64; 3] {
    let [x, y, z] = product(XYZ_OF_RGB, linear);
    let [white_x, white_y, white_z] = product(XYZ_OF_RGB, [1.0; 3]);
    [x / white_x, y / white_y, z / white_z]
}

fn linear_of_display(value: f64) -> f64 {
    if value <= 0.040_45 { value / 12.92 } else { libm::pow((value + 0.055) / 1.055, 2.4) }
}

/// Opponent channels of display values.
pub fn opponent_of_display(display: [f64; 3]) -> [f64; 3] {
    let [x, y, z] = relative_xyz(display.map(linear_of_display));
    [116.0 * y - 16.0, 500.0 * (x - y), 200.0 * (y - z)]
}

/// Hunt-adjusted CIELAB of opponent channels, brought back to what a screen can show.
pub fn lab_of_opponent([y, red_green, blue_yellow]: [f64; 3]) -> [f64; 3] {
    let y = (y + 16.0) / 116.0;
    let [white_x, white_y, white_z] = product(XYZ_OF_RGB, [1.0; 3]);
    let xyz = [(y + red_green / 500.0) * white_x, y * white_y, (y - blue_yellow / 200.0) * white_z];
    lab_of_linear(product(RGB_OF_XYZ, xyz).map(|value| value.clamp(0.0, 1.0)))
}

fn lab_of_linear(linear: [f64; 3]) -> [f64; 3] {
    const DELTA: f64 = 6.0 / 29.0;
    let curve = |value: f64| {
        if value > DELTA * DELTA * DELTA {
            libm::cbrt(value)
        } else {
            value / (3.0 * DELTA * DELTA) + 4.0 / 29.0
        }
    };
    let [x, y, z] = relative_xyz(linear).map(curve);
    let lightness = 116.0 * y - 16.0;
    // Hunt: colours of little light look less colourful.
    let adjusted = 0.01 * lightness;
    [lightness, adjusted * 500.0 * (x - y), adjusted * 200.0 * (y - z)]
}

/// The distance HyAB of two colours in CIELAB: that of lightness plus that of the other two.
pub fn distance([lightness, a, b]: [f64; 3], [lightness_2, a_2, b_2]: [f64; 3]) -> f64 {
    (lightness - lightness_2).abs() + libm::hypot(a - a_2, b - b_2)
}

/// The greatest distance of two colours of a screen: that of green and blue.
pub fn greatest_distance() -> f64 {
    distance(lab_of_linear([0.0, 1.0, 0.0]), lab_of_linear([0.0, 0.0, 1.0]))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_rounded_inverse_is_one() {
        for axis in [[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]] {
            let again = product(RGB_OF_XYZ, product(XYZ_OF_RGB, axis));
            assert!(again.iter().zip(axis).all(|(a, b)| (a - b).abs() < 1e-14), "{again:?}");
        }
    }

    #[test]
    fn white_is_white_and_red_is_red() {
        let near = |a: [f64; 3], b: [f64; 3]| a.iter().zip(b).all(|(a, b)| (a - b).abs() < 0.01);
        assert!(near(lab_of_opponent(opponent_of_display([1.0; 3])), [100.0, 0.0, 0.0]));
        assert!(near(lab_of_opponent(opponent_of_display([0.0; 3])), [0.0, 0.0, 0.0]));
        // CIELAB of sRGB red is 53.24, 80.09, 67.20; times 0.5324 by Hunt.
        let red = lab_of_opponent(opponent_of_display([1.0, 0.0, 0.0]));
        assert!(near(red, [53.24, 42.64, 35.78]), "{red:?}");
    }
}

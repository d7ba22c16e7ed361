//! Samples to whole numbers and back: the one place where values are clamped and rounded.

use std::sync::LazyLock;

/// round(255·clamp(c, 0, 1)); NaN becomes 0.
pub(crate) fn to_u8(sample: f32) -> u8 {
    rounded(sample, 255.0) as u8
}

/// round(65535·clamp(c, 0, 1)); NaN becomes 0.
#[cfg(any(test, feature = "formats"))]
pub(crate) fn to_u16(sample: f32) -> u16 {
    rounded(sample, 65535.0) as u16
}

/// round(max·clamp(c, 0, 1)) in the low bits.
fn rounded(sample: f32, max: f64) -> u64 {
    // Comparisons that NaN fails take it to 0.
    let above = if sample > 0.0 { sample } else { 0.0 };
    let clamped = if above < 1.0 { above } else { 1.0 };
    // The product is exact in double precision. Doubles of this size are whole numbers, so the sum is rounded to the
    // nearest one, which then stands in the low bits: unlike a conversion, this is vectorised. The only tie is 0.5,
    // where the even neighbour, 128 or 32768, is the upper one.
    const TWO_TO_52: f64 = 4_503_599_627_370_496.0;
    (f64::from(clamped) * max + TWO_TO_52).to_bits()
}

/// The sRGB curve of IEC 61966-2-1 from linear light to display values, clamped to 0…1; NaN becomes 0.
pub(crate) fn srgb_encoded(linear: f32) -> f64 {
    let linear = f64::from(linear);
    if linear.is_nan() || linear <= 0.0 {
        0.0
    } else if linear <= 0.003_130_8 {
        12.92 * linear
    } else if linear < 1.0 {
        1.055 * libm::pow(linear, 1.0 / 2.4) - 0.055
    } else {
        1.0
    }
}

/// `to_u8` of the sRGB-encoded sample.
pub(crate) fn to_srgb_u8(linear: f32) -> u8 {
    // The conversion cuts off, and takes NaN and what lies below 0 to 0; the product is exact.
    let part = ((linear * SRGB_PARTS as f32) as usize).min(SRGB_PARTS);
    let begin = SRGB_TABLES.codes.get(part).copied().unwrap_or_default();
    let steps = SRGB_TABLES.steps.get(usize::from(begin)..).unwrap_or_default();
    // At most 255 in all, because there are no more steps.
    begin + steps.iter().take_while(|&&step| linear >= step).count() as u8
}

/// `to_u16` of the sRGB-encoded sample.
#[cfg(any(test, feature = "formats"))]
pub(crate) fn to_srgb_u16(linear: f32) -> u16 {
    (srgb_encoded(linear) * 65535.0 + 0.5) as u16
}

fn srgb_u8_by_formula(linear: f32) -> u8 {
    (srgb_encoded(linear) * 255.0 + 0.5) as u8
}

/// Powers are slow, so bytes are looked up: a table has the byte at which each part of 0…1 begins, another where the
/// next bytes begin.
struct SrgbTables {
    /// Entry k is the byte of k / `SRGB_PARTS`.
    codes: Vec<u8>,
    /// Entry k is the least sample that becomes k + 1.
    steps: Vec<f32>,
}

/// A power of two, and so many that a part holds one or two bytes where the curve is steepest.
const SRGB_PARTS: usize = 4096;

static SRGB_TABLES: LazyLock<SrgbTables> = LazyLock::new(|| SrgbTables {
    codes: (0..=SRGB_PARTS).map(|part| srgb_u8_by_formula(part as f32 / SRGB_PARTS as f32)).collect(),
    steps: (1..=255).map(least_sample_of).collect(),
});

fn least_sample_of(code: u8) -> f32 {
    // The bits of floats from 0 to 1 grow as the floats do, so they can be bisected.
    let (mut below, mut reached) = (0, 1.0_f32.to_bits());
    while reached - below > 1 {
        let middle = below + (reached - below) / 2;
        if srgb_u8_by_formula(f32::from_bits(middle)) >= code {
            reached = middle;
        } else {
            below = middle;
        }
    }
    f32::from_bits(reached)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn rounding_is_to_nearest_with_clamping() {
        assert_eq!(to_u8(0.0), 0);
        assert_eq!(to_u8(0.5), 128);
        assert_eq!(to_u8(0.499_9 / 255.0), 0);
        assert_eq!(to_u8(0.500_1 / 255.0), 1);
        assert_eq!([to_u8(-3.0), to_u8(7.0), to_u8(f32::NAN), to_u8(f32::INFINITY)], [0, 255, 0, 255]);
        assert_eq!([to_u16(0.5), to_u16(2.0), to_u16(f32::NAN)], [32768, 65535, 0]);
        for code in 0..=255 {
            assert_eq!(to_u8(f32::from(code) / 255.0), code);
        }
        for code in 0..=65535 {
            assert_eq!(to_u16(f32::from(code) / 65535.0), code);
        }
    }

    #[test]
    fn rounding_equals_the_formula() {
        let by_formula = |sample: f32, max: f64| (f64::from(sample) * max).round() as u64;
        for step in 0..=1_000_000_u32 {
            let near_half = (step % 256) as f32 / 255.0 + 0.5 / 255.0;
            for sample in [step as f32 / 1e6, f32::from_bits(near_half.min(0.99).to_bits() - 4 + step % 8)] {
                assert_eq!(u64::from(to_u8(sample)), by_formula(sample, 255.0), "{sample}");
                assert_eq!(u64::from(to_u16(sample)), by_formula(sample, 65535.0), "{sample}");
            }
        }
    }

    #[test]
    fn srgb_search_equals_the_formula() {
        for step in 0..=200_000 {
            let linear = step as f32 / 180_000.0 - 0.05;
            assert_eq!(to_srgb_u8(linear), srgb_u8_by_formula(linear), "{linear}");
        }
        for &step in &SRGB_TABLES.steps {
            let before = f32::from_bits(step.to_bits() - 1);
            assert_eq!([to_srgb_u8(step), to_srgb_u8(before)], [step, before].map(srgb_u8_by_formula));
        }
        assert_eq!([to_srgb_u8(f32::NAN), to_srgb_u8(f32::INFINITY), to_srgb_u8(-1.0)], [0, 255, 0]);
        assert_eq!([to_srgb_u8(0.5), to_srgb_u8(0.001)], [188, 3]);
        assert_eq!([to_srgb_u16(0.0), to_srgb_u16(1.0), to_srgb_u16(0.214_041_14)], [0, 65535, 32768]);
    }
}

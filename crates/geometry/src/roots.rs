//! Roots of polynomials, without cancellation.

/// Below and above these sizes a square may leave the range of f64, so coefficients are scaled first.
const SAFE_SIZES: std::ops::Range<f64> = 1e-140..1e140;

/// The real roots of `a t² + 2 h t + c = 0` in ascending order, `a > 0`; `None` where there is none.
/// A double root comes twice.
///
/// Finite coefficients never give NaN. A root too large for f64 comes as an infinity, and where `a` is 0 (or
/// nothing beside the others) the one root of the line comes twice.
#[inline]
pub fn quadratic(a: f64, h: f64, c: f64) -> Option<(f64, f64)> {
    let size = a.abs().max(h.abs()).max(c.abs());
    if !SAFE_SIZES.contains(&size) {
        return scaled_quadratic(a, h, c, size);
    }
    solve(a, h, c)
}

/// [`quadratic`] where squares of the coefficients would overflow or vanish: roots do not change when all
/// three are divided by the same number.
#[cold]
fn scaled_quadratic(a: f64, h: f64, c: f64, size: f64) -> Option<(f64, f64)> {
    if size == 0.0 {
        return None;
    }
    // Two steps, for the reciprocal of a subnormal number is infinite.
    let half_size = size.sqrt();
    let scaled = |x: f64| x / half_size / half_size;
    solve(scaled(a), scaled(h), scaled(c))
}

#[inline]
fn solve(a: f64, h: f64, c: f64) -> Option<(f64, f64)> {
    let discriminant = h * h - a * c;
    if discriminant < 0.0 || (a == 0.0 && h == 0.0) {
        return None;
    }
    let (first, second) = from_discriminant(a, h, c, discriminant);
    if a == 0.0 {
        return Some((first, first));
    }
    Some(if first <= second { (first, second) } else { (second, first) })
}

/// The roots of `a t² + 2 h t + c = 0` where the caller has a better `discriminant` = h² − ac ≥ 0 than the
/// coefficients give: first the one of smaller magnitude, `c / q`, then `q / a`, infinite or NaN where a = 0.
///
/// `q = −(h ± √discriminant)` with the sign of `h`, so that nothing cancels.
#[inline]
pub fn from_discriminant(a: f64, h: f64, c: f64, discriminant: f64) -> (f64, f64) {
    let q = -(h + discriminant.sqrt().copysign(h));
    // q = 0 means h = 0 and a c = 0: a double root at 0.
    let small = if q == 0.0 { 0.0 } else { c / q };
    (small, q / a)
}

/// The root of a function that is monotone between `low` and `high`, where its signs differ. `function` gives value
/// and slope; `value_low` is its value at `low`. Newton's steps where they stay inside the bracket and shrink fast
/// enough, halving otherwise.
pub(crate) fn bracketed(function: impl Fn(f64) -> (f64, f64), low: f64, high: f64, value_low: f64) -> f64 {
    /// Halving alone reaches neighbouring numbers in fewer steps from brackets of size 1.
    const MOST_STEPS: usize = 120;
    let rises = value_low <= 0.0;
    let (mut low, mut high) = (low, high);
    let mut x = 0.5 * (low + high);
    let mut last_step = high - low;
    for _ in 0..MOST_STEPS {
        let (value, slope) = function(x);
        if value == 0.0 {
            return x;
        }
        if (value < 0.0) == rises {
            low = x
        } else {
            high = x
        }
        let newton = x - value / slope;
        let inside = low < newton && newton < high;
        let next = if inside && (newton - x).abs() <= 0.5 * last_step { newton } else { 0.5 * (low + high) };
        last_step = (next - x).abs();
        if last_step <= f64::EPSILON * x.abs() || next <= low || high <= next {
            return next.clamp(low, high);
        }
        x = next;
    }
    x
}

/// Where the quartic s⁴ + c₀ s³ + c₁ s² + c₂ s + c₃ has its turning points between `low` and `high`: up to three,
/// ascending, and how many. Each lies between neighbouring roots of the next derivative, down to the line.
pub(crate) fn quartic_turns(c: [f64; 4], low: f64, high: f64) -> ([f64; 3], usize) {
    let slope = |s: f64| ((4.0 * s + 3.0 * c[0]) * s + 2.0 * c[1]) * s + c[2];
    let bend = |s: f64| (12.0 * s + 6.0 * c[0]) * s + 2.0 * c[1];
    let mut ends = [low, low, high];
    if let Some((first, second)) = quadratic(12.0, 3.0 * c[0], 2.0 * c[1]) {
        ends = [first.clamp(low, high), second.clamp(low, high), high];
    }
    let (mut turns, mut count) = ([0.0; 3], 0);
    let (mut from, mut value_from) = (low, slope(low));
    for to in ends {
        let value = slope(to);
        if (value_from > 0.0) != (value > 0.0) {
            turns[count] = bracketed(|s| (slope(s), bend(s)), from, to, value_from);
            count += 1;
        }
        (from, value_from) = (to, value);
    }
    (turns, count)
}

#[cfg(test)]
mod tests {
    use proptest::prelude::*;

    use super::quadratic;
    use super::quartic_turns;

    #[test]
    fn turns_of_quartics_are_found() {
        // (s − 0.9)(s − 0.1)(s + 0.5) · 4 is the slope.
        let (turns, count) = quartic_turns([-4.0 / 3.0 * 0.5, -0.82, 0.18, 0.0], -1.0, 1.0);
        assert_eq!(count, 3);
        for (turn, expected) in turns.into_iter().zip([-0.5, 0.1, 0.9]) {
            assert!((turn - expected).abs() < 1e-15, "{turns:?}");
        }
        assert_eq!(quartic_turns([0.0; 4], -1.0, 1.0).1, 1);
        assert_eq!(quartic_turns([0.0, 1.0, 0.0, 0.0], -1.0, 1.0), ([0.0; 3], 1));
        assert_eq!(quartic_turns([0.0, 0.0, 9.0, 0.0], -1.0, 1.0).1, 0);
    }

    #[test]
    fn knows_simple_roots() {
        assert_eq!(quadratic(1.0, -1.5, 2.0), Some((1.0, 2.0)));
        assert_eq!(quadratic(1.0, 0.0, -4.0), Some((-2.0, 2.0)));
        assert_eq!(quadratic(1.0, 0.0, 4.0), None);
        assert_eq!(quadratic(2.0, -2.0, 2.0), Some((1.0, 1.0)));
        assert_eq!(quadratic(1.0, 2.0, 0.0), Some((-4.0, 0.0)));
        assert_eq!(quadratic(1.0, -2.0, 0.0), Some((0.0, 4.0)));
        assert_eq!(quadratic(3.0, 0.0, 0.0), Some((0.0, 0.0)));
        assert_eq!(quadratic(0.0, 2.0, -4.0), Some((1.0, 1.0)));
        assert_eq!(quadratic(0.0, 0.0, 1.0), None);
        assert_eq!(quadratic(0.0, 0.0, 0.0), None);
    }

    #[test]
    fn does_not_cancel() {
        // t² − 2e9 t + 1 = 0: the textbook formula loses the small root altogether.
        let (small, large) = quadratic(1.0, -1e9, 1.0).unwrap();
        assert_eq!((small, large), (5e-10, 2e9));
        let (small, large) = quadratic(1e-20, -0.5, 1.0).unwrap();
        assert_eq!((small, large), (1.0, 1e20));
    }

    #[test]
    fn survives_extreme_sizes() {
        let (low, high) = quadratic(1e200, 0.0, -1e200).unwrap();
        assert!((low + 1.0).abs() < 1e-15 && (high - 1.0).abs() < 1e-15);
        let (low, high) = quadratic(1e-200, -1.5e-200, 2e-200).unwrap();
        assert!((low - 1.0).abs() < 1e-14 && (high - 2.0).abs() < 1e-14);
        let (low, high) = quadratic(f64::MAX, 0.0, -f64::MAX).unwrap();
        assert!((low + 1.0).abs() < 1e-15 && (high - 1.0).abs() < 1e-15);
        let (low, high) = quadratic(5e-324, -f64::MAX, 1.0).unwrap();
        assert!(low >= 0.0 && high >= low);
    }

    proptest! {
        #![proptest_config(ProptestConfig::with_cases(2000))]

        #[test]
        fn finds_the_roots_it_was_made_of(a in 1e-3..1e3f64, low in -1e3..1e3f64, gap in 0.0..1e3f64) {
            let high = low + gap;
            let (h, c) = (-0.5 * a * (low + high), a * low * high);
            if let Some((first, second)) = quadratic(a, h, c) {
                prop_assert!(first <= second);
                for root in [first, second] {
                    let size = a * root * root + (2.0 * h * root).abs() + c.abs();
                    prop_assert!((a * root * root + 2.0 * h * root + c).abs() <= 1e-14 * size);
                }
            } else {
                prop_assert!(gap <= 1e-6 * (1.0 + low.abs()));
            }
        }

        #[test]
        fn never_gives_nan(a in 0.0..f64::MAX, h in any::<f64>(), c in any::<f64>(), shrink in 0..2000i32) {
            prop_assume!(h.is_finite() && c.is_finite());
            if let Some((low, high)) = quadratic(libm::scalbn(a, -shrink), h, c) {
                prop_assert!(low <= high);
            }
        }
    }
}

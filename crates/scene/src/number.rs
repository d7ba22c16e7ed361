//! Numbers as text: as C's `%g` prints them, and as the shortest text that reads back to the same number.

use std::fmt;

/// Displays a number as C's `%g` does: six significant digits without trailing zeros.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct General(pub f64);

impl fmt::Display for General {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        const DIGITS: i32 = 6;
        let value = self.0;
        if !value.is_finite() {
            let sign = if value.is_sign_negative() { "-" } else { "" };
            return f.write_str(&if value.is_nan() { "nan".to_owned() } else { format!("{sign}inf") });
        }
        // The exponent is that of the rounded number: 999999.5 counts as 1e+06.
        let scientific = format!("{value:.5e}");
        let (mantissa, exponent) = scientific.split_once('e').unwrap_or((&scientific, "0"));
        let exponent: i32 = exponent.parse().unwrap_or(0);
        if (-4..DIGITS).contains(&exponent) {
            let decimals = usize::try_from(DIGITS - 1 - exponent).unwrap_or(0);
            return f.write_str(trimmed(&format!("{value:.decimals$}")));
        }
        let sign = if exponent < 0 { '-' } else { '+' };
        write!(f, "{}e{sign}{:02}", trimmed(mantissa), exponent.abs())
    }
}

/// Without trailing zeros after a decimal point, nor a bare point.
fn trimmed(digits: &str) -> &str {
    if digits.contains('.') { digits.trim_end_matches('0').trim_end_matches('.') } else { digits }
}

/// Displays a finite number with the fewest digits that read back to the same number; with an exponent where
/// plain digits would be long.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Shortest(pub f64);

impl fmt::Display for Shortest {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let magnitude = self.0.abs();
        let plain = magnitude == 0.0 || (1e-5..1e16).contains(&magnitude);
        if plain { write!(f, "{}", self.0) } else { write!(f, "{:e}", self.0) }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    #[test]
    fn general_is_what_c_prints() {
        for (value, expected) in [
            (0.0, "0"),
            (-0.0, "-0"),
            (1.0, "1"),
            (-3.5, "-3.5"),
            (0.1, "0.1"),
            (0.523, "0.523"),
            (1.0 / 3.0, "0.333333"),
            (-2.0 / 3.0, "-0.666667"),
            (100.0, "100"),
            (123456.0, "123456"),
            (123456.7, "123457"),
            (999999.4, "999999"),
            (999999.5, "1e+06"),
            (1e6, "1e+06"),
            (1234567.0, "1.23457e+06"),
            (1000005.0, "1e+06"),
            (1000015.0, "1.00002e+06"),
            (0.0001, "0.0001"),
            (0.00012345678, "0.000123457"),
            (0.00009999996, "0.0001"),
            (0.00009999994, "9.99999e-05"),
            (0.00001, "1e-05"),
            (-1.5e-7, "-1.5e-07"),
            (1e100, "1e+100"),
            (5e-324, "4.94066e-324"),
            (f64::MAX, "1.79769e+308"),
            (f64::INFINITY, "inf"),
            (f64::NEG_INFINITY, "-inf"),
        ] {
            assert_eq!(General(value).to_string(), expected, "{value:?}");
        }
    }

    #[test]
    fn shortest_is_short() {
        for (value, expected) in [
            (0.0, "0"),
            (-0.0, "-0"),
            (1.0, "1"),
            (0.1, "0.1"),
            (-12.25, "-12.25"),
            (1e15, "1000000000000000"),
            (1e16, "1e16"),
            (1e300, "1e300"),
            (1.5e-7, "1.5e-7"),
            (0.00001, "0.00001"),
        ] {
            assert_eq!(Shortest(value).to_string(), expected);
        }
    }

    proptest! {
        #[test]
        fn shortest_reads_back(value in prop::num::f64::NORMAL | prop::num::f64::SUBNORMAL | prop::num::f64::ZERO) {
            let text = Shortest(value).to_string();
            prop_assert_eq!(text.parse::<f64>().unwrap().to_bits(), value.to_bits());
            prop_assert!(text.len() <= 24);
        }
    }
}

//! Means and medians.

/// The middle value, or the mean of the two middle ones; `None` of nothing.
pub fn median(values: &[f64]) -> Option<f64> {
    let mut sorted = values.to_vec();
    sorted.sort_by(f64::total_cmp);
    let middle = sorted.len() / 2;
    let upper = *sorted.get(middle)?;
    if sorted.len() % 2 == 1 { Some(upper) } else { Some((sorted[middle - 1] + upper) * 0.5) }
}

/// The geometric mean; `None` of nothing.
pub fn geometric_mean(values: &[f64]) -> Option<f64> {
    let logarithms: f64 = values.iter().map(|&value| libm::log(value)).sum();
    (!values.is_empty()).then(|| libm::exp(logarithms / values.len() as f64))
}

/// A number with three digits that count, as tables show it.
pub fn short(value: f64) -> String {
    let size = value.abs();
    let decimals = if size >= 99.95 {
        0
    } else if size >= 9.995 {
        1
    } else if size >= 0.9995 || size == 0.0 {
        2
    } else {
        3
    };
    format!("{value:.decimals$}")
}

#[cfg(test)]
mod tests {
    use super::geometric_mean;
    use super::median;
    use super::short;

    #[test]
    fn means_and_medians() {
        assert_eq!(median(&[]), None);
        assert_eq!(median(&[3.0, 1.0, 2.0]), Some(2.0));
        assert_eq!(median(&[4.0, 1.0, 2.0, 9.0]), Some(3.0));
        assert_eq!(geometric_mean(&[]), None);
        assert!((geometric_mean(&[1.0, 4.0]).unwrap_or_default() - 2.0).abs() < 1e-12);
    }

    #[test]
    fn numbers_are_cut_to_what_counts() {
        assert_eq!([123.4, 12.34, 1.234, 0.1234].map(short), ["123", "12.3", "1.23", "0.123"]);
        assert_eq!([9.999, 0.0].map(short), ["10.0", "0.00"]);
    }
}

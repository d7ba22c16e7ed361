//! Roots of polynomials, without cancellation.

/// The real roots of `a t² + 2 h t + c = 0` in ascending order, `a > 0`; `None` where there is none.
/// A double root comes twice.
#[inline]
pub fn quadratic(a: f64, h: f64, c: f64) -> Option<(f64, f64)> {
    let _ = (a, h, c);
    todo!()
}

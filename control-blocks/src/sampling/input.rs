//! What may be taken for a measurement.

/// Whether an input is finite and not absurd.
pub fn believable(value: f64, limit: f64) -> bool {
    value.is_finite() && value.abs() <= limit
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn neither_nan_nor_infinity_nor_the_absurd() {
        for (value, expected) in [(-2.0, true), (2.0, true), (2.1, false), (f64::NAN, false), (f64::INFINITY, false)] {
            assert_eq!(believable(value, 2.0), expected, "{value}");
        }
        assert!(!believable(f64::INFINITY, f64::INFINITY));
    }
}

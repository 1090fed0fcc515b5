//! A value that moves towards another with a limited slope.
//!
//! With the slope s and the sample period T_s a value moves by at most s T_s in a sample. Two forms are equal except for the
//! rounding of the last step: [`ramp`] adds the limited difference, [`ramp_between`] limits the target, arrives on it
//! exactly and may fall faster than it rises.

/// The next value towards `target`, at most `change` (not negative) from `value`.
///
/// # Panics
/// If `change` is negative or NaN.
pub fn ramp(value: f64, target: f64, change: f64) -> f64 {
    value + (target - value).clamp(-change, change)
}

/// The next value towards `target`, at most `fall` below and at most `rise` above `value`; neither is negative.
///
/// # Panics
/// If the lower limit is above the upper one, or one is NaN.
pub fn ramp_between(value: f64, target: f64, fall: f64, rise: f64) -> f64 {
    target.clamp(value - fall, value + rise)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn takes_distance_over_slope_and_stays_at_the_target() {
        // 0.75 in steps of 1/64: 48 samples, exact in binary
        for (from, to) in [(0.25, 1.0), (1.0, 0.25)] {
            let (mut plain, mut between) = (from, from);
            for k in 1..=60 {
                plain = ramp(plain, to, 1.0 / 64.0);
                between = ramp_between(between, to, 1.0 / 64.0, 1.0 / 64.0);
                let fraction = (f64::from(k) / 48.0).min(1.0);
                assert_eq!(
                    (plain, between),
                    (from + (to - from) * fraction, from + (to - from) * fraction),
                    "sample {k}"
                );
            }
        }
    }

    #[test]
    fn falls_faster_than_it_rises() {
        assert_eq!(ramp_between(1.0, 9.0, 0.5, 0.25), 1.25);
        assert_eq!(ramp_between(1.0, -9.0, 0.5, 0.25), 0.5);
        assert_eq!(ramp_between(1.0, 1.125, 0.5, 0.25), 1.125);
    }

    #[test]
    fn only_the_limited_target_is_reached_without_rounding() {
        let (value, target) = (1e6, 0.1);
        assert_eq!(ramp_between(value, target, 1e7, 1e7), target);
        assert_ne!(ramp(value, target, 1e7), target);
        assert!((ramp(value, target, 1e7) - target).abs() < 1e-9);
    }
}

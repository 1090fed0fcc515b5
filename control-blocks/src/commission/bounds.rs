//! Commissioning run: range of machines, required certainty, and duration.

use std::ops::RangeInclusive;

use crate::parameters::error::ParameterError;
use crate::parameters::parameter::Parameter;
use crate::sampling::sent_commands::DELAY_MAX;

/// Maximum ratio of an actual gain, stiffness or bandwidth to the configured one; its reciprocal is the minimum (default).
pub const RATIO_MAX: f64 = 2.0;
/// Maximum additional delay over the configured one, samples (default; a filter in a drive).
pub const DELAY_SPREAD: i32 = 2;
/// Significance in standard deviations below which a measured value is not used.
pub const SIGNIFICANT: f64 = 3.0;
/// Reserve of the duration over that of the motions: factor, and time, s.
const TIME_SPARE: (f64, f64) = (1.25, 1.0);

/// Whether a value is within a factor of the configured one.
pub fn within_factor(value: f64, configured: f64, factor: f64) -> bool {
    value * factor >= configured && value <= factor * configured
}

/// Whether the standard deviation of a value is at most this fraction of it.
pub fn is_certain(value: f64, deviation: f64, ratio: f64) -> bool {
    deviation <= ratio * value.abs()
}

/// A value if it is significant, otherwise the configured one.
pub fn significant_or(value: f64, deviation: f64, configured: f64) -> f64 {
    if value > SIGNIFICANT * deviation && value > 0.0 { value } else { configured }
}

/// The value of a parameter, or if that is 0 the one derived from others.
pub fn configured_or(configured: f64, derived: impl FnOnce() -> f64) -> f64 {
    if configured > 0.0 { configured } else { derived() }
}

/// A delay in whole samples; a value that is not finite gives a delay that no machine has.
pub fn whole_delay(samples: f64) -> i32 {
    if samples.is_nan() { i32::MIN } else { samples.round() as i32 }
}

/// Tolerated delays (samples): from 0 to `DELAY_SPREAD` more than configured, as far as commands are stored.
pub fn tolerated_delays(configured: i32) -> RangeInclusive<i32> {
    0..=(configured + DELAY_SPREAD).min(DELAY_MAX as i32)
}

/// Maximum duration of a commissioning run (s): the configured one, or the time of its motions with a reserve.
pub fn commission_time(configured: f64, motions: impl FnOnce() -> f64) -> f64 {
    configured_or(configured, || TIME_SPARE.0 * motions() + TIME_SPARE.1)
}

/// Checks that the parameter `expert.commission.time` is at least the time (s) of the motions.
///
/// # Errors
/// If it does not.
pub fn check_commission_time(configured: f64, motions: impl FnOnce() -> f64) -> Result<(), ParameterError> {
    if configured == 0.0 {
        return Ok(());
    }
    let (minimum, hint) = (motions(), "otherwise every commissioning run raises `NoProgress`");
    Parameter::new("expert.commission.time", configured, "s", hint)
        .must_be(configured >= minimum, || format!("`0`, or at least `{minimum} s`, the time of its motions"))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_value_is_within_the_factor_of_the_configured_one_on_both_sides() {
        let configured = |value: f64| within_factor(value, 20.0, RATIO_MAX);
        assert_eq!([9.99, 10.0, 20.0, 40.0, 40.01].map(configured), [false, true, true, true, false]);
        assert!(!configured(-20.0) && !configured(f64::NAN) && within_factor(0.0, 0.0, 2.0));
    }

    #[test]
    fn a_value_counts_where_it_is_certain_and_what_is_no_number_never_does() {
        assert!(is_certain(-10.0, 0.2, 0.02) && !is_certain(10.0, 0.21, 0.02) && is_certain(0.0, 0.0, 0.02));
        assert!(!is_certain(f64::NAN, 0.0, 0.02) && !is_certain(1.0, f64::NAN, 0.02));
        assert_eq!([3.1, 3.0, -3.1, f64::NAN].map(|value| significant_or(value, 1.0, 7.0)), [3.1, 7.0, 7.0, 7.0]);
        assert_eq!([significant_or(0.0, 0.0, 7.0), significant_or(1e-9, 0.0, 7.0)], [7.0, 1e-9]);
    }

    #[test]
    fn a_delay_is_tolerated_by_its_whole_samples() {
        let tolerated = |configured: i32, samples: f64| tolerated_delays(configured).contains(&whole_delay(samples));
        assert_eq!(
            [-0.51, -0.5, -0.49, 3.49, 3.5].map(|samples| tolerated(1, samples)),
            [false, false, true, true, false]
        );
        assert!(!tolerated(1, f64::NAN) && !tolerated(1, f64::INFINITY));
        assert_eq!((whole_delay(1.7), tolerated_delays(DELAY_MAX as i32 - 1)), (2, 0..=DELAY_MAX as i32));
    }

    #[test]
    fn zero_is_derived_and_the_motions_have_a_quarter_and_a_second_to_spare() {
        assert_eq!((configured_or(0.0, || 3.0), configured_or(2.0, || 3.0)), (3.0, 2.0));
        assert_eq!((commission_time(0.0, || 8.0), commission_time(9.0, || 8.0)), (11.0, 9.0));
        let check = |configured: f64| check_commission_time(configured, || 8.0);
        assert_eq!([check(0.0), check(8.0)], [Ok(()), Ok(())]);
        let message = check(7.5).unwrap_err().to_string();
        assert!(
            message.starts_with("parameter `expert.commission.time` is `7.5 s`, must be `0`, or at least `8 s`"),
            "{message}"
        );
    }
}

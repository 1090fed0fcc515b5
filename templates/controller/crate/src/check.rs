//! Checks of parameters against each other; single ranges are in `interface.rs`.

use control_blocks::{Parameter, ParameterError, check_all};

use crate::interface::Parameters;

/// Phase that the delays may cost at the bandwidth of the velocity loop, rad.
const PHASE_MAX: f64 = 0.5;

/// Checks all combinations; the first that fails is the error.
///
/// # Errors
/// When a parameter does not fit the others.
pub fn check(p: &Parameters) -> Result<(), ParameterError> {
    check_all(p, &[bandwidth, integral, band])
}

fn bandwidth(p: &Parameters) -> Result<(), ParameterError> {
    // half a sample of hold, half a sample of the difference, and the delay; the velocity loop crosses at 2 zeta w
    let delay = (1.0 + f64::from(p.io_delay)) * p.sample_period;
    let limit = PHASE_MAX / (2.0 * p.servo.damping * delay);
    Parameter::new("servo.bandwidth", p.servo.bandwidth, "rad/s", "lower it, or shorten `sample_period`")
        .at_most(limit, format!("with a delay of `{delay} s`"))
}

fn integral(p: &Parameters) -> Result<(), ParameterError> {
    // by Routh the loop is stable below 2 zeta w
    let limit = 0.5 * p.servo.damping * p.servo.bandwidth;
    Parameter::new("servo.integral_bandwidth", p.servo.integral_bandwidth, "rad/s", "a faster integral oscillates")
        .at_most(limit, "half of `servo.damping` times `servo.bandwidth`")
}

fn band(p: &Parameters) -> Result<(), ParameterError> {
    Parameter::new("settle.band", p.settle.band, "m", "narrow the band")
        .less_than(p.limits.following_error, "the `limits.following_error`")
}

#[cfg(test)]
mod tests {
    use super::*;
    use control_blocks::{Refusal, assert_refusals};

    const REFUSALS: &[Refusal<Parameters>] = &[
        (|p| p.io_delay = 4, "servo.bandwidth", "`94.2", "`50 rad/s`"),
        (|p| p.servo.integral_bandwidth = 50.0, "servo.integral_bandwidth", "`50 rad/s`", "`47.12"),
        (|p| p.settle.band = 1e-3, "settle.band", "`0.001 m`", "`limits.following_error`"),
    ];

    #[test]
    fn presets_fit_and_each_error_names_parameter_value_and_limit() {
        assert_refusals(check, &[Parameters::START, Parameters::PAPER], REFUSALS);
    }
}

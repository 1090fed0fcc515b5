//! Checks of parameters against each other; single ranges are in `interface.rs`.

use control_blocks::{Check, Parameter, ParameterError, check_all};

use crate::interface::Parameters;

/// Phase that the delays may cost at the bandwidth of the velocity loop, rad.
const PHASE_MAX: f64 = 0.5;

/// Checks all combinations; the first that fails is the error.
///
/// # Errors
/// When a parameter does not fit the others.
pub fn check(p: &Parameters) -> Result<(), ParameterError> {
    const CHECKS: [Check<Parameters>; 3] = [bandwidth, integral, band];
    check_all(p, &CHECKS)
}

fn bandwidth(p: &Parameters) -> Result<(), ParameterError> {
    // half a sample of hold, half a sample of the difference, and the delay; the velocity loop crosses at 2 zeta w
    let delay = (1.0 + f64::from(p.io_delay)) * p.sample_period;
    let most = PHASE_MAX / (2.0 * p.servo.damping * delay);
    let bandwidth = Parameter::new("servo.bandwidth", p.servo.bandwidth, "rad/s", "lower it, or shorten `sample_period`");
    bandwidth.at_most(most, format!("with a delay of `{delay} s`"))
}

fn integral(p: &Parameters) -> Result<(), ParameterError> {
    // by Routh the loop is stable below 2 zeta w
    let most = 0.5 * p.servo.damping * p.servo.bandwidth;
    let integral =
        Parameter::new("servo.integral_bandwidth", p.servo.integral_bandwidth, "rad/s", "a faster integral swings");
    integral.at_most(most, "half of `servo.damping` times `servo.bandwidth`")
}

fn band(p: &Parameters) -> Result<(), ParameterError> {
    let band = Parameter::new("settle.band", p.settle.band, "m", "narrow the band");
    band.less_than(p.limits.following_error, "the `limits.following_error`")
}

#[cfg(test)]
mod tests {
    use super::*;
    use control_blocks::refusal;

    fn error(change: impl FnOnce(&mut Parameters)) -> String {
        refusal(Parameters::START, change, check)
    }

    #[test]
    fn defaults_and_paper_mode_fit() {
        check(&Parameters::START).unwrap();
        check(&Parameters::PAPER).unwrap();
    }

    #[test]
    fn each_error_names_parameter_value_limit_and_hint() {
        let cases = [
            (error(|p| p.io_delay = 4), "servo.bandwidth", "`50 rad/s`"),
            (error(|p| p.servo.integral_bandwidth = 50.0), "servo.integral_bandwidth", "`47.12"),
            (error(|p| p.settle.band = 1e-3), "settle.band", "`0.001 m`"),
        ];
        for (message, name, limit) in cases {
            assert!(message.starts_with(&format!("parameter `{name}` is ")), "{message}");
            assert!(message.contains(limit) && message.contains("hint:"), "{message}");
        }
    }
}

//! Checks of parameters against each other; single ranges are in `interface.rs`.

use control_blocks::{Check, ParameterError, check_all, require};

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
    require(p.servo.bandwidth <= most, || ParameterError {
        name: "servo.bandwidth",
        value: format!("{} rad/s", p.servo.bandwidth),
        limit: format!("at most `{most} rad/s` with a delay of `{delay} s`"),
        hint: "lower it, or shorten `sample_period`",
    })
}

fn integral(p: &Parameters) -> Result<(), ParameterError> {
    // by Routh the loop is stable below 2 zeta w
    let most = 0.5 * p.servo.damping * p.servo.bandwidth;
    require(p.servo.integral_bandwidth <= most, || ParameterError {
        name: "servo.integral_bandwidth",
        value: format!("{} rad/s", p.servo.integral_bandwidth),
        limit: format!("at most `{most} rad/s`, half of `servo.damping` times `servo.bandwidth`"),
        hint: "a faster integral swings",
    })
}

fn band(p: &Parameters) -> Result<(), ParameterError> {
    require(p.settle.band < p.limits.following_error, || ParameterError {
        name: "settle.band",
        value: format!("{} m", p.settle.band),
        limit: format!("less than `{} m`, the `limits.following_error`", p.limits.following_error),
        hint: "narrow the band",
    })
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

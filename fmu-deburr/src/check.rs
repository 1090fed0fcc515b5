//! Checks of parameters against each other; single ranges are in the variable table of the FMU.

use control_blocks::{ParameterError, require};

use crate::parameters::Parameters;
use crate::path::Path;
use crate::run::PREVIEW_MAX;

type Check = fn(&Parameters) -> Result<(), ParameterError>;

/// Checks all combinations; the first that fails is the error.
pub fn check(p: &Parameters, path: &Path) -> Result<(), ParameterError> {
    const CHECKS: [Check; 5] = [travel, cutoff, lead, lead_in, preview];
    CHECKS.iter().try_for_each(|check| check(p))?;
    speed_min(p, path)
}

fn travel(p: &Parameters) -> Result<(), ParameterError> {
    const NAMES: [&str; 6] =
        ["axis1.maximum", "axis2.maximum", "axis3.maximum", "axis4.maximum", "axis5.maximum", "axis6.maximum"];
    NAMES.iter().zip(p.axes()).try_for_each(|(name, axis)| {
        require(axis.maximum > axis.minimum, || ParameterError {
            name,
            value: axis.maximum.to_string(),
            limit: format!("above the minimum of this axis, `{}`", axis.minimum),
            hint: "the travel goes from the minimum to the maximum",
        })
    })
}

fn cutoff(p: &Parameters) -> Result<(), ParameterError> {
    let most = 0.45 / p.sample_period;
    require(p.learn.cutoff <= most, || ParameterError {
        name: "learn.cutoff",
        value: format!("{} Hz", p.learn.cutoff),
        limit: format!("at most `{most} Hz`, 0.45 of the sampling rate"),
        hint: "lower it, or shorten `sample_period`",
    })
}

fn lead(p: &Parameters) -> Result<(), ParameterError> {
    let delay = p.servo.io_delay;
    require(p.learn.lead >= -delay, || ParameterError {
        name: "learn.lead",
        value: p.learn.lead.to_string(),
        limit: format!("at least `{}`, minus `servo.io_delay`", -delay),
        hint: "the error is read ahead by both together",
    })
}

fn lead_in(p: &Parameters) -> Result<(), ParameterError> {
    let least = p.shift();
    require(p.learn.lead_in as usize >= least, || ParameterError {
        name: "learn.lead_in",
        value: p.learn.lead_in.to_string(),
        limit: format!("at least `{least}`, `learn.lead` and `servo.io_delay` together"),
        hint: "the compensation begins so many samples before the motion",
    })
}

fn preview(p: &Parameters) -> Result<(), ParameterError> {
    let delay = f64::from(p.servo.io_delay) * p.sample_period;
    let (low, high) = (-delay, PREVIEW_MAX as f64 * p.sample_period - delay);
    require(p.lookup.preview >= low && p.lookup.preview <= high, || ParameterError {
        name: "lookup.preview",
        value: format!("{} s", p.lookup.preview),
        limit: format!("`{low}` to `{high} s`: `0` to `{PREVIEW_MAX}` samples together with `servo.io_delay`"),
        hint: "take the lag of the velocity loop, twice its damping ratio over its natural frequency",
    })
}

fn speed_min(p: &Parameters, path: &Path) -> Result<(), ParameterError> {
    require(p.load.speed_min <= path.speed, || ParameterError {
        name: "load.speed_min",
        value: format!("{} m/s", p.load.speed_min),
        limit: format!("at most the taught speed, `{} m/s`", path.speed),
        hint: "the feed is regulated between both",
    })
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::pattern::tests::straight;

    fn error(change: impl FnOnce(&mut Parameters)) -> String {
        let mut p = Parameters::DEFAULT;
        change(&mut p);
        check(&p, &straight(0.1)).unwrap_err().to_string()
    }

    #[test]
    fn defaults_and_paper_mode_fit() {
        check(&Parameters::DEFAULT, &straight(0.1)).unwrap();
        check(&Parameters::PAPER, &straight(0.1)).unwrap();
    }

    #[test]
    fn each_error_names_parameter_value_and_limit() {
        let cases = [
            (error(|p| p.axis3.maximum = 0.05), "axis3.maximum", "`0.05`", "`0.1`"),
            (error(|p| p.learn.cutoff = 50.0), "learn.cutoff", "`50 Hz`", "`45 Hz`"),
            (error(|p| p.learn.lead = -3), "learn.lead", "`-3`", "at least `-1`"),
            (error(|p| (p.learn.lead, p.servo.io_delay) = (8, 6)), "learn.lead_in", "`10`", "at least `14`"),
            (error(|p| p.lookup.preview = 0.08), "lookup.preview", "`0.08 s`", "`-0.01` to `0.07 s`"),
            (error(|p| p.load.speed_min = 0.2), "load.speed_min", "`0.2 m/s`", "`0.1 m/s`"),
        ];
        for (message, name, value, limit) in cases {
            assert!(message.starts_with(&format!("parameter `{name}` is {value}")), "{message}");
            assert!(message.contains(limit) && message.contains("hint:"), "{message}");
        }
    }
}

//! Checks of parameters against each other; single ranges are in the variable table of the FMU.

use control_blocks::{Check, ParameterError, check_all, require};

use crate::interface::Parameters;
use crate::limits::look_ahead;

/// Checks all combinations; the first that fails is the error.
///
/// # Errors
/// When a parameter does not fit the others.
pub fn check(p: &Parameters) -> Result<(), ParameterError> {
    const CHECKS: [Check<Parameters>; 14] = [
        park,
        gap,
        stroke,
        approach_velocity,
        stopping,
        follow_delay,
        follow_braking,
        dead_zone,
        settle_band,
        control_rate,
        collect_rate,
        model_rate,
        push_velocities,
        push_maximum,
    ];
    check_all(p, &CHECKS)
}

fn stroke(p: &Parameters) -> Result<(), ParameterError> {
    let least = p.probe.at_pusher + p.follow.gap;
    require(p.probe.stroke >= least, || ParameterError {
        name: "probe.stroke",
        value: format!("{} m", p.probe.stroke),
        limit: format!("at least `{least} m`, `probe.at_pusher` with one `follow.gap` of reserve"),
        hint: "let the probe stand out less before the pusher",
    })
}

fn park(p: &Parameters) -> Result<(), ParameterError> {
    let most = (p.park.probe - p.probe.contact).min(p.probe.at_pusher - p.park.probe);
    require(p.park.dead_zone < most, || ParameterError {
        name: "park.dead_zone",
        value: format!("{} m", p.park.dead_zone),
        limit: format!("less than `{most} m`, from `park.probe` to `probe.contact` and to `probe.at_pusher`"),
        hint: "or a ring that turns loses the probe or meets the pusher",
    })
}

fn gap(p: &Parameters) -> Result<(), ParameterError> {
    let most = p.probe.at_pusher - 2.0 * p.probe.contact;
    require(p.follow.gap <= most, || ParameterError {
        name: "follow.gap",
        value: format!("{} m", p.follow.gap),
        limit: format!("at most `{most} m`, `probe.at_pusher` less twice `probe.contact`"),
        hint: "the probe must touch while the slide follows",
    })
}

fn approach_velocity(p: &Parameters) -> Result<(), ParameterError> {
    require(p.approach.velocity <= p.slide.velocity_max, || ParameterError {
        name: "approach.velocity",
        value: format!("{} m/s", p.approach.velocity),
        limit: format!("at most `{} m/s`, the `slide.velocity_max`", p.slide.velocity_max),
        hint: "approach slower",
    })
}

fn stopping(p: &Parameters) -> Result<(), ParameterError> {
    let (needed, there) = (look_ahead(p), p.probe.at_pusher - p.probe.contact);
    require(needed <= there, || ParameterError {
        name: "approach.velocity",
        value: format!("{} m/s", p.approach.velocity),
        limit: format!("so slow that the slide stops in `{there} m`; it needs `{needed} m` (eq. 9)"),
        hint: "approach slower, expect a smaller `ring.eccentricity_max`, or let the probe stand out more",
    })
}

fn follow_delay(p: &Parameters) -> Result<(), ParameterError> {
    let most = 0.25 * p.rates.control;
    require(p.follow.gain <= most, || ParameterError {
        name: "follow.gain",
        value: format!("{} 1/s", p.follow.gain),
        limit: format!("at most `{most} 1/s`, a quarter of `rates.control`"),
        hint: "with one beat of delay a larger gain swings",
    })
}

fn follow_braking(p: &Parameters) -> Result<(), ParameterError> {
    let most = p.slide.acceleration_max / p.slide.velocity_max;
    require(p.follow.gain <= most, || ParameterError {
        name: "follow.gain",
        value: format!("{} 1/s", p.follow.gain),
        limit: format!("at most `{most} 1/s`, `slide.acceleration_max` over `slide.velocity_max`"),
        hint: "a larger gain cannot brake from the approach before the pusher touches",
    })
}

fn dead_zone(p: &Parameters) -> Result<(), ParameterError> {
    require(p.follow.dead_zone < p.follow.gap, || ParameterError {
        name: "follow.dead_zone",
        value: format!("{} m", p.follow.dead_zone),
        limit: format!("less than `{} m`, the `follow.gap`", p.follow.gap),
        hint: "or the pusher touches while the slide follows",
    })
}

fn settle_band(p: &Parameters) -> Result<(), ParameterError> {
    require(p.follow.settle_band > p.follow.dead_zone, || ParameterError {
        name: "follow.settle_band",
        value: format!("{} m", p.follow.settle_band),
        limit: format!("more than `{} m`, the `follow.dead_zone`", p.follow.dead_zone),
        hint: "or following never settles",
    })
}

fn control_rate(p: &Parameters) -> Result<(), ParameterError> {
    rate("rates.control", p.rates.control, p.sample_period)
}

fn collect_rate(p: &Parameters) -> Result<(), ParameterError> {
    rate("rates.collect", p.rates.collect, p.sample_period)
}

fn model_rate(p: &Parameters) -> Result<(), ParameterError> {
    rate("rates.model", p.rates.model, p.sample_period)
}

fn rate(name: &'static str, value: f64, sample_period: f64) -> Result<(), ParameterError> {
    let most = 1.0 / sample_period;
    require(value <= most * (1.0 + 1e-9), || ParameterError {
        name,
        value: format!("{value} Hz"),
        limit: format!("at most `{most} Hz`, one in each `sample_period`"),
        hint: "shorten `sample_period` or run this loop less often",
    })
}

fn push_velocities(p: &Parameters) -> Result<(), ParameterError> {
    require(p.push.velocity_min <= p.push.velocity_max, || ParameterError {
        name: "push.velocity_min",
        value: format!("{} m/s", p.push.velocity_min),
        limit: format!("at most `{} m/s`, the `push.velocity_max`", p.push.velocity_max),
        hint: "small pushes are the slow ones",
    })
}

fn push_maximum(p: &Parameters) -> Result<(), ParameterError> {
    require(p.push.velocity_max <= p.slide.velocity_max, || ParameterError {
        name: "push.velocity_max",
        value: format!("{} m/s", p.push.velocity_max),
        limit: format!("at most `{} m/s`, the `slide.velocity_max`", p.slide.velocity_max),
        hint: "the paper's 3500 mm/s are um/s",
    })
}

#[cfg(test)]
mod tests {
    use super::*;
    use control_blocks::refusal;

    fn error(change: impl FnOnce(&mut Parameters)) -> String {
        refusal(Parameters::PAPER, change, check)
    }

    #[test]
    fn defaults_and_paper_mode_fit() {
        check(&Parameters::PAPER).unwrap();
        check(&Parameters::START).unwrap();
    }

    #[test]
    fn each_error_names_parameter_value_and_limit() {
        let cases = [
            (error(|p| p.probe.stroke = 0.01), "probe.stroke", "`0.01 m`", "`0.0205 m`"),
            (error(|p| p.park.dead_zone = 5e-3), "park.dead_zone", "`0.005 m`", "`0.0043 m`"),
            (error(|p| p.follow.gap = 0.02), "follow.gap", "`0.02 m`", "`0.0196 m`"),
            (error(|p| p.approach.velocity = 0.2), "approach.velocity", "`0.2 m/s`", "`0.12 m/s`"),
            (error(|p| p.limits.friction = 0.5), "approach.velocity", "`0.12 m/s`", "`0.0198 m`"),
            (error(|p| p.follow.gain = 30.0), "follow.gain", "`30 1/s`", "`25 1/s`"),
            (error(|p| p.follow.gain = 22.0), "follow.gain", "`22 1/s`", "acceleration_max"),
            (error(|p| p.follow.dead_zone = 1e-3), "follow.dead_zone", "`0.001 m`", "`0.0005 m`"),
            (error(|p| p.follow.dead_zone = 3e-4), "follow.settle_band", "`0.0002 m`", "`0.0003 m`"),
            (error(|p| p.rates.control = 2000.0), "rates.control", "`2000 Hz`", "`1000 Hz`"),
            (error(|p| p.rates.collect = 1001.0), "rates.collect", "`1001 Hz`", "`1000 Hz`"),
            (error(|p| p.rates.model = 5000.0), "rates.model", "`5000 Hz`", "`1000 Hz`"),
            (error(|p| p.push.velocity_min = 0.01), "push.velocity_min", "`0.01 m/s`", "`0.0035 m/s`"),
            (error(|p| p.push.velocity_max = 3.5), "push.velocity_max", "`3.5 m/s`", "um/s"),
        ];
        for (message, name, value, limit) in cases {
            assert!(message.starts_with(&format!("parameter `{name}` is {value}")), "{message}");
            assert!(message.contains(limit), "{message}");
            assert!(message.contains("hint:"), "{message}");
        }
    }
}

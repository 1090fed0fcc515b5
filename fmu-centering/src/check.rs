//! Checks of parameters against each other; single ranges are in the variable table of the FMU.

use control_blocks::{Check, Parameter, ParameterError, check_all};

use crate::interface::Law;
use crate::interface::Parameters;
use crate::limits::{GRAVITY, TRIAL_MOVE_MIN, look_ahead, spindle_acceleration};

/// Checks all combinations; the first that fails is the error.
///
/// # Errors
/// When a parameter does not fit the others.
pub fn check(p: &Parameters) -> Result<(), ParameterError> {
    const CHECKS: [Check<Parameters>; 16] = [
        park,
        gap,
        trial,
        following,
        stroke,
        approach_velocity,
        follow_velocity,
        stopping,
        follow_delay,
        follow_braking,
        bands,
        rates,
        push_velocities,
        spindle_speed,
        commission_travel,
        commission_acceleration,
    ];
    check_all(p, &CHECKS)
}

fn stroke(p: &Parameters) -> Result<(), ParameterError> {
    let hint = "reduce the distance of the probe tip before the pusher";
    Parameter::new("probe.stroke", p.probe.stroke, "m", hint)
        .at_least(p.probe.at_pusher + p.follow.gap, "`probe.at_pusher` with one `expert.follow.gap` of reserve")
}

fn park(p: &Parameters) -> Result<(), ParameterError> {
    let maximum = (p.park.probe - p.probe.contact).min(p.probe.at_pusher - p.park.probe);
    let hint = "otherwise a turning ring loses the probe or meets the pusher";
    Parameter::new("park.dead_zone", p.park.dead_zone, "m", hint)
        .less_than(maximum, "from `park.probe` to `probe.contact` and to `probe.at_pusher`")
}

fn gap(p: &Parameters) -> Result<(), ParameterError> {
    let maximum = p.probe.at_pusher - 2.0 * p.probe.contact;
    Parameter::new("expert.follow.gap", p.follow.gap, "m", "the probe must touch while the slide follows")
        .at_most(maximum, "`probe.at_pusher` less twice `probe.contact`")
}

/// Travel (m) that must remain on the ring for the test of the probe: twice the smallest move.
fn trial(p: &Parameters) -> Result<(), ParameterError> {
    let minimum = p.probe.contact + 2.0 * TRIAL_MOVE_MIN;
    let hint = "otherwise the probe cannot be tested before `Centered`";
    match p.law {
        Law::Default => Parameter::new("park.dead_zone", p.park.dead_zone, "m", hint)
            .at_most(p.park.probe - minimum, "`park.probe` less `probe.contact` and 0.2 mm"),
        Law::Paper => Parameter::new("expert.follow.gap", p.follow.gap, "m", hint).at_most(
            p.probe.at_pusher - minimum - p.follow.dead_zone,
            "`probe.at_pusher` less `probe.contact`, `expert.follow.dead_zone` and 0.2 mm",
        ),
    }
}

/// A configured servo must stay within the limit of the following error.
fn following(p: &Parameters) -> Result<(), ParameterError> {
    if p.slide.bandwidth == 0.0 {
        return Ok(());
    }
    let minimum = 3.0 * p.slide.acceleration_max / p.slide.bandwidth.powi(2);
    let hint = "otherwise every fast move raises a fault";
    Parameter::new("limits.following_error", p.limits.following_error, "m", hint)
        .at_least(minimum, "three times `slide.acceleration_max` over the square of `slide.bandwidth`")
}

fn approach_velocity(p: &Parameters) -> Result<(), ParameterError> {
    let velocity = Parameter::new("approach.velocity", p.approach.velocity, "m/s", "reduce it");
    velocity.at_most(p.slide.velocity_max, "the `slide.velocity_max`")
}

fn follow_velocity(p: &Parameters) -> Result<(), ParameterError> {
    let velocity = Parameter::new("follow.velocity_max", p.follow.velocity_max, "m/s", "reduce it");
    velocity.at_most(p.slide.velocity_max, "the `slide.velocity_max`")
}

fn stopping(p: &Parameters) -> Result<(), ParameterError> {
    let (needed, available) = (look_ahead(p), p.probe.at_pusher - p.probe.contact);
    let hint = "reduce it or `ring.eccentricity_max`, or increase the distance of the probe tip before the pusher";
    let velocity = Parameter::new("approach.velocity", p.approach.velocity, "m/s", hint);
    velocity.must_be(needed <= available, || {
        format!("so slow that the slide stops in `{available} m`; it needs `{needed} m` (eq. 9)")
    })
}

fn follow_delay(p: &Parameters) -> Result<(), ParameterError> {
    let hint = "with one period of delay a larger gain oscillates";
    let gain = Parameter::new("expert.follow.gain", p.follow.gain, "1/s", hint);
    gain.at_most(0.25 * p.rates.control, "a quarter of `expert.rates.control`")
}

fn follow_braking(p: &Parameters) -> Result<(), ParameterError> {
    let maximum = p.slide.acceleration_max / p.follow.velocity_max;
    let hint = "a larger gain cannot brake from `follow.velocity_max` before the pusher touches; lower one of them";
    Parameter::new("expert.follow.gain", p.follow.gain, "1/s", hint)
        .at_most(maximum, "`slide.acceleration_max` over `follow.velocity_max`")
}

fn bands(p: &Parameters) -> Result<(), ParameterError> {
    let hint = "otherwise the pusher touches while the slide follows";
    let dead_zone = Parameter::new("expert.follow.dead_zone", p.follow.dead_zone, "m", hint);
    dead_zone.less_than(p.follow.gap, "the `expert.follow.gap`")?;
    let settle_band =
        Parameter::new("expert.follow.settle_band", p.follow.settle_band, "m", "otherwise following never settles");
    settle_band.more_than(p.follow.dead_zone, "the `expert.follow.dead_zone`")
}

fn rates(p: &Parameters) -> Result<(), ParameterError> {
    let maximum = 1.0 / p.sample_period;
    let rates = [
        ("expert.rates.control", p.rates.control),
        ("expert.rates.collect", p.rates.collect),
        ("expert.rates.model", p.rates.model),
    ];
    rates.into_iter().try_for_each(|(name, value)| {
        let rate = Parameter::new(name, value, "Hz", "shorten `sample_period` or run this loop less often");
        rate.must_be(value <= maximum * (1.0 + 1e-9), || format!("at most `{maximum} Hz`, one in each `sample_period`"))
    })
}

fn push_velocities(p: &Parameters) -> Result<(), ParameterError> {
    let minimum = Parameter::new("expert.push.velocity_min", p.push.velocity_min, "m/s", "small pushes are slower");
    minimum.at_most(p.push.velocity_max, "the `expert.push.velocity_max`")?;
    let maximum =
        Parameter::new("expert.push.velocity_max", p.push.velocity_max, "m/s", "the 3500 mm/s of the paper are um/s");
    maximum.at_most(p.slide.velocity_max, "the `slide.velocity_max`")
}

/// On a table that the controller turns, friction must exceed centrifugal force and acceleration of the ring.
fn spindle_speed(p: &Parameters) -> Result<(), ParameterError> {
    if p.spindle_speed == 0.0 {
        return Ok(());
    }
    let hint = "a slower spindle is taken for one at rest";
    let speed = |hint| Parameter::new("spindle.speed", p.spindle_speed.abs(), "rad/s", hint);
    speed(hint).more_than(p.limits.spindle_speed_min, "`limits.spindle_speed_min`")?;
    // eq. 2, and the rim of a ring that turns with the table; both are at right angles
    let (held, eccentricity) = (p.limits.friction * GRAVITY, p.ring.eccentricity_max.min(p.ring.radius));
    let rim = spindle_acceleration(p) * p.ring.radius;
    let hint = "otherwise the ring slips; reduce it or `ring.radius`, or raise `limits.friction` to a certain value";
    Parameter::new("spindle.acceleration", spindle_acceleration(p), "rad/s2", hint)
        .less_than(held / p.ring.radius, "what `limits.friction` holds at `ring.radius`")?;
    let maximum = ((held * held - rim * rim).sqrt() / eccentricity).sqrt();
    let hint = "otherwise the ring flies off; reduce it, `spindle.acceleration` or `ring.eccentricity_max`";
    speed(hint).at_most(maximum, "what `limits.friction` holds at `ring.eccentricity_max` (eq. 2)")
}

fn commission_travel(p: &Parameters) -> Result<(), ParameterError> {
    let hint = "the commissioning run must not move farther than an approach";
    Parameter::new("commission.travel", p.commission.travel, "m", hint)
        .at_most(p.approach.travel_max, "the `approach.travel_max`")
}

fn commission_acceleration(p: &Parameters) -> Result<(), ParameterError> {
    let acceleration = Parameter::new("commission.acceleration", p.commission.acceleration, "m/s2", "reduce it");
    acceleration.at_most(p.slide.acceleration_max, "the `slide.acceleration_max`")
}

#[cfg(test)]
mod tests {
    use super::*;
    use control_blocks::{Refusal, assert_refusals};

    const REFUSALS: &[Refusal<Parameters>] = &[
        (|p| p.probe.stroke = 0.01, "probe.stroke", "`0.01 m`", "`0.0205 m`"),
        (|p| p.spindle_speed = -0.05, "spindle.speed", "`0.05 rad/s`", "`limits.spindle_speed_min`"),
        (|p| (p.spindle_speed, p.spindle_acceleration) = (1.0, 10.0), "spindle.acceleration", "`10 rad/s2`", "`9.80"),
        // 0.8 of 0.49 m/s2 at 25 mm
        (|p| p.spindle_speed = 4.0, "spindle.speed", "`4 rad/s`", "`3.961"),
        (|p| p.park.dead_zone = 5e-3, "park.dead_zone", "`0.005 m`", "`0.0043 m`"),
        (|p| p.follow.gap = 0.02, "expert.follow.gap", "`0.02 m`", "`0.0196 m`"),
        (
            |p| (p.probe.contact, p.follow.gap, p.probe.stroke) = (3e-4, 0.01945, 0.04),
            "expert.follow.gap",
            "`0.01945 m`",
            "twice `probe.contact`",
        ),
        (|p| (p.law, p.park.dead_zone) = (Law::Default, 4.2e-3), "park.dead_zone", "`0.0042 m`", "`0.00409"),
        (
            |p| (p.law, p.probe.contact, p.follow.gap) = (Law::Paper, 1e-4, 0.01975),
            "expert.follow.gap",
            "`0.01975 m`",
            "`0.0197 m`",
        ),
        (|p| p.limits.following_error = 1e-4, "limits.following_error", "`0.0001 m`", "`0.00012"),
        (|p| p.approach.velocity = 0.2, "approach.velocity", "`0.2 m/s`", "`0.12 m/s`"),
        (|p| p.limits.friction = 0.5, "approach.velocity", "`0.12 m/s`", "`0.0198 m`"),
        (|p| p.follow.gain = 30.0, "expert.follow.gain", "`30 1/s`", "`25 1/s`"),
        (|p| (p.follow.gain, p.follow.velocity_max) = (22.0, 0.12), "expert.follow.gain", "`22 1/s`", "`21.33"),
        (|p| p.follow.dead_zone = 1e-3, "expert.follow.dead_zone", "`0.001 m`", "`0.0005 m`"),
        (|p| p.follow.dead_zone = 3e-4, "expert.follow.settle_band", "`0.0002 m`", "`0.0003 m`"),
        (|p| p.rates.control = 2000.0, "expert.rates.control", "`2000 Hz`", "`1000 Hz`"),
        (|p| p.rates.collect = 1001.0, "expert.rates.collect", "`1001 Hz`", "`1000 Hz`"),
        (|p| p.rates.model = 5000.0, "expert.rates.model", "`5000 Hz`", "`1000 Hz`"),
        (|p| p.push.velocity_min = 0.01, "expert.push.velocity_min", "`0.01 m/s`", "`0.0035 m/s`"),
        (|p| p.push.velocity_max = 3.5, "expert.push.velocity_max", "`3.5 m/s`", "um/s"),
        (|p| p.commission.travel = 0.16, "commission.travel", "`0.16 m`", "`0.15 m`"),
        (|p| p.commission.acceleration = 2.6, "commission.acceleration", "`2.6 m/s2`", "`2.56 m/s2`"),
    ];

    #[test]
    fn presets_fit_and_each_error_names_parameter_value_and_limit() {
        assert_refusals(check, &[Parameters::PAPER, Parameters::START], REFUSALS);
    }

    #[test]
    fn a_quicker_slide_may_follow_with_the_same_gain() {
        let mut p = Parameters::START;
        p.slide.velocity_max = 0.25;
        check(&p).unwrap();
    }

    #[test]
    fn each_limit_belongs_to_what_is_allowed() {
        fn rounded(value: f64, up: bool) -> f64 {
            value * if up { 1.0 + 1e-12 } else { 1.0 - 1e-12 }
        }
        let cases: [fn(&mut Parameters, bool); 9] = [
            |p, over| p.probe.stroke = rounded(p.probe.at_pusher + p.follow.gap, !over),
            |p, over| p.approach.velocity = rounded(p.slide.velocity_max, over).min(if over { 1.0 } else { 0.12 }),
            |p, over| p.follow.velocity_max = rounded(p.slide.velocity_max, over),
            |p, over| {
                p.follow.velocity_max = p.slide.velocity_max;
                p.follow.gain = rounded(p.slide.acceleration_max / p.follow.velocity_max, over);
            },
            |p, over| p.follow.dead_zone = if over { p.follow.gap } else { rounded(p.follow.settle_band, false) },
            |p, over| p.rates.model = if over { 1000.1 } else { 1000.0 },
            |p, over| p.push.velocity_min = rounded(p.push.velocity_max, over),
            |p, over| p.push.velocity_max = rounded(p.slide.velocity_max, over),
            |p, over| {
                let minimum = 3.0 * p.slide.acceleration_max / p.slide.bandwidth.powi(2);
                p.limits.following_error = rounded(minimum, !over);
            },
        ];
        for (k, change) in cases.into_iter().enumerate() {
            for over in [false, true] {
                let mut p = Parameters::PAPER;
                change(&mut p, over);
                assert_eq!(check(&p).is_err(), over, "{k}: {:?}", check(&p));
            }
        }
    }
}

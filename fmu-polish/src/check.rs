//! Checks of parameters against each other. The ranges of single parameters are declared in the interface.

use control_blocks::{Parameter, ParameterError, check_all};

use crate::commission::plan;
use crate::force::impedance::{Coefficients, damping};
use crate::force::margin::{self, PHASE_MARGIN_MIN};
use crate::interface::{Force, Mode, Parameters};
use crate::motion::{sliding, stick_slip, sweep_limits};

/// Minimum travel of a commissioning run, in steps of the encoders.
const TRAVEL_STEPS: f64 = 50.0;
/// Minimum number of samples per time constant of the force control.
const SAMPLES_PER_LOOP: f64 = 10.0;

/// Checks all combinations; the first that fails is the error.
///
/// # Errors
/// Names the parameter, its value and the limit.
pub fn check(p: &Parameters) -> Result<(), ParameterError> {
    check_all(
        p,
        &[
            force_limit,
            force_range,
            sensor_direction_y,
            sensor_direction_z,
            lost_force,
            contact_force,
            position_gain,
            loop_gain,
            phase_margin,
            pulse_rate,
            pulse_counts,
            stick_slip_velocity,
            stick_slip_acceleration,
            stick_slip_sliding,
            stick_slip_sweep,
            stick_slip_longest,
            commission_travel,
            commission_force,
        ],
    )
}

fn force_limit(p: &Parameters) -> Result<(), ParameterError> {
    let limit = Parameter::new("limits.force", p.limits.force, "N", "Increase it, or reduce `force.target`.");
    limit.at_least(1.5 * p.force.target, "1.5 times `force.target`")
}

fn force_range(p: &Parameters) -> Result<(), ParameterError> {
    let range = Parameter::new("sensor.range", p.sensor_range, "N", "Reduce `limits.force`, or use a larger sensor.");
    let limit = p.limits.force;
    range.must_be(p.sensor_range > limit, || format!("more than `limits.force` = `{limit} N`"))
}

fn sensor_direction_y(p: &Parameters) -> Result<(), ParameterError> {
    sensor_direction("sensor.direction.y", p.sensor_direction_y)
}

fn sensor_direction_z(p: &Parameters) -> Result<(), ParameterError> {
    sensor_direction("sensor.direction.z", p.sensor_direction_z)
}

fn sensor_direction(name: &'static str, value: i32) -> Result<(), ParameterError> {
    Parameter::new(name, value, "", "Set -1 for an inverted axis, otherwise 1.")
        .must_be(value != 0, || "`1` or `-1`".into())
}

fn lost_force(p: &Parameters) -> Result<(), ParameterError> {
    let force =
        Parameter::new("expert.limits.lost_force", p.limits.lost_force, "N", "Reduce it, or increase `force.target`.");
    force.at_most(0.5 * p.force.target, "half of `force.target`")
}

fn contact_force(p: &Parameters) -> Result<(), ParameterError> {
    let (value, target) = (p.approach.contact_force, p.force.target);
    let force = Parameter::new("expert.approach.contact_force", value, "N", "Reduce it, or increase `force.target`.");
    force.must_be(value < target, || format!("less than `force.target` = `{target} N`"))
}

fn position_gain(p: &Parameters) -> Result<(), ParameterError> {
    let gains = [
        ("expert.position.gain.x", p.position.gain.x),
        ("expert.position.gain.y", p.position.gain.y),
        ("expert.position.gain.z", p.position.gain.z),
    ];
    let maximum = p.drive.position_gain;
    let (name, value) = gains.into_iter().fold(gains[0], |a, b| if b.1 > a.1 { b } else { a });
    let gain = Parameter::new(name, value, "1/s", "Reduce it: the drives cannot follow a faster feedback.");
    gain.must_be(value <= maximum, || format!("at most `drive.position_gain` = `{maximum} 1/s`"))
}

fn loop_gain(p: &Parameters) -> Result<(), ParameterError> {
    let stiffness = p.impedance.gain * p.stiffness_nominal;
    let maximum = 1.0 / (SAMPLES_PER_LOOP * p.sample_period);
    let hint = "Increase it: with less damping the force oscillates.";
    let damping = Parameter::new("impedance.damping", p.impedance.damping, "N.s/m", hint);
    damping.must_be(stiffness / p.impedance.damping <= maximum, || {
        format!("at least `{} N.s/m` at `stiffness.nominal`", stiffness / maximum)
    })
}

/// Settling and following have their own damping each; both are checked at the nominal stiffness.
fn phase_margin(p: &Parameters) -> Result<(), ParameterError> {
    let minimum = margin::minimum(p);
    if minimum >= PHASE_MARGIN_MIN {
        return Ok(());
    }
    let (hint, damped) = ("Change it: with less phase margin the force oscillates.", damping(p, p.stiffness_nominal));
    let settling = Coefficients { integral: 0.0, ..Coefficients::new(p, p.impedance.damping) };
    let following = Coefficients::new(p, damped);
    let proportional = Coefficients { integral: 0.0, ..following };
    let bare = Parameters { force: Force { filter_bandwidth: 0.0, ..p.force }, ..p.clone() };
    let margin = |p: &Parameters, law: &Coefficients| margin::phase_margin(p, law, p.stiffness_nominal);
    let parameter = if margin(p, &settling).min(margin(p, &proportional)) >= PHASE_MARGIN_MIN {
        Parameter::new("expert.force.integral_time", p.force.integral_time, "s", hint)
    } else if margin(&bare, &settling).min(margin(&bare, &proportional)) >= PHASE_MARGIN_MIN {
        Parameter::new("expert.force.filter_bandwidth", p.force.filter_bandwidth, "rad/s", hint)
    } else {
        Parameter::new("expert.impedance.mass", p.impedance.mass, "kg", "Reduce it, or increase `impedance.damping`.")
    };
    parameter.must_be(false, || {
        let [minimum, limit] = [minimum, PHASE_MARGIN_MIN].map(f64::to_degrees);
        format!("such that `{limit:.0} deg` of phase margin remain for the force control, not `{minimum:.0} deg`")
    })
}

fn pulse_rate(p: &Parameters) -> Result<(), ParameterError> {
    let velocity = Parameter::new("velocity_max", p.velocity_max, "m/s", "Reduce it, or increase `pulses.size`.");
    velocity
        .less_than(f64::from(i32::MAX) * p.pulses_size / p.sample_period, "the maximum number of pulses of a sample")
}

fn pulse_counts(p: &Parameters) -> Result<(), ParameterError> {
    let stroke = p.stroke.vector().max();
    let size = Parameter::new("pulses.size", p.pulses_size, "m", "Increase it, or reduce `stroke`.");
    size.must_be(p.pulses_size * f64::from(i32::MAX) > stroke, || format!("`stroke` = `{stroke} m` in 31 bits"))
}

fn stick_slip_velocity(p: &Parameters) -> Result<(), ParameterError> {
    let (maximum, times, feed) = (p.velocity_max, stick_slip::fastest(&p.stick_slip), p.feed.velocity);
    let (setting, velocity) = swept(p, "Reduce it, or increase `velocity_max` if the drives allow it.");
    setting.must_be(times * velocity < maximum, || {
        let ratio = match p.stick_slip.ratio {
            0.0 => String::new(),
            ratio => format!("; with `feed.velocity` = `{feed} m/s` K_v is `{:.6} m/s`", ratio * feed),
        };
        let reason =
            if times > 1.0 { format!("; the sweep is up to `{times:.2}` times as fast") } else { String::new() };
        format!("less than `velocity_max` = `{maximum} m/s`{ratio}{reason}")
    })
}

/// The force of the drives suffices for the sweep.
fn stick_slip_acceleration(p: &Parameters) -> Result<(), ParameterError> {
    let (maximum, limit) = (sweep_limits::accelerated(p), p.drive.acceleration_max);
    let (setting, velocity) = swept(p, "Reduce it, or increase `stick_slip.half_period`.");
    setting.must_be(velocity <= maximum, || {
        let maximum = match p.stick_slip.ratio {
            0.0 => format!("{maximum:.6} m/s"),
            _ => format!("{:.6}", maximum / p.feed.velocity),
        };
        format!("at most `{maximum}`, at which the sweep needs `expert.drive.acceleration_max` = `{limit} m/s2`")
    })
}

/// The parameter that sets K_v, and K_v (m/s) at the configured feed.
fn swept(p: &Parameters, hint: &'static str) -> (Parameter<f64>, f64) {
    let law = &p.stick_slip;
    let setting = match law.ratio {
        0.0 => Parameter::new("stick_slip.velocity", law.velocity, "m/s", hint),
        ratio => Parameter::new("stick_slip.ratio", ratio, "", hint),
    };
    (setting, stick_slip::velocity(law, p.feed.velocity))
}

/// K_v can be increased.
fn stick_slip_sliding(p: &Parameters) -> Result<(), ParameterError> {
    let (sliding, maximum) = (sliding::desired_speed(p), p.stick_slip.velocity_max);
    let speed = Parameter::new("stick_slip.sliding", sliding, "m/s", "Reduce it, or set 0 for a constant velocity.");
    speed.must_be(sliding == 0.0 || sliding < maximum, || {
        format!("less than `stick_slip.velocity_max` = `{maximum} m/s`")
    })
}

/// Half of the linear sweep is a desired position error.
fn stick_slip_sweep(p: &Parameters) -> Result<(), ParameterError> {
    let velocity = stick_slip::velocity(&p.stick_slip, p.feed.velocity);
    let half = 0.5 * velocity * f64::from(p.stick_slip.half_period) * p.sample_period;
    let (value, limit) = (f64::from(p.stick_slip.half_period), p.limits.position_error);
    let period =
        Parameter::new("stick_slip.half_period", value, "samples", "Reduce it, or reduce `stick_slip.velocity`.");
    period.must_be(half < limit, || {
        format!("a sweep of less than `limits.position_error` = `{limit} m` to each side, not `{half} m`")
    })
}

/// So is half of the longest sweep, at the K_v to which it is increased. A longer circle starts half the width of the
/// configured one off the path.
fn stick_slip_longest(p: &Parameters) -> Result<(), ParameterError> {
    let (configured, longest) = (p.stick_slip.half_period, p.stick_slip.half_period_max);
    let raised = if p.stick_slip.mode == Mode::Circular { configured } else { 0 };
    let velocity = sweep_limits::highest(p).max(p.stick_slip.velocity);
    let half = 0.5 * velocity * f64::from(longest + raised) * p.sample_period;
    let maximum = sweep_limits::SWEEP * p.limits.position_error;
    let hint = "Choose a value between both limits, or reduce `stick_slip.velocity_max`.";
    let period = Parameter::new("stick_slip.half_period_max", longest, "samples", hint);
    period.must_be(longest == 0 || longest > configured && half <= maximum, || {
        format!(
            "`0`, or more than `stick_slip.half_period` = `{configured}` with a sweep of at most `{maximum:.6} m` to each side, {} of \
             `limits.position_error`, not `{half:.6} m`",
            sweep_limits::SWEEP
        )
    })
}

/// The rubbing motion must be long against the resolution of the encoders.
fn commission_travel(p: &Parameters) -> Result<(), ParameterError> {
    let (travel, minimum) = (plan::travel(p), TRAVEL_STEPS * p.encoder_resolution);
    let hint = "Increase it: shorter motions are not observable with these encoders.";
    Parameter::new("commission.travel", travel, "m", hint).must_be(travel >= minimum, || {
        format!("`0`, or at least `{minimum} m`, `{TRAVEL_STEPS}` steps of the encoders")
    })
}

fn commission_force(p: &Parameters) -> Result<(), ParameterError> {
    let (minimum, maximum) = (p.approach.contact_force, p.limits.force / 1.5);
    let hint = "A fraction of this force must keep the contact between two ramps.";
    let force = Parameter::new("expert.commission.force", plan::force(p), "N", hint);
    force.must_be((minimum..=maximum).contains(&plan::force(p)), || {
        format!("`0`, or from `{minimum} N`, `expert.approach.contact_force`, to `{maximum} N`, `limits.force` / 1.5")
    })
}

#[cfg(test)]
mod tests {
    use super::*;
    use control_blocks::{Refusal, assert_refusals};

    const REFUSALS: &[Refusal<Parameters>] = &[
        (|p| p.limits.force = 6.0, "limits.force", "`6 N`", "`7.5 N`"),
        (|p| p.position.gain.y = 100.0, "expert.position.gain.y", "`100 1/s`", "`80 1/s`"),
        (|p| p.limits.lost_force = 3.0, "expert.limits.lost_force", "`3 N`", "`2.5 N`"),
        (|p| p.force.target = 0.5, "expert.limits.lost_force", "`0.4 N`", "`0.25 N`"),
        (|p| p.approach.contact_force = 5.0, "expert.approach.contact_force", "`5 N`", "`5 N`"),
        (|p| p.impedance.damping = 1000.0, "impedance.damping", "`1000 N.s/m`", "`1780 N.s/m`"),
        (|p| p.pulses_size = 1e-15, "velocity_max", "`0.05 m/s`", "pulses of a sample"),
        (|p| p.limits.force = 100.0, "sensor.range", "`100 N`", "`limits.force` = `100 N`"),
        (|p| p.force.integral_time = 1e-3, "expert.force.integral_time", "`0.001 s`", "`-51 deg`"),
        (|p| p.force.filter_bandwidth = 10.0, "expert.force.filter_bandwidth", "`10 rad/s`", "`25 deg`"),
        (|p| p.impedance.mass = 1e3, "expert.impedance.mass", "`1000 kg`", "`1 deg`"),
        (|p| (p.pulses_size, p.velocity_max) = (1e-10, 1e-3), "pulses.size", "`0.0000000001 m`", "`stroke`"),
        (|p| p.stick_slip.half_period = 100, "stick_slip.half_period", "`100 samples`", "`0.0005 m`"),
        (
            |p| (p.stick_slip.ratio, p.velocity_max) = (60.0, 0.2),
            "stick_slip.half_period",
            "`10 samples`",
            "`0.0006 m`",
        ),
        (
            |p| p.stick_slip.half_period_max = 9,
            "stick_slip.half_period_max",
            "`9 samples`",
            "`stick_slip.half_period` = `10`",
        ),
        (|p| p.stick_slip.half_period_max = 46, "stick_slip.half_period_max", "`46 samples`", "not `0.000460 m`"),
        (|p| p.stick_slip.half_period_max = 10, "stick_slip.half_period_max", "`10 samples`", "more than"),
        (
            |p| (p.stick_slip.half_period_max, p.stick_slip.mode) = (36, Mode::Circular),
            "stick_slip.half_period_max",
            "`36 samples`",
            "not `0.000460 m`",
        ),
        (|p| p.stick_slip.sliding = 0.02, "stick_slip.sliding", "`0.02 m/s`", "`stick_slip.velocity_max` = `0.02 m/s`"),
        (|p| p.sensor_direction_y = 0, "sensor.direction.y", "`0`", "`-1`"),
        (|p| p.sensor_direction_z = 0, "sensor.direction.z", "`0`", "`-1`"),
        (|p| p.commission.travel = 4e-5, "commission.travel", "`0.00004 m`", "`50` steps"),
        (|p| p.commission.force = 17.0, "expert.commission.force", "`17 N`", "`16.66"),
        (|p| p.commission.force = 0.5, "expert.commission.force", "`0.5 N`", "`0.6 N`"),
        (|p| p.stick_slip.velocity = 0.06, "stick_slip.velocity", "`0.06 m/s`", "`0.05 m/s`"),
        (
            |p| (p.stick_slip.velocity, p.stick_slip.mode) = (0.032, Mode::Circular),
            "stick_slip.velocity",
            "`0.032 m/s`",
            "`1.57` times",
        ),
        (
            |p| (p.drive.acceleration_max, p.stick_slip.mode) = (4.9, Mode::Circular),
            "stick_slip.velocity",
            "`0.01 m/s`",
            "`0.009929 m/s`",
        ),
        (
            |p| (p.stick_slip.ratio, p.feed.velocity, p.stick_slip.mode) = (3.0, 0.02, Mode::Circular),
            "stick_slip.ratio",
            "`3`",
            "`velocity_max` = `0.05 m/s`; with `feed.velocity` = `0.02 m/s` K_v is `0.06",
        ),
        (
            |p| {
                (p.drive.acceleration_max, p.stick_slip.mode) = (4.9, Mode::Circular);
                p.stick_slip.ratio = 5.0;
            },
            "stick_slip.ratio",
            "`5`",
            "`4.9",
        ),
    ];

    #[test]
    fn presets_fit_and_each_error_names_parameter_value_and_limit() {
        assert_refusals(check, &[Parameters::START, Parameters::PAPER], REFUSALS);
    }
}

//! Checks of parameters against each other; single ranges are in the variable table of the FMU.

use control_blocks::{Parameter, ParameterError, check_all};

use crate::interface::{Mode, Parameters};

/// Samples per time constant of the loop, at least.
const SAMPLES_PER_LOOP: f64 = 10.0;

/// Checks all combinations; the first that fails is the error.
///
/// # Errors
/// Names the parameter, its value and the limit.
pub fn check(p: &Parameters) -> Result<(), ParameterError> {
    check_all(p, &[force_limit, lost_force, contact_force, position_gain, loop_gain, pulse_rate, stick_slip_velocity])
}

fn force_limit(p: &Parameters) -> Result<(), ParameterError> {
    let limit = Parameter::new("limits.force", p.limits.force, "N", "raise it, or press less");
    limit.at_least(1.5 * p.force.target, "1.5 times `force.target`")
}

fn lost_force(p: &Parameters) -> Result<(), ParameterError> {
    let force = Parameter::new("limits.lost_force", p.limits.lost_force, "N", "lower it, or press more");
    force.at_most(0.5 * p.force.target, "half of `force.target`")
}

fn contact_force(p: &Parameters) -> Result<(), ParameterError> {
    let (value, target) = (p.approach.contact_force, p.force.target);
    let force = Parameter::new("approach.contact_force", value, "N", "lower it, or press more");
    force.must_be(value < target, || format!("less than `force.target` = `{target} N`"))
}

fn position_gain(p: &Parameters) -> Result<(), ParameterError> {
    let gains = [
        ("position.gain.x", p.position.gain.x),
        ("position.gain.y", p.position.gain.y),
        ("position.gain.z", p.position.gain.z),
    ];
    let most = p.drive.position_gain;
    let (name, value) = gains.into_iter().fold(gains[0], |a, b| if b.1 > a.1 { b } else { a });
    let gain = Parameter::new(name, value, "1/s", "the drives cannot follow a faster feedback");
    gain.must_be(value <= most, || format!("at most `drive.position_gain` = `{most} 1/s`"))
}

fn loop_gain(p: &Parameters) -> Result<(), ParameterError> {
    let stiffness = p.impedance.gain * p.stiffness_nominal;
    let most = 1.0 / (SAMPLES_PER_LOOP * p.sample_period);
    let hint = "more damping, or the force oscillates";
    let damping = Parameter::new("impedance.damping", p.impedance.damping, "N.s/m", hint);
    damping.must_be(stiffness / p.impedance.damping <= most, || {
        format!("at least `{} N.s/m` at `stiffness.nominal`", stiffness / most)
    })
}

fn pulse_rate(p: &Parameters) -> Result<(), ParameterError> {
    let velocity = Parameter::new("velocity_max", p.velocity_max, "m/s", "lower it, or take larger pulses");
    velocity.less_than(f64::from(i32::MAX) * p.pulses_size / p.sample_period, "the most pulses of a sample")
}

fn stick_slip_velocity(p: &Parameters) -> Result<(), ParameterError> {
    let (value, most) = (p.stick_slip.velocity, p.velocity_max);
    let hint = "lower it, or raise `velocity_max` if the drives allow it";
    let velocity = Parameter::new("stick_slip.velocity", value, "m/s", hint);
    velocity
        .must_be(p.stick_slip.mode == Mode::Off || value < most, || format!("less than `velocity_max` = `{most} m/s`"))
}

#[cfg(test)]
mod tests {
    use super::*;
    use control_blocks::{Refusal, assert_refusals};

    const REFUSALS: &[Refusal<Parameters>] = &[
        (|p| p.limits.force = 6.0, "limits.force", "`6 N`", "`7.5 N`"),
        (|p| p.position.gain.y = 100.0, "position.gain.y", "`100 1/s`", "`80 1/s`"),
        (|p| p.limits.lost_force = 3.0, "limits.lost_force", "`3 N`", "`2.5 N`"),
        (|p| p.force.target = 0.5, "limits.lost_force", "`0.4 N`", "`0.25 N`"),
        (|p| p.approach.contact_force = 5.0, "approach.contact_force", "`5 N`", "`5 N`"),
        (|p| p.impedance.damping = 1000.0, "impedance.damping", "`1000 N.s/m`", "`1780 N.s/m`"),
        (|p| p.pulses_size = 1e-15, "velocity_max", "`0.05 m/s`", "pulses of a sample"),
        (|p| p.stick_slip.velocity = 0.06, "stick_slip.velocity", "`0.06 m/s`", "`0.05 m/s`"),
    ];

    #[test]
    fn presets_fit_and_each_error_names_parameter_value_and_limit() {
        assert_refusals(check, &[Parameters::START, Parameters::PAPER], REFUSALS);
    }
}

//! Checks of parameters against each other; single ranges are in the variable table of the FMU.

use control_blocks::{ParameterError, check_all, require};

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
    let least = 1.5 * p.force.target;
    require(p.limits.force >= least, || ParameterError {
        name: "limits.force",
        value: format!("{} N", p.limits.force),
        limit: format!("at least `{least} N`, 1.5 times `force.target`"),
        hint: "raise it, or press less",
    })
}

fn lost_force(p: &Parameters) -> Result<(), ParameterError> {
    let most = 0.5 * p.force.target;
    require(p.limits.lost_force <= most, || ParameterError {
        name: "limits.lost_force",
        value: format!("{} N", p.limits.lost_force),
        limit: format!("at most `{most} N`, half of `force.target`"),
        hint: "lower it, or press more",
    })
}

fn contact_force(p: &Parameters) -> Result<(), ParameterError> {
    require(p.approach.contact_force < p.force.target, || ParameterError {
        name: "approach.contact_force",
        value: format!("{} N", p.approach.contact_force),
        limit: format!("less than `force.target` = `{} N`", p.force.target),
        hint: "lower it, or press more",
    })
}

fn position_gain(p: &Parameters) -> Result<(), ParameterError> {
    let gains = [
        ("position.gain.x", p.position.gain.x),
        ("position.gain.y", p.position.gain.y),
        ("position.gain.z", p.position.gain.z),
    ];
    let most = p.drive.position_gain;
    let (name, gain) = gains.into_iter().fold(gains[0], |a, b| if b.1 > a.1 { b } else { a });
    require(gain <= most, || ParameterError {
        name,
        value: format!("{gain} 1/s"),
        limit: format!("at most `drive.position_gain` = `{most} 1/s`"),
        hint: "the drives cannot follow a faster feedback",
    })
}

fn loop_gain(p: &Parameters) -> Result<(), ParameterError> {
    let gain = p.impedance.gain * p.stiffness_nominal / p.impedance.damping;
    let most = 1.0 / (SAMPLES_PER_LOOP * p.sample_period);
    require(gain <= most, || ParameterError {
        name: "impedance.damping",
        value: format!("{} N.s/m", p.impedance.damping),
        limit: format!("at least `{} N.s/m` at `stiffness.nominal`", p.impedance.gain * p.stiffness_nominal / most),
        hint: "more damping, or the force oscillates",
    })
}

fn pulse_rate(p: &Parameters) -> Result<(), ParameterError> {
    let most = f64::from(i32::MAX) * p.pulses_size / p.sample_period;
    require(p.velocity_max < most, || ParameterError {
        name: "velocity_max",
        value: format!("{} m/s", p.velocity_max),
        limit: format!("less than `{most} m/s`, the most pulses of a sample"),
        hint: "lower it, or take larger pulses",
    })
}

fn stick_slip_velocity(p: &Parameters) -> Result<(), ParameterError> {
    let on = p.stick_slip.mode != Mode::Off;
    require(!on || p.stick_slip.velocity < p.velocity_max, || ParameterError {
        name: "stick_slip.velocity",
        value: format!("{} m/s", p.stick_slip.velocity),
        limit: format!("less than `velocity_max` = `{} m/s`", p.velocity_max),
        hint: "lower it, or raise `velocity_max` if the drives allow it",
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
    fn each_error_names_parameter_value_and_limit() {
        let cases = [
            (error(|p| p.limits.force = 6.0), "limits.force", "`6 N`", "`7.5 N`"),
            (error(|p| p.limits.lost_force = 3.0), "limits.lost_force", "`3 N`", "`2.5 N`"),
            (error(|p| p.force.target = 0.5), "limits.lost_force", "`0.4 N`", "`0.25 N`"),
            (error(|p| p.approach.contact_force = 5.0), "approach.contact_force", "`5 N`", "`5 N`"),
            (error(|p| p.position.gain.y = 100.0), "position.gain.y", "`100 1/s`", "`80 1/s`"),
            (error(|p| p.impedance.damping = 1000.0), "impedance.damping", "`1000 N.s/m`", "`1780 N.s/m`"),
            (error(|p| p.pulses_size = 1e-15), "velocity_max", "`0.05 m/s`", "pulses of a sample"),
            (error(|p| p.stick_slip.velocity = 0.06), "stick_slip.velocity", "`0.06 m/s`", "`0.05 m/s`"),
        ];
        for (message, name, value, limit) in cases {
            assert!(message.starts_with(&format!("parameter `{name}` is {value}")), "{message}");
            assert!(message.contains(limit) && message.contains("hint:"), "{message}");
        }
    }
}

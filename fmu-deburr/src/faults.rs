//! Every fault is found here; and the numbers that are told with it.

use crate::interface::{AxisLimits, AxisOutput, Fault, Parameters, Vars};
use crate::path::kinematics::{AXES, Joints};

/// What may be a fault.
#[derive(Clone, Copy, Debug)]
pub struct Signs<'a> {
    /// Every input is plausible.
    pub valid: bool,
    /// Control error of each axis, pulses; zeros while the position loop is open.
    pub error: &'a Joints,
    /// A renewed pattern was larger than its limit.
    pub too_large: bool,
    /// A job begins that needs patterns, and there are none.
    pub nothing_learned: bool,
    /// The tool cuts.
    pub cuts: bool,
    /// Tool speed, rad/s.
    pub spindle_speed: f64,
}

/// The first that is found.
pub fn find(p: &Parameters, signs: &Signs) -> Fault {
    if !signs.valid {
        Fault::InvalidInput
    } else if (0..AXES).any(|i| signs.error[i].abs() * p.axis[i].pulse > p.limits.axis[i].error_max) {
        Fault::ControlError
    } else if signs.too_large {
        Fault::PatternTooLarge
    } else if signs.nothing_learned {
        Fault::BankEmpty
    } else if signs.cuts && signs.spindle_speed < p.limits.spindle_speed_min {
        Fault::SpindleSlow
    } else {
        Fault::None
    }
}

/// The numbers behind a fault, for the log.
pub fn numbers(Vars { input, output, in_force: p, .. }: &Vars) -> String {
    match output.fault {
        Fault::None | Fault::BankEmpty => String::new(),
        Fault::InvalidInput => {
            let (positions, n, share) =
                (input.axis.map(|axis| axis.position), input.spindle_speed, input.speed_override);
            format!(": positions `{positions:?}`, `spindle_speed` = `{n} rad/s`, `speed_override` = `{share}`")
        }
        Fault::ControlError => {
            let beyond = |(i, (axis, limits)): (usize, (&AxisOutput, &AxisLimits))| {
                let (error, limit) = (axis.error, limits.error_max);
                (error.abs() > limit).then(|| format!(": `axis{}.error` = `{error:.6}`, limit `{limit}`", i + 1))
            };
            output.axis.iter().zip(&p.limits.axis).enumerate().filter_map(beyond).collect()
        }
        Fault::PatternTooLarge => format!(": limit `{} pulses`", p.limits.pulses_max),
        Fault::SpindleSlow => {
            let (n, limit) = (input.spindle_speed, p.limits.spindle_speed_min);
            format!(": `spindle_speed` = `{n:.1} rad/s`, limit `{limit:.1} rad/s`")
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const GOOD: Signs = Signs {
        valid: true,
        error: &[0.0; AXES],
        too_large: false,
        nothing_learned: false,
        cuts: true,
        spindle_speed: 1800.0,
    };

    #[test]
    fn each_sign_is_its_fault_and_an_invalid_input_comes_first() {
        let p = Parameters::START;
        let mut error = [0.0; AXES];
        error[4] = -0.51 / p.axis[4].pulse;
        let cases = [
            (GOOD, Fault::None),
            (Signs { error: &error, ..GOOD }, Fault::ControlError),
            (Signs { too_large: true, ..GOOD }, Fault::PatternTooLarge),
            (Signs { nothing_learned: true, ..GOOD }, Fault::BankEmpty),
            (Signs { spindle_speed: 1000.0, ..GOOD }, Fault::SpindleSlow),
            (Signs { spindle_speed: 1000.0, cuts: false, ..GOOD }, Fault::None),
        ];
        for (signs, fault) in cases {
            assert_eq!(find(&p, &signs), fault);
            assert_eq!(find(&p, &Signs { valid: false, ..signs }), Fault::InvalidInput);
        }
    }

    #[test]
    fn a_fault_is_told_with_its_numbers_and_a_state_without() {
        let mut vars = <Vars as fmi2_export::Interface>::START;
        assert_eq!(numbers(&vars), "");
        (vars.output.fault, vars.output.axis[2].error) = (Fault::ControlError, -0.25);
        assert_eq!(numbers(&vars), ": `axis3.error` = `-0.250000`, limit `0.1`");
        (vars.output.fault, vars.input.spindle_speed) = (Fault::SpindleSlow, 900.0);
        assert_eq!(numbers(&vars), ": `spindle_speed` = `900.0 rad/s`, limit `1047.2 rad/s`");
    }
}

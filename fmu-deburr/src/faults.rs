//! Priority of the faults that this module and `monitoring` find, and the details in their messages.

use crate::check::check_delay;
use crate::commission::values::{DELAY_STD_MAX, Rejection, Values, delays};
use crate::interface::{Fault, Output, Parameters, Vars};
use crate::monitoring::finding::{Finding, Numbers};

/// Findings of one sample; each may be none.
#[derive(Clone, Copy, Debug)]
pub struct Signs {
    /// Finding of the inputs.
    pub inputs: Finding,
    /// Finding of the axes.
    pub axes: Finding,
    /// Finding at the end of a run: a renewed pattern above its limit, or a run that ended too early.
    pub run: Finding,
    /// A task starts that needs patterns, and there are none.
    pub nothing_learned: bool,
    /// Why the measured values cannot be used.
    pub commission: Option<Rejection>,
    /// Finding of the touches.
    pub registration: Finding,
    /// Finding of the tool while it cuts.
    pub tool: Finding,
    /// Samples of the task, and their limit.
    pub task: (u64, u64),
}

/// The first finding; causes come before consequences.
pub fn find(p: &Parameters, signs: &Signs) -> Finding {
    let &Signs { inputs, axes, run, nothing_learned, commission, registration, tool, task: (samples, maximum) } = signs;
    let empty = if nothing_learned { Finding::plain(Fault::BankEmpty) } else { Finding::NONE };
    let rejected = commission.map_or(Finding::NONE, rejected);
    let seconds = |samples: u64| samples as f64 * p.sample_period;
    let late = match samples > maximum {
        true => Finding::beyond(Fault::NoProgress, seconds(samples), seconds(maximum)),
        false => Finding::NONE,
    };
    [inputs, axes, run, empty, rejected, registration, tool, late]
        .into_iter()
        .find(Finding::is_fault)
        .unwrap_or(Finding::NONE)
}

/// Finding with the number of the axis; 0 is the delay of all axes, -1 the tool, -2 the derived parameters.
fn rejected(what: Rejection) -> Finding {
    let axis = match what {
        Rejection::Drive(axis) => axis,
        Rejection::Delay => 0,
        Rejection::Tool => -1,
        Rejection::Values => -2,
    };
    Finding { fault: Fault::CommissionRejected, numbers: Numbers { axis, ..Numbers::START } }
}

/// Details of a fault for its message.
pub fn numbers(Vars { input, output, in_force: p, .. }: &Vars) -> String {
    let Numbers { axis, value, limit, ratio } = output.numbers;
    let row = format!("for more than `limits.lost_samples` = `{}` samples", p.limits.lost_samples);
    match output.fault {
        Fault::None | Fault::BankEmpty | Fault::NoTouches => String::new(),
        Fault::InvalidInput => format!(": `speed_override` = `{}` {row}", input.speed_override),
        Fault::PositionJump if limit > 0.0 => {
            format!(": axis {axis} lost `{value:.6} {unit}` in steps, limit `{limit:.6} {unit}`", unit = unit(axis))
        }
        Fault::PositionJump | Fault::PositionLost => {
            let position = axis.checked_sub(1).and_then(|i| input.axis.get(i as usize)).map_or(0.0, |i| i.position);
            format!(": `axis{axis}.position` = `{position} {}` {row}", unit(axis))
        }
        Fault::SpindleJump | Fault::SpindleLost => format!(": `spindle_speed` = `{} rad/s` {row}", input.spindle_speed),
        Fault::SpindleFrozen => format!(": `spindle_speed` has not changed for `{value:.2} s`, limit `{limit:.2} s`"),
        Fault::PositionFrozen if ratio.is_none() => {
            format!(": axis {axis} has not changed for `{value:.2} s`, limit `{limit:.2} s`; it flickered before")
        }
        Fault::PositionFrozen
        | Fault::Oscillation
        | Fault::DriveSign
        | Fault::WeakDrive
        | Fault::FollowingError
        | Fault::PatternMismatch => of_axis(output),
        Fault::WrongDelay => {
            let who = if axis == 0 { "all axes respond".to_owned() } else { format!("axis {axis} responds") };
            format!(": {who} after `{value}` samples, `io_delay` = `{limit}`")
        }
        Fault::CommissionRejected => measured(p, output),
        Fault::NoPart => {
            format!(": touch {axis}: no contact within `{:.2} mm`, limit `{:.2} mm`", 1e3 * value, 1e3 * limit)
        }
        Fault::UnexpectedContact => format!(": `contact` is true before touch {axis} {row}"),
        Fault::ContactFrozen => {
            format!(": touch {axis}: `contact` is true {row}, after the return to `{:.2} mm`", 1e3 * value)
        }
        Fault::TouchMismatch if axis == 0 => ": no position of the workpiece fits them".to_owned(),
        Fault::TouchMismatch => {
            format!(": touch {axis} is `{:.1} um` from the fitted position, limit `{:.1} um`", 1e6 * value, 1e6 * limit)
        }
        Fault::Misplaced => match axis {
            1 => format!(": displaced by `{:.3} mm`, limit `{:.3} mm`", 1e3 * value, 1e3 * limit),
            2 => format!(": rotated by `{:.3} mrad`, limit `{:.3} mrad`", 1e3 * value, 1e3 * limit),
            _ => format!(": the robot cannot follow the path at `{value:.4} m` of `{limit:.4} m`"),
        },
        Fault::PatternTooLarge => format!(": limit `{} pulses`", p.limits.pulses_max),
        Fault::SpindleSlow => format!(": `spindle_speed` = `{value:.1} rad/s`, limit `{limit:.1} rad/s`"),
        Fault::LongStep => format!(": limit `{} s`", p.sample_period),
        Fault::NoCut => match ratio {
            Some(travel) => format!(": no cut for `{:.1} mm`, limit `{:.1} mm`", 1e3 * travel, 1e3 * limit),
            None => format!(": `spindle_speed` changed by `{value:.2} rad/s`, limit `{limit} rad/s`"),
        },
        Fault::NoProgress => format!(": `{value:.1} s`, limit `{limit:.1} s`"),
    }
}

/// The measured values that are rejected, with their limits; the configured values are active again.
fn measured(p: &Parameters, output: &Output) -> String {
    let (m, axis) = (&output.measured, output.numbers.axis);
    if let Some(drive) = axis.checked_sub(1).and_then(|i| m.axis.get(i as usize)) {
        return format!(
            ": axis {axis}: gain `{:.4}`, limits 0.5 and 2; standard deviation `{:.4}`, limit `expert.commission.std_max` = `{}` of it; \
             delay `{:.3}` samples, limits 0.75 around the mean `{:.0}`; \
             lag `{:.2} ms`, limit -0.1 samples; standard deviation `{:.2} ms`, limit `{}` samples",
            drive.gain,
            drive.gain_std,
            p.commission.std_max,
            drive.delay,
            m.io_delay.round(),
            1e3 * drive.lag,
            1e3 * drive.lag_std,
            DELAY_STD_MAX,
        );
    }
    match axis {
        0 => format!(
            ": all axes respond after `{:.3}` samples, limits `{}` and `{}` for the configured `io_delay` = `{}`",
            m.io_delay,
            delays(p.io_delay).start(),
            delays(p.io_delay).end(),
            p.io_delay
        ),
        -1 => format!(
            ": idle speed of the tool `{:.1} rad/s`, standard deviation `{:.2} rad/s`; limits 0.5 and 2 times the configured \
             `load.idle_speed` = `{:.1} rad/s`, and `expert.commission.std_max` = `{}` of it",
            m.idle_speed, m.idle_speed_std, p.load.idle_speed, p.commission.std_max
        ),
        _ => {
            let mut found = p.clone();
            Values::of(p).derived(m).put(&mut found);
            check_delay(&found).err().map_or_else(String::new, |error| format!(": {}", error.of_derived()))
        }
    }
}

fn unit(axis: i32) -> &'static str {
    if matches!(axis, 2 | 3) { "m" } else { "rad" }
}

fn of_axis(output: &Output) -> String {
    let Numbers { axis, value, limit, ratio } = output.numbers;
    let unit = unit(axis);
    let answer = ratio.map_or(String::new(), |ratio| format!("; it does `{ratio:.2}` of its commanded motion"));
    format!(": axis {axis} by `{value:.6} {unit}`, limit `{limit:.6} {unit}`{answer}")
}

#[cfg(test)]
mod tests {
    use control_blocks::Reaction;

    use super::*;

    const GOOD: Signs = Signs {
        inputs: Finding::NONE,
        axes: Finding::NONE,
        run: Finding::NONE,
        nothing_learned: false,
        commission: None,
        registration: Finding::NONE,
        tool: Finding::NONE,
        task: (7, 7),
    };

    #[test]
    fn each_sign_is_its_fault_and_the_cause_comes_first() {
        let p = Parameters::START;
        let plain = Finding::plain;
        let cases = [
            (GOOD, Fault::None),
            (Signs { task: (8, 7), ..GOOD }, Fault::NoProgress),
            (Signs { tool: plain(Fault::SpindleSlow), task: (8, 7), ..GOOD }, Fault::SpindleSlow),
            (Signs { nothing_learned: true, task: (8, 7), ..GOOD }, Fault::BankEmpty),
            (Signs { run: plain(Fault::PatternTooLarge), nothing_learned: true, ..GOOD }, Fault::PatternTooLarge),
            (Signs { axes: plain(Fault::WeakDrive), run: plain(Fault::NoCut), ..GOOD }, Fault::WeakDrive),
        ];
        for (signs, fault) in cases {
            assert_eq!(find(&p, &signs).fault, fault);
            let invalid = Signs { inputs: plain(Fault::InvalidInput), ..signs };
            assert_eq!(find(&p, &invalid).fault, Fault::InvalidInput);
        }
        assert_eq!(find(&p, &Signs { task: (800, 700), ..GOOD }).numbers.limit, 7.0);
    }

    #[test]
    fn faults_of_the_axes_switch_the_drives_off_and_other_faults_do_not() {
        for fault in Fault::ALL {
            let expected = match fault {
                Fault::None | Fault::PatternMismatch | Fault::WrongDelay => Reaction::Retract,
                Fault::InvalidInput | Fault::SpindleLost | Fault::SpindleJump | Fault::SpindleFrozen => {
                    Reaction::Retract
                }
                Fault::SpindleSlow | Fault::NoCut | Fault::NoProgress => Reaction::Retract,
                Fault::NoPart | Fault::UnexpectedContact | Fault::ContactFrozen => Reaction::Retract,
                Fault::PatternTooLarge | Fault::BankEmpty | Fault::CommissionRejected => Reaction::Stop,
                Fault::NoTouches | Fault::Misplaced | Fault::TouchMismatch => Reaction::Stop,
                _ => Reaction::DriveOff,
            };
            assert_eq!(fault.reaction(), expected, "{fault:?}");
        }
    }

    #[test]
    fn a_message_of_a_fault_has_details_and_one_of_a_state_has_none() {
        let mut vars = <Vars as fmi2_export::Interface>::START;
        assert_eq!(numbers(&vars), "");
        vars.output.fault = Fault::WeakDrive;
        vars.output.numbers = Numbers { axis: 3, value: 0.0025, limit: 0.002, ratio: Some(0.3) };
        assert_eq!(
            numbers(&vars),
            ": axis 3 by `0.002500 m`, limit `0.002000 m`; it does `0.30` of its commanded motion"
        );
        vars.output.fault = Fault::SpindleFrozen;
        vars.output.numbers = Numbers { value: 0.51, limit: 0.5, ..Numbers::START };
        assert_eq!(numbers(&vars), ": `spindle_speed` has not changed for `0.51 s`, limit `0.50 s`");
        vars.output.fault = Fault::SpindleSlow;
        vars.output.numbers = Numbers { value: 900.0, limit: 1675.5, ..Numbers::START };
        assert_eq!(numbers(&vars), ": `spindle_speed` = `900.0 rad/s`, limit `1675.5 rad/s`");
        for fault in Fault::ALL {
            vars.output.fault = *fault;
            let without = matches!(fault, Fault::None | Fault::BankEmpty | Fault::NoTouches);
            assert_eq!(numbers(&vars).is_empty(), without, "{fault:?}");
        }
    }

    #[test]
    fn a_rejected_identification_reports_its_values_and_limits() {
        let mut vars = <Vars as fmi2_export::Interface>::START;
        vars.output.fault = Fault::CommissionRejected;
        vars.output.measured.io_delay = 3.21;
        let drive = &mut vars.output.measured.axis[1];
        (drive.gain, drive.gain_std, drive.delay, drive.lag_std) = (0.81, 0.003, 2.5, 1e-4);
        vars.output.measured.idle_speed = 123.4;
        vars.in_force.learn.lead_in = 2;
        for (what, parts) in [
            (
                Rejection::Drive(2),
                [
                    "axis 2: gain `0.8100`",
                    "standard deviation `0.0030`, limit `expert.commission.std_max` = `0.002`",
                    "`2.500`",
                ],
            ),
            (Rejection::Delay, ["after `3.210` samples", "limits `0` and `3`", "the configured `io_delay` = `1`"]),
            (
                Rejection::Tool,
                ["idle speed of the tool `123.4 rad/s`", "`load.idle_speed` = `1885.0 rad/s`", "`0.002` of it"],
            ),
            (Rejection::Values, ["parameter `expert.learn.lead_in` would be `2`", "must be at least `", "do not fit"]),
        ] {
            let found = find(&vars.in_force, &Signs { commission: Some(what), task: (8, 7), ..GOOD });
            assert_eq!(found.fault, Fault::CommissionRejected);
            vars.output.numbers = found.numbers;
            let message = numbers(&vars);
            assert!(parts.iter().all(|part| message.contains(part)), "{message}");
        }
    }

    #[test]
    fn each_fault_has_its_own_message() {
        let mut vars = <Vars as fmi2_export::Interface>::START;
        let plain = Numbers { value: 2.5, limit: 1.25, ..Numbers::START };
        let axis = Numbers { axis: 1, ..plain };
        let cases = [
            (
                Fault::SpindleJump,
                plain,
                ": `spindle_speed` = `1885 rad/s` for more than `limits.lost_samples` = `3` samples",
            ),
            (
                Fault::PositionLost,
                axis,
                ": `axis1.position` = `0 rad` for more than `limits.lost_samples` = `3` samples",
            ),
            (Fault::SpindleFrozen, plain, ": `spindle_speed` has not changed for `2.50 s`, limit `1.25 s`"),
            (Fault::PositionJump, axis, ": axis 1 lost `2.500000 rad` in steps, limit `1.250000 rad`"),
            (Fault::PositionFrozen, axis, ": axis 1 has not changed for `2.50 s`, limit `1.25 s`; it flickered before"),
            (
                Fault::PositionFrozen,
                Numbers { ratio: Some(0.0), ..axis },
                ": axis 1 by `2.500000 rad`, limit `1.250000 rad`; it does `0.00` of its commanded motion",
            ),
            (Fault::WrongDelay, plain, ": all axes respond after `2.5` samples, `io_delay` = `1.25`"),
            (Fault::WrongDelay, axis, ": axis 1 responds after `2.5` samples, `io_delay` = `1.25`"),
            (Fault::PatternTooLarge, plain, ": limit `32767 pulses`"),
            (Fault::LongStep, plain, ": limit `0.01 s`"),
            (Fault::NoCut, plain, ": `spindle_speed` changed by `2.50 rad/s`, limit `1.25 rad/s`"),
            (Fault::NoCut, Numbers { ratio: Some(0.25), ..plain }, ": no cut for `250.0 mm`, limit `1250.0 mm`"),
            (Fault::NoProgress, plain, ": `2.5 s`, limit `1.2 s`"),
            (Fault::NoPart, axis, ": touch 1: no contact within `2500.00 mm`, limit `1250.00 mm`"),
            (
                Fault::UnexpectedContact,
                axis,
                ": `contact` is true before touch 1 for more than `limits.lost_samples` = `3` samples",
            ),
            (
                Fault::ContactFrozen,
                axis,
                ": touch 1: `contact` is true for more than `limits.lost_samples` = `3` samples, after the return to `2500.00 mm`",
            ),
            (Fault::TouchMismatch, plain, ": no position of the workpiece fits them"),
            (Fault::TouchMismatch, axis, ": touch 1 is `2500000.0 um` from the fitted position, limit `1250000.0 um`"),
            (Fault::Misplaced, axis, ": displaced by `2500.000 mm`, limit `1250.000 mm`"),
            (Fault::Misplaced, Numbers { axis: 2, ..plain }, ": rotated by `2500.000 mrad`, limit `1250.000 mrad`"),
            (
                Fault::Misplaced,
                Numbers { axis: 3, ..plain },
                ": the robot cannot follow the path at `2.5000 m` of `1.2500 m`",
            ),
        ];
        for (fault, numbers_of, expected) in cases {
            (vars.output.fault, vars.output.numbers) = (fault, numbers_of);
            assert_eq!(numbers(&vars), expected, "{fault:?}");
        }
        vars.output.fault = Fault::SpindleLost;
        vars.input.spindle_speed = f64::INFINITY;
        assert!(numbers(&vars).contains("`spindle_speed` = `inf rad/s`"));
        vars.output.fault = Fault::InvalidInput;
        vars.input.speed_override = f64::NAN;
        assert!(numbers(&vars).contains("`speed_override` = `NaN`"));
    }
}

//! Every fault is found here or in `monitoring`; how each of them ends, and the numbers that are told with it.

use control_blocks::SafeEnd;

use crate::check::check_delay;
use crate::commission::values::{Rejection, Values, delays};
use crate::interface::{Fault, Output, Parameters, Vars};
use crate::monitoring::finding::{Finding, Numbers};

/// What may be a fault; each is none, or its finding.
#[derive(Clone, Copy, Debug)]
pub struct Signs {
    /// Of the inputs.
    pub inputs: Finding,
    /// Of the axes.
    pub axes: Finding,
    /// A renewed pattern was larger than its limit, or a run ended where it should not.
    pub run: Finding,
    /// A job begins that needs patterns, and there are none.
    pub nothing_learned: bool,
    /// Why what was measured cannot be used.
    pub commission: Option<Rejection>,
    /// Of the touches.
    pub registration: Finding,
    /// Of the tool that cuts.
    pub tool: Finding,
    /// Samples of the job, and how many it may take.
    pub job: (u64, u64),
}

/// The first that is found, causes before consequences.
pub fn find(p: &Parameters, signs: &Signs) -> Finding {
    let &Signs { inputs, axes, run, nothing_learned, commission, registration, tool, job: (samples, most) } = signs;
    let empty = if nothing_learned { Finding::plain(Fault::BankEmpty) } else { Finding::NONE };
    let rejected = commission.map_or(Finding::NONE, rejected);
    let seconds = |samples: u64| samples as f64 * p.sample_period;
    let late = match samples > most {
        true => Finding::beyond(Fault::NoProgress, seconds(samples), seconds(most)),
        false => Finding::NONE,
    };
    [inputs, axes, run, empty, rejected, registration, tool, late]
        .into_iter()
        .find(Finding::is_fault)
        .unwrap_or(Finding::NONE)
}

/// The number of its axis; 0 is the delay of all, -1 the tool.
fn rejected(what: Rejection) -> Finding {
    let axis = match what {
        Rejection::Drive(axis) => axis,
        Rejection::Delay => 0,
        Rejection::Tool => -1,
        Rejection::Values => -2,
    };
    Finding { fault: Fault::CommissionRejected, numbers: Numbers { axis, ..Numbers::START } }
}

impl Fault {
    /// How the machine is brought to rest. `None` asks for nothing: the gentlest, which any other one outweighs.
    pub fn safe_end(self) -> SafeEnd {
        match self {
            // where the axes are is known and they do what they are told
            Self::None
            | Self::PatternMismatch
            | Self::WrongDelay
            | Self::InvalidInput
            | Self::LostSpindle
            | Self::SpindleJump
            | Self::FrozenSpindle
            | Self::SpindleSlow
            | Self::NoCut
            | Self::NoProgress
            | Self::NoPart
            | Self::UnexpectedContact
            | Self::FrozenContact => SafeEnd::Retract,
            Self::PatternTooLarge
            | Self::BankEmpty
            | Self::CommissionRejected
            | Self::NoTouches
            | Self::Misplaced
            | Self::TouchMismatch => SafeEnd::Stop,
            // a command would be one for another place or another drive
            Self::LostReading
            | Self::ReadingJump
            | Self::FrozenReading
            | Self::Oscillation
            | Self::DriveSign
            | Self::WeakDrive
            | Self::FollowingError
            | Self::LongStep => SafeEnd::DriveOff,
        }
    }
}

/// The numbers behind a fault, for the log.
pub fn numbers(Vars { input, output, in_force: p, .. }: &Vars) -> String {
    let Numbers { axis, value, limit, share } = output.numbers;
    let row = format!("for more than `limits.lost_samples` = `{}` samples", p.limits.lost_samples);
    match output.fault {
        Fault::None | Fault::BankEmpty | Fault::NoTouches => String::new(),
        Fault::InvalidInput => format!(": `speed_override` = `{}` {row}", input.speed_override),
        Fault::ReadingJump if limit > 0.0 => {
            format!(": axis {axis} has lost `{value:.6} {unit}` in steps, limit `{limit:.6} {unit}`", unit = unit(axis))
        }
        Fault::ReadingJump | Fault::LostReading => {
            let position = axis.checked_sub(1).and_then(|i| input.axis.get(i as usize)).map_or(0.0, |i| i.position);
            format!(": `axis{axis}.position` = `{position} {}` {row}", unit(axis))
        }
        Fault::SpindleJump | Fault::LostSpindle => format!(": `spindle_speed` = `{} rad/s` {row}", input.spindle_speed),
        Fault::FrozenSpindle => format!(": `spindle_speed` stands for `{value:.2} s`, limit `{limit:.2} s`"),
        Fault::FrozenReading if share.is_none() => {
            format!(": axis {axis} stands for `{value:.2} s`, limit `{limit:.2} s`, and it flickered before")
        }
        Fault::FrozenReading
        | Fault::Oscillation
        | Fault::DriveSign
        | Fault::WeakDrive
        | Fault::FollowingError
        | Fault::PatternMismatch => of_axis(output),
        Fault::WrongDelay => {
            let who = if axis == 0 { "they answer".to_owned() } else { format!("axis {axis} answers") };
            format!(": {who} after `{value}` samples, `io_delay` = `{limit}`")
        }
        Fault::CommissionRejected => measured(p, output),
        Fault::NoPart => {
            format!(": touch {axis}: `{:.2} mm` on the way to it, limit `{:.2} mm`", 1e3 * value, 1e3 * limit)
        }
        Fault::UnexpectedContact => format!(": on the way to touch {axis} `contact` is true {row}"),
        Fault::FrozenContact => {
            format!(": touch {axis}: `contact` is true {row}, back at `{:.2} mm` of the way", 1e3 * value)
        }
        Fault::TouchMismatch if axis == 0 => ": there is no place of the part that they fit".to_owned(),
        Fault::TouchMismatch => format!(
            ": touch {axis} is `{:.1} um` beside where the others say, limit `{:.1} um`",
            1e6 * value,
            1e6 * limit
        ),
        Fault::Misplaced => match axis {
            1 => format!(": it is shifted by `{:.3} mm`, limit `{:.3} mm`", 1e3 * value, 1e3 * limit),
            2 => format!(": it is turned by `{:.3} mrad`, limit `{:.3} mrad`", 1e3 * value, 1e3 * limit),
            _ => format!(": the robot cannot follow the path `{value:.4} m` from its start, of `{limit:.4} m`"),
        },
        Fault::PatternTooLarge => format!(": limit `{} pulses`", p.limits.pulses_max),
        Fault::SpindleSlow => format!(": `spindle_speed` = `{value:.1} rad/s`, limit `{limit:.1} rad/s`"),
        Fault::LongStep => format!(": limit `{} s`", p.sample_period),
        Fault::NoCut => match share {
            Some(way) => format!(": idle for `{:.1} mm`, limit `{:.1} mm`", 1e3 * way, 1e3 * limit),
            None => format!(": it changed by `{value:.2} rad/s`, at least `{limit} rad/s`"),
        },
        Fault::NoProgress => format!(": `{value:.1} s`, limit `{limit:.1} s`"),
    }
}

/// What was measured and cannot be used, with its limits; what was told is in force again.
fn measured(p: &Parameters, output: &Output) -> String {
    let (m, axis) = (&output.measured, output.numbers.axis);
    if let Some(drive) = axis.checked_sub(1).and_then(|i| m.axis.get(i as usize)) {
        return format!(
            ": axis {axis}: gain `{:.4}`, deviation `{:.4}`, limits half and twice and `commission.deviation_max` = `{}` of it; \
             delay `{:.3}` samples, limits the `{:.0}` of all axes, less and more by 0.75; \
             lag `{:.2} ms`, deviation `{:.2} ms`, limits a tenth of a sample below 0, and \
             `commission.delay_deviation_max` = `{}` samples",
            drive.gain,
            drive.gain_deviation,
            p.commission.deviation_max,
            drive.delay,
            m.io_delay.round(),
            1e3 * drive.lag,
            1e3 * drive.lag_deviation,
            p.commission.delay_deviation_max,
        );
    }
    match axis {
        0 => format!(
            ": they answer after `{:.3}` samples, limits `{}` and `{}` for `io_delay` = `{}` as told",
            m.io_delay,
            delays(p.io_delay).start(),
            delays(p.io_delay).end(),
            p.io_delay
        ),
        -1 => format!(
            ": the tool idles at `{:.1} rad/s`, deviation `{:.2} rad/s`, limits half and twice `load.idle_speed` = `{:.1} rad/s` as told \
             and `commission.deviation_max` = `{}` of it",
            m.idle_speed, m.idle_speed_deviation, p.load.idle_speed, p.commission.deviation_max
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
    let Numbers { axis, value, limit, share } = output.numbers;
    let unit = unit(axis);
    let answer = share.map_or(String::new(), |share| format!("; it does `{share:.2}` of what it is told"));
    format!(": axis {axis} by `{value:.6} {unit}`, limit `{limit:.6} {unit}`{answer}")
}

#[cfg(test)]
mod tests {
    use super::*;

    const GOOD: Signs = Signs {
        inputs: Finding::NONE,
        axes: Finding::NONE,
        run: Finding::NONE,
        nothing_learned: false,
        commission: None,
        registration: Finding::NONE,
        tool: Finding::NONE,
        job: (7, 7),
    };

    #[test]
    fn each_sign_is_its_fault_and_the_cause_comes_first() {
        let p = Parameters::START;
        let plain = Finding::plain;
        let cases = [
            (GOOD, Fault::None),
            (Signs { job: (8, 7), ..GOOD }, Fault::NoProgress),
            (Signs { tool: plain(Fault::SpindleSlow), job: (8, 7), ..GOOD }, Fault::SpindleSlow),
            (Signs { nothing_learned: true, job: (8, 7), ..GOOD }, Fault::BankEmpty),
            (Signs { run: plain(Fault::PatternTooLarge), nothing_learned: true, ..GOOD }, Fault::PatternTooLarge),
            (Signs { axes: plain(Fault::WeakDrive), run: plain(Fault::NoCut), ..GOOD }, Fault::WeakDrive),
        ];
        for (signs, fault) in cases {
            assert_eq!(find(&p, &signs).fault, fault);
            let invalid = Signs { inputs: plain(Fault::InvalidInput), ..signs };
            assert_eq!(find(&p, &invalid).fault, Fault::InvalidInput);
        }
        assert_eq!(find(&p, &Signs { job: (800, 700), ..GOOD }).numbers.limit, 7.0);
    }

    #[test]
    fn what_is_not_under_control_is_switched_off_and_the_rest_ends_gently() {
        for fault in Fault::ALL {
            let expected = match fault {
                Fault::None | Fault::PatternMismatch | Fault::WrongDelay => SafeEnd::Retract,
                Fault::InvalidInput | Fault::LostSpindle | Fault::SpindleJump | Fault::FrozenSpindle => {
                    SafeEnd::Retract
                }
                Fault::SpindleSlow | Fault::NoCut | Fault::NoProgress => SafeEnd::Retract,
                Fault::NoPart | Fault::UnexpectedContact | Fault::FrozenContact => SafeEnd::Retract,
                Fault::PatternTooLarge | Fault::BankEmpty | Fault::CommissionRejected => SafeEnd::Stop,
                Fault::NoTouches | Fault::Misplaced | Fault::TouchMismatch => SafeEnd::Stop,
                _ => SafeEnd::DriveOff,
            };
            assert_eq!(fault.safe_end(), expected, "{fault:?}");
        }
    }

    #[test]
    fn a_fault_is_told_with_its_numbers_and_a_state_without() {
        let mut vars = <Vars as fmi2_export::Interface>::START;
        assert_eq!(numbers(&vars), "");
        vars.output.fault = Fault::WeakDrive;
        vars.output.numbers = Numbers { axis: 3, value: 0.0025, limit: 0.002, share: Some(0.3) };
        assert_eq!(numbers(&vars), ": axis 3 by `0.002500 m`, limit `0.002000 m`; it does `0.30` of what it is told");
        vars.output.fault = Fault::FrozenSpindle;
        vars.output.numbers = Numbers { value: 0.51, limit: 0.5, ..Numbers::START };
        assert_eq!(numbers(&vars), ": `spindle_speed` stands for `0.51 s`, limit `0.50 s`");
        vars.output.fault = Fault::SpindleSlow;
        vars.output.numbers = Numbers { value: 900.0, limit: 1675.5, ..Numbers::START };
        assert_eq!(numbers(&vars), ": `spindle_speed` = `900.0 rad/s`, limit `1675.5 rad/s`");
        for fault in Fault::ALL {
            vars.output.fault = *fault;
            let silent = matches!(fault, Fault::None | Fault::BankEmpty | Fault::NoTouches);
            assert_eq!(numbers(&vars).is_empty(), silent, "{fault:?}");
        }
    }

    #[test]
    fn a_rejected_commission_tells_what_it_has_measured_and_the_limits() {
        let mut vars = <Vars as fmi2_export::Interface>::START;
        vars.output.fault = Fault::CommissionRejected;
        vars.output.measured.io_delay = 3.21;
        let drive = &mut vars.output.measured.axis[1];
        (drive.gain, drive.gain_deviation, drive.delay, drive.lag_deviation) = (0.81, 0.003, 2.5, 1e-4);
        vars.output.measured.idle_speed = 123.4;
        vars.in_force.learn.lead_in = 2;
        for (what, parts) in [
            (
                Rejection::Drive(2),
                ["axis 2: gain `0.8100`, deviation `0.0030`", "`commission.deviation_max` = `0.002`", "`2.500`"],
            ),
            (Rejection::Delay, ["after `3.210` samples", "limits `0` and `3`", "`io_delay` = `1` as told"]),
            (
                Rejection::Tool,
                ["idles at `123.4 rad/s`", "`load.idle_speed` = `1885.0 rad/s` as told", "`0.002` of it"],
            ),
            (Rejection::Values, ["parameter `learn.lead_in` would be `2`", "must be at least `", "do not fit"]),
        ] {
            let found = find(&vars.in_force, &Signs { commission: Some(what), job: (8, 7), ..GOOD });
            assert_eq!(found.fault, Fault::CommissionRejected);
            vars.output.numbers = found.numbers;
            let told = numbers(&vars);
            assert!(parts.iter().all(|part| told.contains(part)), "{told}");
        }
    }

    #[test]
    fn each_fault_is_told_in_its_own_words() {
        let mut vars = <Vars as fmi2_export::Interface>::START;
        let plain = Numbers { value: 2.5, limit: 1.25, ..Numbers::START };
        let axis = Numbers { axis: 1, ..plain };
        let told = [
            (
                Fault::SpindleJump,
                plain,
                ": `spindle_speed` = `1885 rad/s` for more than `limits.lost_samples` = `3` samples",
            ),
            (
                Fault::LostReading,
                axis,
                ": `axis1.position` = `0 rad` for more than `limits.lost_samples` = `3` samples",
            ),
            (Fault::FrozenSpindle, plain, ": `spindle_speed` stands for `2.50 s`, limit `1.25 s`"),
            (Fault::ReadingJump, axis, ": axis 1 has lost `2.500000 rad` in steps, limit `1.250000 rad`"),
            (Fault::FrozenReading, axis, ": axis 1 stands for `2.50 s`, limit `1.25 s`, and it flickered before"),
            (
                Fault::FrozenReading,
                Numbers { share: Some(0.0), ..axis },
                ": axis 1 by `2.500000 rad`, limit `1.250000 rad`; it does `0.00` of what it is told",
            ),
            (Fault::WrongDelay, plain, ": they answer after `2.5` samples, `io_delay` = `1.25`"),
            (Fault::WrongDelay, axis, ": axis 1 answers after `2.5` samples, `io_delay` = `1.25`"),
            (Fault::PatternTooLarge, plain, ": limit `32767 pulses`"),
            (Fault::LongStep, plain, ": limit `0.01 s`"),
            (Fault::NoCut, plain, ": it changed by `2.50 rad/s`, at least `1.25 rad/s`"),
            (Fault::NoCut, Numbers { share: Some(0.25), ..plain }, ": idle for `250.0 mm`, limit `1250.0 mm`"),
            (Fault::NoProgress, plain, ": `2.5 s`, limit `1.2 s`"),
            (Fault::NoPart, axis, ": touch 1: `2500.00 mm` on the way to it, limit `1250.00 mm`"),
            (
                Fault::UnexpectedContact,
                axis,
                ": on the way to touch 1 `contact` is true for more than `limits.lost_samples` = `3` samples",
            ),
            (
                Fault::FrozenContact,
                axis,
                ": touch 1: `contact` is true for more than `limits.lost_samples` = `3` samples, back at `2500.00 mm` of the way",
            ),
            (Fault::TouchMismatch, plain, ": there is no place of the part that they fit"),
            (
                Fault::TouchMismatch,
                axis,
                ": touch 1 is `2500000.0 um` beside where the others say, limit `1250000.0 um`",
            ),
            (Fault::Misplaced, axis, ": it is shifted by `2500.000 mm`, limit `1250.000 mm`"),
            (
                Fault::Misplaced,
                Numbers { axis: 2, ..plain },
                ": it is turned by `2500.000 mrad`, limit `1250.000 mrad`",
            ),
            (
                Fault::Misplaced,
                Numbers { axis: 3, ..plain },
                ": the robot cannot follow the path `2.5000 m` from its start, of `1.2500 m`",
            ),
        ];
        for (fault, numbers_of, expected) in told {
            (vars.output.fault, vars.output.numbers) = (fault, numbers_of);
            assert_eq!(numbers(&vars), expected, "{fault:?}");
        }
        vars.output.fault = Fault::LostSpindle;
        vars.input.spindle_speed = f64::INFINITY;
        assert!(numbers(&vars).contains("`spindle_speed` = `inf rad/s`"));
        vars.output.fault = Fault::InvalidInput;
        vars.input.speed_override = f64::NAN;
        assert!(numbers(&vars).contains("`speed_override` = `NaN`"));
    }
}

//! Checks the inputs of a sample: what is usable, what replaces the rest, and what is wrong.
//!
//! A value that is not a number, or beyond any machine, is bridged like a jump. Before the first good value nothing can
//! replace a measurement; the override is then 0. The first measurement may be the bad one: if the second differs, the
//! position of the axis is unknown until two agree.

use control_blocks::{Consecutive, JumpGuard, Reach, is_plausible};
use serde::{Deserialize, Serialize};

use crate::interface::{Fault, Input, Parameters};
use crate::monitoring::finding::{Finding, Numbers};
use crate::path::kinematics::{AXES, Joints};

/// No axis is farther away, rad or m.
const POSITION_MAX: f64 = 1e4;
/// Largest speed of any tool, rad/s.
const SPINDLE_MAX: f64 = 1e5;
/// An axis that is reported to move may stand, or go the other way as fast.
const REVERSED: f64 = 2.0;
/// Ratio of its peak that the speed of an axis keeps for a sample longer.
const FADING: f64 = 0.8;

/// The usable inputs: those of this sample, or the last good ones.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct Reading {
    /// Encoder measurements, rad or m.
    pub positions: Joints,
    /// Tool speed, rad/s.
    pub spindle_speed: f64,
    /// Part of the programmed speed, 0 to 1.
    pub speed_override: f64,
}

/// Commanded motion and state of the controller, on which the accepted change of an input depends.
#[derive(Clone, Copy, Debug)]
pub struct ReadingContext<'a> {
    /// Motion that was commanded for the sample that ends now, rad or m.
    pub motions: &'a Joints,
    /// The loops are closed: nothing else moves the axes.
    pub closed: bool,
    /// The tool cuts.
    pub cuts: bool,
}

/// The values used last; by default none, before the first good sample.
#[derive(Clone, Debug, Default, Serialize, Deserialize)]
pub struct Reader {
    used: Option<Reading>,
    axes: [AxisReader; AXES],
    spindle: JumpGuard,
    /// samples with an override that is no number
    invalid: Consecutive,
}

/// One encoder: what the commands do not explain of it may not jump.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
struct AxisReader {
    guard: JumpGuard,
    /// motion that was commanded so far, rad or m
    carried: f64,
    /// fastest motion in a sample, fading
    fastest: f64,
    /// two measurements consecutive have agreed
    confirmed: bool,
    /// measurements that were elsewhere than the one before, as long as no two have agreed
    disputed: u32,
}

impl AxisReader {
    /// The position to use: the measurement, or where the commands have brought the axis since the last accepted one.
    fn read(&mut self, position: f64, motion: f64, anywhere: f64, spread: f64) -> f64 {
        self.carried += motion;
        self.fastest = motion.abs().max(FADING * self.fastest);
        let reach = Reach { motion: (REVERSED * self.fastest).max(anywhere), spread };
        let unexplained = position - self.carried;
        if !self.confirmed && self.guard.accepted().is_some() && position.is_finite() {
            self.confirmed = self.guard.reaches(unexplained, reach);
            self.disputed = self.disputed.saturating_add(u32::from(!self.confirmed));
        }
        let motion = if self.confirmed { reach.motion } else { f64::INFINITY };
        let accepted = self.guard.update(unexplained, Reach { motion, ..reach });
        // the difference does not return to the last bit
        if self.guard.doubted() == 0 { position } else { accepted + self.carried }
    }

    /// Whether it is known where the axis is.
    fn placed(&self) -> bool {
        self.guard.accepted().is_some() && (self.confirmed || self.disputed == 0)
    }

    /// Measurements consecutive that cannot be used.
    fn lost(&self) -> u32 {
        self.guard.doubted().max(if self.confirmed { 0 } else { self.disputed })
    }
}

impl Reader {
    /// The positions that were used last, rad or m; zeros before.
    pub fn positions(&self) -> Joints {
        self.used.unwrap_or_default().positions
    }

    /// Whether it is known where all axes are.
    pub fn placed(&self) -> bool {
        self.axes.iter().all(AxisReader::placed)
    }

    /// Reads one sample: what to use, and what is wrong with it.
    pub fn read(&mut self, p: &Parameters, input: &Input, context: &ReadingContext) -> (Reading, Finding) {
        let number = |value: f64, maximum: f64| if is_plausible(value, maximum) { value } else { f64::NAN };
        let positions = input.axis.map(|axis| number(axis.position, POSITION_MAX));
        let speed = number(input.spindle_speed, SPINDLE_MAX);
        let valid = input.speed_override.is_finite();
        let placed = self.used.is_some() || positions.iter().all(|position| position.is_finite());
        self.invalid.update(!valid);
        let now = Reading {
            positions: std::array::from_fn(|i| self.read_axis(p, i, positions[i], context)),
            spindle_speed: self.read_spindle(p, speed, context.cuts),
            speed_override: if valid {
                input.speed_override.clamp(0.0, 1.0)
            } else {
                self.used.unwrap_or_default().speed_override
            },
        };
        if placed {
            self.used = Some(now);
        }
        (self.used.unwrap_or_default(), self.doubted(p, input))
    }

    fn read_axis(&mut self, p: &Parameters, i: usize, position: f64, context: &ReadingContext) -> f64 {
        // by hand, or while the drives run out
        let anywhere = if context.closed { 0.0 } else { p.axis[i].velocity_max * p.sample_period };
        self.axes[i].read(position, context.motions[i], anywhere, p.limits.axis[i].error_max)
    }

    fn read_spindle(&mut self, p: &Parameters, speed: f64, cuts: bool) -> f64 {
        let motion = if cuts { p.limits.spindle_slew * p.sample_period } else { SPINDLE_MAX };
        self.spindle.update(speed, Reach { motion, spread: 0.0 })
    }

    /// The input that was doubted too long.
    fn doubted(&self, p: &Parameters, input: &Input) -> Finding {
        let bridged = p.limits.lost_samples.unsigned_abs();
        let (fault, axis) = if let Some(i) = self.axes.iter().position(|axis| axis.lost() > bridged) {
            let number = is_plausible(input.axis[i].position, POSITION_MAX);
            (if number { Fault::PositionJump } else { Fault::PositionLost }, i as i32 + 1)
        } else if self.spindle.doubted() > bridged {
            let number = is_plausible(input.spindle_speed, SPINDLE_MAX);
            (if number { Fault::SpindleJump } else { Fault::SpindleLost }, 0)
        } else if self.invalid.count() > bridged {
            (Fault::InvalidInput, 0)
        } else {
            return Finding::NONE;
        };
        Finding { fault, numbers: Numbers { axis, ..Numbers::START } }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::interface::AxisInput;
    use control_blocks::with_nonsense;

    const REST: ReadingContext = ReadingContext { motions: &[0.0; AXES], closed: true, cuts: true };

    fn at(position: f64) -> Input {
        Input { axis: [AxisInput { position }; AXES], spindle_speed: 1800.0, ..Input::START }
    }

    #[test]
    fn nonsense_in_any_input_is_bridged_and_has_a_name_when_it_lasts() {
        let p = Parameters::START;
        let good = Input { speed_override: 0.7, ..at(0.5) };
        let changes: [fn(&mut Input) -> &mut f64; 4] = [
            |i| &mut i.axis[0].position,
            |i| &mut i.axis[5].position,
            |i| &mut i.spindle_speed,
            |i| &mut i.speed_override,
        ];
        let absurd = changes[..3].iter().map(|field| {
            let mut bad = good.clone();
            *field(&mut bad) = 1e5 + 1.0;
            bad
        });
        for bad in with_nonsense(&good, &changes).into_iter().chain(absurd) {
            // a tool that does not cut may reach any speed in a sample
            for context in [REST, ReadingContext { cuts: false, ..REST }] {
                let placed = bad.axis.iter().all(|axis| is_plausible(axis.position, POSITION_MAX));
                let fault = if !placed {
                    Fault::PositionLost
                } else if is_plausible(bad.spindle_speed, SPINDLE_MAX) {
                    Fault::InvalidInput
                } else {
                    Fault::SpindleLost
                };
                // nothing to bridge a measurement with
                let mut reader = Reader::default();
                let (nothing, found) = reader.read(&p, &bad, &context);
                assert_eq!((nothing.positions, found), (if placed { [0.5; AXES] } else { [0.0; AXES] }, Finding::NONE));
                assert_eq!(
                    (nothing.speed_override > 0.0, nothing.spindle_speed > 0.0),
                    (placed && fault != Fault::InvalidInput, fault == Fault::InvalidInput)
                );
                assert_eq!(reader.placed(), placed);
                let faults = [0; 3].map(|_| reader.read(&p, &bad, &context).1.fault);
                assert_eq!(faults, [Fault::None, Fault::None, fault]);
                let mut reader = Reader::default();
                let (used, _) = reader.read(&p, &good, &context);
                for _ in 0..3 {
                    assert_eq!(reader.read(&p, &bad, &context), (used, Finding::NONE), "{bad:?}");
                }
                let (reading, found) = reader.clone().read(&p, &bad, &context);
                assert_eq!((reading, found.fault), (used, fault), "{bad:?}");
                assert_eq!(reader.read(&p, &good, &context), (used, Finding::NONE));
            }
        }
    }

    #[test]
    fn a_reading_that_is_lost_is_reported_with_its_axis() {
        let p = Parameters::START;
        for axis in [3, 0] {
            let mut reader = Reader::default();
            reader.read(&p, &at(0.5), &REST);
            let mut lost = at(0.5);
            *(if axis == 3 { &mut lost.axis[2].position } else { &mut lost.spindle_speed }) = f64::NAN;
            let found = [0; 4].map(|_| reader.read(&p, &lost, &REST).1);
            let fault = if axis == 3 { Fault::PositionLost } else { Fault::SpindleLost };
            assert_eq!((found[3].fault, found[3].numbers.axis), (fault, axis));
        }
    }

    #[test]
    fn a_first_sample_that_is_wrong_is_discarded_when_two_agree() {
        let p = Parameters::START;
        for (wrong, first) in [(0.53, true), (-0.2, true), (0.53, false)] {
            let mut reader = Reader::default();
            let readings = if first { [wrong, 0.5, 0.5, 0.5, 0.5] } else { [0.5, wrong, 0.5, 0.5, 0.5] };
            let placed = readings.map(|position| {
                assert_eq!(reader.read(&p, &at(position), &REST).1, Finding::NONE);
                reader.placed()
            });
            assert_eq!(placed, [true, false, first, true, true], "{wrong} {first}");
            for _ in 0..10 {
                let (reading, found) = reader.read(&p, &at(0.5), &REST);
                assert_eq!((reading.positions, found), ([0.5; AXES], Finding::NONE));
            }
        }
    }

    #[test]
    fn readings_of_which_no_two_agree_are_reported() {
        let (p, mut reader) = (Parameters::START, Reader::default());
        let found = [0.1, 0.2, 0.1, 0.3, 0.1].map(|position| reader.read(&p, &at(position), &REST).1.fault);
        assert_eq!(found, [Fault::None, Fault::None, Fault::None, Fault::None, Fault::PositionJump]);
        assert!(!reader.placed());
    }

    #[test]
    fn the_override_is_limited() {
        for (value, used) in [(-1.0, 0.0), (0.3, 0.3), (7.0, 1.0)] {
            let input = Input { speed_override: value, ..Input::START };
            assert_eq!(Reader::default().read(&Parameters::START, &input, &REST).0.speed_override, used);
        }
    }

    #[test]
    fn one_sample_where_no_axis_can_be_is_bridged_along_the_commands() {
        let p = Parameters::START;
        let mut reader = Reader::default();
        let moving = ReadingContext { motions: &[1e-3; AXES], ..REST };
        for k in 0..10 {
            let position = 0.5 + 1e-3 * f64::from(k);
            let (reading, found) = reader.read(&p, &at(position), &moving);
            assert_eq!((reading.positions, found), ([position; AXES], Finding::NONE));
        }
        for bad in [0.53, -0.2, 1.7] {
            let mut reader = reader.clone();
            let (reading, found) = reader.read(&p, &at(bad), &moving);
            assert_eq!(found, Finding::NONE);
            assert!(reading.positions.iter().all(|position| (position - 0.51).abs() < 1e-12), "{reading:?}");
            assert_eq!(reader.read(&p, &at(0.511), &moving).0.positions, [0.511; AXES]);
        }
    }

    #[test]
    fn a_reading_that_stays_away_is_reported_with_its_axis() {
        let p = Parameters::START;
        let mut reader = Reader::default();
        for _ in 0..2 {
            reader.read(&p, &at(0.5), &REST);
        }
        let mut moved = at(0.5);
        moved.axis[2].position = 0.52;
        let found = [0; 4].map(|_| reader.read(&p, &moved, &REST).1);
        assert_eq!(found[..3], [Finding::NONE; 3]);
        assert_eq!((found[3].fault, found[3].numbers.axis), (Fault::PositionJump, 3));
    }

    #[test]
    fn a_drive_that_does_not_move_or_runs_away_is_no_jump() {
        let p = Parameters::START;
        for ratio in [0.0, -1.0, 2.0] {
            let mut reader = Reader::default();
            for k in 0..100 {
                let position = 0.5 + ratio * 5e-3 * f64::from(k);
                let (reading, found) =
                    reader.read(&p, &at(position), &ReadingContext { motions: &[5e-3; AXES], ..REST });
                assert_eq!((reading.positions[2], found), (position, Finding::NONE), "{ratio}, {k}");
            }
        }
    }

    #[test]
    fn without_a_closed_loop_the_axes_are_moved_by_hand() {
        let p = Parameters::START;
        let mut reader = Reader::default();
        for k in 0..50 {
            let (_, found) = reader.read(&p, &at(9e-3 * f64::from(k)), &ReadingContext { closed: false, ..REST });
            assert_eq!(found, Finding::NONE);
        }
        // no hand moves an axis by 0.1 m in a sample
        let (reading, _) = reader.read(&p, &at(0.541), &ReadingContext { closed: false, ..REST });
        assert_eq!(reading.positions, [9e-3 * 49.0; AXES]);
    }

    #[test]
    fn a_tool_that_starts_is_accepted_and_one_bad_sample_while_it_cuts_is_not() {
        let p = Parameters::START;
        let mut reader = Reader::default();
        for speed in [0.0, 1800.0] {
            let input = Input { spindle_speed: speed, ..at(0.5) };
            assert_eq!(reader.read(&p, &input, &ReadingContext { cuts: false, ..REST }).0.spindle_speed, speed);
        }
        let lost = Input { spindle_speed: 0.0, ..at(0.5) };
        for _ in 0..3 {
            let (reading, found) = reader.read(&p, &lost, &REST);
            assert_eq!((reading.spindle_speed, found), (1800.0, Finding::NONE));
        }
        let (_, found) = reader.read(&p, &lost, &REST);
        assert_eq!((found.fault, found.numbers.axis), (Fault::SpindleJump, 0));
    }
}

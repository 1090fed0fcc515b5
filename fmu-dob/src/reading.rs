//! Checks the inputs of a sample: what can be used, and what is wrong with the rest.

use control_blocks::{Consecutive, Edge, believable};
use serde::{Deserialize, Serialize};

use crate::interface::{Input, Parameters};

/// No machine has a longer axis, m.
const POSITION_MAX: f64 = 1e3;
/// No spindle is faster, rad/s.
const SPEED_MAX: f64 = 1e5;

/// The usable part of the inputs.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Reading {
    /// Position towards the workpiece, m; none while it is lost.
    pub position: Option<f64>,
    /// Spindle speed, rad/s; the last good one if the input is not.
    pub spindle_speed: f64,
    /// `enable` is set.
    pub enabled: bool,
    /// Rising edge of `enable`.
    pub begin: bool,
    /// Rising edge of `reset_fault`.
    pub reset: bool,
    /// The position is there for the first time, or again after too long.
    pub found: bool,
    /// A number is none, or out of any plausible range.
    pub invalid: bool,
    /// Samples in a row without a position.
    pub lost: u32,
}

/// Remembers what one reading needs from the ones before; by default nothing, before the first sample.
#[derive(Clone, Debug, Default, Serialize, Deserialize)]
pub struct Reader {
    known: bool,
    lost: Consecutive,
    spindle_speed: f64,
    enable: Edge,
    reset_fault: Edge,
}

impl Parameters {
    /// Sign of the approach along the encoder axis, +1 or -1.
    pub fn direction(&self) -> f64 {
        f64::from(self.approach.direction)
    }
}

impl Reader {
    /// Reads one sample.
    pub fn read(&mut self, p: &Parameters, input: &Input) -> Reading {
        let position_good = believable(input.position, POSITION_MAX);
        let speed_good = believable(input.spindle_speed, SPEED_MAX);
        if speed_good {
            self.spindle_speed = input.spindle_speed;
        }
        let position = (input.position_valid && position_good).then_some(p.direction() * input.position);
        let lost_too_long = self.lost.count() > p.limits.lost_samples.unsigned_abs();
        let found = position.is_some() && (!self.known || lost_too_long);
        self.known |= position.is_some();
        Reading {
            position,
            spindle_speed: self.spindle_speed,
            enabled: input.enable,
            begin: self.enable.rises(input.enable),
            reset: self.reset_fault.rises(input.reset_fault),
            found,
            invalid: !speed_good || (input.position_valid && !position_good),
            lost: self.lost.update(position.is_none()),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const LOST: Input = Input { position_valid: false, ..Input::START };

    fn at(position: f64) -> Input {
        Input { position, ..Input::START }
    }

    fn first(input: &Input) -> Reading {
        Reader::default().read(&Parameters::START, input)
    }

    #[test]
    fn a_position_is_found_at_first_and_after_more_than_the_bridged_samples() {
        let mut p = Parameters::START;
        p.limits.lost_samples = 3;
        let mut reader = Reader::default();
        assert!(reader.read(&p, &at(0.1)).found);
        assert!(!reader.read(&p, &at(0.1)).found);
        for k in 1..=3 {
            assert_eq!(reader.read(&p, &LOST).lost, k);
        }
        assert!(!reader.clone().read(&p, &at(0.1)).found);
        assert_eq!(reader.read(&p, &LOST).lost, 4);
        assert!(reader.read(&p, &at(0.1)).found);
    }

    #[test]
    fn nonsense_is_invalid_and_never_used() {
        for nonsense in [f64::NAN, f64::INFINITY, f64::NEG_INFINITY, 1e300] {
            let reading = first(&at(nonsense));
            assert!(reading.invalid);
            assert_eq!(reading.position, None);
            let reading = first(&Input { spindle_speed: nonsense, ..Input::START });
            assert!(reading.invalid);
            assert_eq!(reading.spindle_speed, 0.0);
        }
    }

    #[test]
    fn nonsense_while_invalid_is_only_lost() {
        let reading = first(&Input { position: f64::NAN, ..LOST });
        assert_eq!((reading.invalid, reading.lost), (false, 1));
    }

    #[test]
    fn enable_and_reset_count_on_their_edges() {
        let mut reader = Reader::default();
        let both = Input { enable: true, reset_fault: true, ..Input::START };
        let edges: Vec<_> = [&both, &both, &Input::START, &both]
            .map(|input| reader.read(&Parameters::START, input))
            .map(|reading| (reading.enabled, reading.begin, reading.reset))
            .into();
        assert_eq!(edges, [(true, true, true), (true, false, false), (false, false, false), (true, true, true)]);
    }

    #[test]
    fn direction_turns_the_axis() {
        let mut p = Parameters::START;
        p.approach.direction = -1;
        assert_eq!(Reader::default().read(&p, &at(0.2)).position, Some(-0.2));
    }
}

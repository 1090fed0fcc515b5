//! Checks the inputs of a sample: what can be used, and what is wrong with the rest.

use control_blocks::{Edge, believable};
use serde::{Deserialize, Serialize};

use crate::machine::Fault;
use crate::signals::Input;

/// Invalid samples in a row that are bridged without a fault.
const LOST_TICKS: u32 = 3;
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
    /// Rising edge of `start`, not while `abort` is set.
    pub start: bool,
    /// The position is there for the first time, or again after too long.
    pub found: bool,
    /// What is wrong.
    pub fault: Option<Fault>,
}

/// Remembers what one reading needs from the ones before; by default nothing, before the first sample.
#[derive(Clone, Debug, Default, Serialize, Deserialize)]
pub struct Reader {
    known: bool,
    lost: u32,
    spindle_speed: f64,
    start: Edge,
}

impl Reader {
    /// Reads one sample of an axis that approaches in `direction` (+1 or -1).
    pub fn read(&mut self, direction: f64, input: &Input) -> Reading {
        let position_good = believable(input.position, POSITION_MAX);
        let speed_good = believable(input.spindle_speed, SPEED_MAX);
        if speed_good {
            self.spindle_speed = input.spindle_speed;
        }
        let position = (input.position_valid && position_good).then_some(direction * input.position);
        let found = position.is_some() && (!self.known || self.lost > LOST_TICKS);
        self.known |= position.is_some();
        self.lost = if position.is_some() { 0 } else { self.lost.saturating_add(1) };
        let start = self.start.rises(input.start) && !input.abort;
        let invalid = !speed_good || (input.position_valid && !position_good);
        let fault =
            if invalid { Some(Fault::InvalidInput) } else { (self.lost > LOST_TICKS).then_some(Fault::LostSync) };
        Reading { position, spindle_speed: self.spindle_speed, start, found, fault }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn at(position: f64) -> Input {
        Input { position, ..Input::START }
    }

    const LOST: Input = Input { position_valid: false, ..Input::START };

    #[test]
    fn the_fourth_invalid_sample_is_lost_sync() {
        let mut reader = Reader::default();
        assert!(reader.read(1.0, &at(0.1)).found);
        for _ in 0..3 {
            assert_eq!(reader.read(1.0, &LOST).fault, None);
        }
        assert!(!reader.clone().read(1.0, &at(0.1)).found);
        assert_eq!(reader.read(1.0, &LOST).fault, Some(Fault::LostSync));
        assert!(reader.read(1.0, &at(0.1)).found);
    }

    #[test]
    fn nonsense_is_invalid_and_never_used() {
        for nonsense in [f64::NAN, f64::INFINITY, f64::NEG_INFINITY, 1e300] {
            let mut reader = Reader::default();
            let reading = reader.read(1.0, &at(nonsense));
            assert_eq!(reading.fault, Some(Fault::InvalidInput));
            assert_eq!(reading.position, None);
            let speed = Input { spindle_speed: nonsense, ..Input::START };
            let reading = reader.read(1.0, &speed);
            assert_eq!(reading.fault, Some(Fault::InvalidInput));
            assert_eq!(reading.spindle_speed, 0.0);
        }
    }

    #[test]
    fn nonsense_while_invalid_is_only_lost() {
        let input = Input { position: f64::NAN, ..LOST };
        assert_eq!(Reader::default().read(1.0, &input).fault, None);
    }

    #[test]
    fn start_is_an_edge_and_abort_masks_it() {
        let mut reader = Reader::default();
        let high = Input { start: true, ..Input::START };
        let masked = Input { abort: true, ..high.clone() };
        let edges: Vec<bool> =
            [&high, &high, &Input::START, &masked, &high].iter().map(|input| reader.read(1.0, input).start).collect();
        assert_eq!(edges, [true, false, false, false, false]);
    }

    #[test]
    fn direction_turns_the_axis() {
        assert_eq!(Reader::default().read(-1.0, &at(0.2)).position, Some(-0.2));
    }
}

//! Validation of the measurement, and edges of the Boolean inputs.

use control_blocks::{Consecutive, Edge, is_plausible, ticks};
use serde::{Deserialize, Serialize};

use crate::interface::{Input, Parameters};

/// Limit of a plausible position, m.
const POSITION_MAX: f64 = 100.0;

/// The usable part of the inputs.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Reading {
    /// Position, the last valid one if this one is invalid, m.
    pub position: f64,
    /// The position of this sample is valid.
    pub valid: bool,
    /// This is the first valid position.
    pub first: bool,
    /// The slide has stayed within `settle.band` for `settle.time`.
    pub at_rest: bool,
    /// `enable` is set.
    pub enabled: bool,
    /// Rising edge of `enable`.
    pub start: bool,
    /// Rising edge of `reset_fault`.
    pub reset: bool,
}

/// State of the validation between two samples; the default is the state before the first sample.
#[derive(Clone, Debug, Default, Serialize, Deserialize)]
pub struct Reader {
    before: Option<f64>,
    /// Position at the last motion, m.
    rest_position: f64,
    still: Consecutive,
    enable: Edge,
    reset: Edge,
}

impl Reader {
    /// Validates one sample.
    pub fn read(&mut self, p: &Parameters, input: &Input) -> Reading {
        let valid = is_plausible(input.position, POSITION_MAX);
        let first = valid && self.before.is_none();
        if valid {
            self.before = Some(input.position);
        }
        let position = self.before.unwrap_or(0.0);
        let still = self.still.update(valid && (position - self.rest_position).abs() <= p.settle.band);
        if still == 0 {
            self.rest_position = position;
        }
        Reading {
            position,
            valid,
            first,
            at_rest: still > ticks(p.settle.time, p.sample_period),
            enabled: input.enable,
            start: self.enable.rises(input.enable),
            reset: self.reset.rises(input.reset_fault),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const P: Parameters = Parameters::START;

    fn at(position: f64) -> Input {
        Input { position, ..Input::START }
    }

    #[test]
    fn invalid_positions_are_never_used() {
        let mut reader = Reader::default();
        assert!(reader.read(&P, &at(0.5)).first);
        for invalid in [f64::NAN, f64::INFINITY, f64::NEG_INFINITY, 1e300] {
            let reading = reader.read(&P, &at(invalid));
            assert_eq!((reading.position, reading.valid, reading.first), (0.5, false, false));
        }
    }

    #[test]
    fn rest_needs_time_and_a_slow_drift_is_no_rest() {
        let mut reader = Reader::default();
        let mut rests = |velocity: f64| (0..200).map(|k| reader.read(&P, &at(velocity * f64::from(k))).at_rest).last();
        assert_eq!(rests(0.0), Some(true));
        assert_eq!(rests(1e-6), Some(false), "20 um in 20 samples");
    }
}

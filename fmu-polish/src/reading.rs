//! Checks the inputs of a sample: the usable values, and whether they can be believed.

use control_blocks::{Edge, believable};
use nalgebra::Vector3;
use serde::{Deserialize, Serialize};

use crate::interface::Input;

/// No such machine has a longer axis, m.
const POSITION_MAX: f64 = 1e3;
/// No such sensor measures more, N.
const FORCE_MAX: f64 = 1e5;
/// Largest override; a larger one counts as this.
const OVERRIDE_MAX: f64 = 2.0;

/// The usable inputs: those of this sample, or the last good ones.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Reading {
    /// Ball centre by the encoders, m.
    pub position: Vector3<f64>,
    /// Raw force on the tool, N.
    pub force: Vector3<f64>,
    /// Factor of the feed, 0 to 2.
    pub feed_override: f64,
    /// Factor of the wanted force, 0 to 2.
    pub force_override: f64,
    /// `enable` is set.
    pub enabled: bool,
    /// `estop` is set.
    pub stopped: bool,
    /// Rising edge of `enable`.
    pub start: bool,
    /// Rising edge of `reset_fault`.
    pub reset: bool,
    /// Every input is believable.
    pub valid: bool,
}

/// Remembers the last good inputs; at the origin without force before the first sample.
#[derive(Clone, Debug, Serialize, Deserialize)]
pub struct Reader {
    good: Reading,
    enable: Edge,
    reset: Edge,
}

impl Reader {
    /// Before the first sample.
    pub fn new() -> Self {
        let good = Reading {
            position: Vector3::zeros(),
            force: Vector3::zeros(),
            feed_override: 1.0,
            force_override: 1.0,
            enabled: false,
            stopped: false,
            start: false,
            reset: false,
            valid: false,
        };
        Self { good, enable: Edge::default(), reset: Edge::default() }
    }

    /// Reads one sample.
    pub fn read(&mut self, input: &Input) -> Reading {
        let (position, force) = (input.position.vector(), input.force.vector());
        let all = |v: &Vector3<f64>, limit| v.iter().all(|value| believable(*value, limit));
        let valid = all(&position, POSITION_MAX)
            && all(&force, FORCE_MAX)
            && input.feed_override.is_finite()
            && input.force_override.is_finite();
        if valid {
            self.good.position = position;
            self.good.force = force;
            self.good.feed_override = input.feed_override.clamp(0.0, OVERRIDE_MAX);
            self.good.force_override = input.force_override.clamp(0.0, OVERRIDE_MAX);
        }
        Reading {
            enabled: input.enable,
            stopped: input.estop,
            start: self.enable.rises(input.enable),
            reset: self.reset.rises(input.reset_fault),
            valid,
            ..self.good.clone()
        }
    }
}

impl Default for Reader {
    fn default() -> Self {
        Self::new()
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::axes::Axes;
    use control_blocks::with_nonsense;

    #[test]
    fn nonsense_in_any_input_is_invalid_and_never_used() {
        let good = Input { position: Axes::all(1e-3), force: Axes::all(2.0), feed_override: 0.5, ..Input::START };
        let changes: [fn(&mut Input) -> &mut f64; 5] = [
            |i| &mut i.position.x,
            |i| &mut i.position.z,
            |i| &mut i.force.y,
            |i| &mut i.feed_override,
            |i| &mut i.force_override,
        ];
        for bad in with_nonsense(&good, &changes) {
            let mut reader = Reader::new();
            let before = reader.read(&good);
            assert!(before.valid);
            assert_eq!(reader.read(&bad), Reading { valid: false, ..before });
        }
    }

    #[test]
    fn overrides_are_limited_and_switches_are_edges() {
        let mut reader = Reader::new();
        let input = Input { feed_override: 7.0, force_override: -1.0, enable: true, ..Input::START };
        let first = reader.read(&input);
        assert_eq!((first.feed_override, first.force_override, first.start), (2.0, 0.0, true));
        assert!(!reader.read(&input).start);
    }
}

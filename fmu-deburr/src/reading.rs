//! Checks the inputs of a sample: what can be used, and whether something is wrong.

use control_blocks::{LastGood, believable};
use serde::{Deserialize, Serialize};

use crate::interface::Input;
use crate::path::kinematics::{AXES, Joints};

/// No axis is farther away, rad or m.
const POSITION_MAX: f64 = 1e4;
/// No tool turns faster, rad/s.
const SPINDLE_MAX: f64 = 1e5;

/// The usable inputs: those of this sample, or the last good ones.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct Reading {
    /// Encoder readings, rad or m.
    pub positions: Joints,
    /// Tool speed, rad/s.
    pub spindle_speed: f64,
    /// Part of the taught speed, 0 to 1.
    pub share: f64,
}

/// Remembers the last good inputs; zeros before the first sample.
#[derive(Clone, Debug, Serialize, Deserialize)]
pub struct Reader {
    good: LastGood<Reading>,
}

impl Reader {
    /// Before the first sample.
    pub const START: Self =
        Self { good: LastGood::new(Reading { positions: [0.0; AXES], spindle_speed: 0.0, share: 0.0 }) };

    /// The last good positions, rad or m.
    pub fn positions(&self) -> Joints {
        self.good.get().positions
    }

    /// Reads one sample; the flag says whether every input is believable.
    pub fn read(&mut self, input: &Input) -> (Reading, bool) {
        let now = Reading {
            positions: input.axis.map(|axis| axis.position),
            spindle_speed: input.spindle_speed,
            share: input.speed_override.clamp(0.0, 1.0),
        };
        let valid = now.positions.iter().all(|position| believable(*position, POSITION_MAX))
            && believable(now.spindle_speed, SPINDLE_MAX)
            && input.speed_override.is_finite();
        self.good.update(now, valid)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use control_blocks::with_nonsense;

    #[test]
    fn nonsense_in_any_input_is_invalid_and_never_used() {
        let good = Input { spindle_speed: 1800.0, speed_override: 0.7, ..Input::START };
        let changes: [fn(&mut Input) -> &mut f64; 4] = [
            |i| &mut i.axis[0].position,
            |i| &mut i.axis[5].position,
            |i| &mut i.spindle_speed,
            |i| &mut i.speed_override,
        ];
        for bad in with_nonsense(&good, &changes) {
            let mut reader = Reader::START;
            let before = reader.read(&good);
            assert_eq!((before.1, reader.read(&bad)), (true, (before.0, false)));
        }
    }

    #[test]
    fn the_override_is_limited() {
        for (value, share) in [(-1.0, 0.0), (0.3, 0.3), (7.0, 1.0)] {
            let mut reader = Reader::START;
            assert_eq!(reader.read(&Input { speed_override: value, ..Input::START }).0.share, share);
        }
    }
}

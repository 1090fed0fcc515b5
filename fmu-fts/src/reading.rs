//! Checks the inputs of a sample: what can be used, and what is wrong with the rest.

use control_blocks::{LastGood, believable};
use serde::{Deserialize, Serialize};

use crate::interface::Input;

/// No encoder counts more turns, rad.
const ANGLE_MAX: f64 = 1e9;
/// No machine has a longer axis, m.
const POSITION_MAX: f64 = 1e3;

/// The usable inputs: those of this sample, or the last good ones.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct Reading {
    /// Encoder angle b of the arm, rad.
    pub arm_angle: f64,
    /// Spindle angle theta, rad.
    pub spindle_angle: f64,
    /// Slide position x, m.
    pub slide_position: f64,
    /// Angle to hold, rad.
    pub hold_angle: f64,
    /// A calibration part is cut.
    pub cutting: bool,
}

/// Remembers the last good inputs; by default zeros, before the first sample.
#[derive(Clone, Debug, Default, Serialize, Deserialize)]
pub struct Reader {
    good: LastGood<Reading>,
}

impl Reader {
    /// Reads one sample; the flag says whether every input is believable.
    pub fn read(&mut self, input: &Input) -> (Reading, bool) {
        let now = Reading {
            arm_angle: input.arm_angle,
            spindle_angle: input.spindle_angle,
            slide_position: input.slide_position,
            hold_angle: input.hold_angle,
            cutting: input.calibration.cut,
        };
        let valid = believable(now.arm_angle, ANGLE_MAX)
            && believable(now.spindle_angle, ANGLE_MAX)
            && believable(now.slide_position, POSITION_MAX)
            && believable(now.hold_angle, ANGLE_MAX);
        self.good.update(now, valid)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use control_blocks::with_nonsense;

    #[test]
    fn nonsense_in_any_input_is_invalid_and_never_used() {
        let good = Input { arm_angle: 0.1, spindle_angle: 2.0, slide_position: 0.04, hold_angle: 0.3, ..Input::START };
        let changes: [fn(&mut Input) -> &mut f64; 4] =
            [|i| &mut i.arm_angle, |i| &mut i.spindle_angle, |i| &mut i.slide_position, |i| &mut i.hold_angle];
        for bad in with_nonsense(&good, &changes) {
            let mut reader = Reader::default();
            let before = reader.read(&good);
            assert_eq!((before.1, reader.read(&bad)), (true, (before.0, false)));
        }
    }

    #[test]
    fn before_the_first_good_sample_everything_is_zero() {
        let bad = Input { arm_angle: f64::NAN, ..Input::START };
        assert_eq!(Reader::default().read(&bad), (Reading::default(), false));
    }
}

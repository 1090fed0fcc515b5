//! Launch of a push: the remaining angle crosses the lead angle.

use std::f64::consts::FRAC_PI_2;

use serde::{Deserialize, Serialize};

use control_blocks::wrap;

/// Detects that a remaining angle becomes zero, once per revolution.
///
/// A window around zero is not sufficient: 20 rpm is exactly 300 control periods per revolution, so that a ring can
/// miss it in every revolution.
#[derive(Clone, Debug, Default, Serialize, Deserialize)]
pub struct Crossing {
    left: Option<f64>,
}

impl Crossing {
    /// Adds the remaining angle (rad, modulo a revolution); true when it has reached zero since the last call.
    pub fn update(&mut self, left: f64) -> bool {
        let left = wrap(left);
        let before = self.left.replace(left);
        // the jump from -pi to pi is no crossing
        before.is_some_and(|before| before > 0.0 && before < FRAC_PI_2) && left <= 0.0 && left > -FRAC_PI_2
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::f64::consts::TAU;

    /// Calls of a spindle at `step` rad per call, `phase` rad at the start, until the crossing.
    fn calls(step: f64, phase: f64) -> Option<u32> {
        let mut crossing = Crossing::default();
        (0..1000).find(|k| crossing.update(phase - step * f64::from(*k)))
    }

    #[test]
    fn twenty_rpm_never_misses_a_revolution() {
        let step = TAU / 300.0;
        for k in 0..3000 {
            let phase = TAU * f64::from(k) / 3000.0 + 1e-9;
            let calls = calls(step, phase).unwrap();
            assert!(calls <= 301, "{calls}");
            let late = step * f64::from(calls) - phase;
            assert!(late.rem_euclid(TAU) < step + 1e-9, "{late}");
        }
    }

    #[test]
    fn a_spindle_at_rest_crosses_nothing() {
        for phase in [-1.0, 0.0, 1.0] {
            assert_eq!(calls(0.0, phase), None);
        }
    }

    #[test]
    fn the_opposite_side_is_no_crossing() {
        let mut crossing = Crossing::default();
        assert!(!crossing.update(-3.1));
        assert!(!crossing.update(-3.2));
        assert!(!crossing.update(-3.3));
    }

    #[test]
    fn zero_is_reached_once_and_only_from_near() {
        let crossed = |lefts: &[f64]| {
            let mut crossing = Crossing::default();
            lefts.iter().map(|&left| crossing.update(left)).collect::<Vec<_>>()
        };
        assert_eq!(crossed(&[0.1, 0.0, -0.1]), [false, true, false]);
        assert_eq!(crossed(&[1.5, -1.5]), [false, true]);
        assert_eq!(crossed(&[1.6, -0.1]), [false, false]);
        assert_eq!(crossed(&[0.1, -1.6]), [false, false]);
        assert_eq!(crossed(&[-0.1, 0.1, -0.1]), [false, false, true]);
    }
}

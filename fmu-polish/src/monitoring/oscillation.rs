//! Detects oscillations of the force about its target by counting sign changes of the error. The errors are means over
//! whole periods of the stick-slip motion, whose ripple is not an oscillation of the loop. A sign change is used only
//! if it follows within half of the time in which the path can reverse, since a mold that is off causes one per
//! revolution.

use std::f64::consts::PI;

use control_blocks::{Reversals, ticks};
use serde::{Deserialize, Serialize};

use crate::interface::Parameters;

/// Mean error of an oscillation, over the maximum force error: an oscillation that grows threefold in each half period
/// is detected after three.
const OSCILLATION: f64 = 0.2;
/// Consecutive sign changes: one and a half periods.
const CHANGES: u32 = 3;

/// Consecutive oscillations; by default none.
#[derive(Clone, Copy, Debug, Default, Serialize, Deserialize)]
pub struct Oscillations {
    /// force errors of this period of the stick-slip motion, N
    sum: f64,
    samples: u32,
    reversals: Reversals,
    changes: u32,
}

impl Oscillations {
    /// Takes a force error (N) of which `limit` (N) is the largest.
    pub fn update(&mut self, p: &Parameters, error: f64, limit: f64) {
        let period = 2 * p.stick_slip.half_period.unsigned_abs();
        self.sum += error;
        self.samples += 1;
        if self.samples >= period {
            let window = ticks(PI / p.feed.turn_rate_max, p.sample_period) / period;
            self.changes = self.reversals.update(self.sum / f64::from(period), OSCILLATION * limit, window);
            (self.sum, self.samples) = (0.0, 0);
        }
    }

    /// An oscillation is present.
    pub fn many(&self) -> bool {
        self.changes >= CHANGES
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::f64::consts::TAU;

    const P: Parameters = Parameters::START;
    const LIMIT: f64 = 1.0;

    /// Whether two seconds of an error are an oscillation.
    fn oscillations(error: impl Fn(f64) -> f64) -> bool {
        let mut oscillations = Oscillations::default();
        (0..2000).map(|k| oscillations.update(&P, error(1e-3 * f64::from(k)), LIMIT)).last();
        oscillations.many()
    }

    #[test]
    fn what_oscillates_faster_than_the_path_turns_is_reported() {
        for frequency in [4.5, 6.0, 8.0, 12.0, 19.0] {
            assert!(oscillations(|t| 1.5 * (TAU * frequency * t).sin()), "{frequency} Hz");
        }
        // 25 rad/s are 4 Hz
        for frequency in [1.0, 2.0, 3.3] {
            assert!(!oscillations(|t| 3.0 * (TAU * frequency * t).sin()), "{frequency} Hz");
        }
    }

    #[test]
    fn ripple_of_the_stick_slip_offsets_and_small_oscillations_are_none() {
        assert!(!oscillations(|t| 5.0 * (TAU * 50.0 * t).sin() + 2.0 * (TAU * 100.0 * t).cos()));
        assert!(!oscillations(|t| 2.0 + 1.2 * (TAU * 10.0 * t).sin()));
        assert!(!oscillations(|t| 0.19 * (TAU * 10.0 * t).sin()));
    }

    #[test]
    fn a_single_oscillation_is_soon_discarded() {
        assert!(!oscillations(|t| if t < 1.8 { 1.5 * (TAU * 10.0 * t).sin() } else { 0.0 }));
    }
}

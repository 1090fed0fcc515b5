//! A signal that does not change while the machine moves.
//!
//! A measurement `y` is compared with its anchor `a`. While |y - a| <= band the motion that was expected since the anchor,
//! e = sum(dr), has no response; beyond the band the signal is valid: a = y, e = 0. With the band b and a following error of
//! at most f a valid signal leaves its anchor before |e| > b + f, which is the limit. A last bit that
//! flickers moves a signal by one quantum q: b = 1.5 q covers it, and a coarse signal as well, because the criterion
//! is motion and not time.
//!
//! At rest no motion is expected. There only the noise shows that a signal is valid: with the standard deviation s of a
//! rounded normal distribution the fraction of samples within the band of the anchor is at most p = erf(1.5 q / (s sqrt 2)),
//! and n consecutive ones occur by chance with p^n.

use serde::{Deserialize, Serialize};

/// Anchor of a signal, and the expected motion since.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct Frozen {
    anchor: Option<f64>,
    expected: f64,
    still: u32,
}

impl Frozen {
    /// Discards the anchor, for example after a new zero.
    pub fn clear(&mut self) {
        *self = Self::default();
    }

    /// Adds a measurement and the motion that was expected since the last one, both in the unit of `band`.
    pub fn update(&mut self, reading: f64, motion: f64, band: f64) {
        self.expected += motion;
        self.still = self.still.saturating_add(1);
        if self.anchor.is_none_or(|anchor| (reading - anchor).abs() > band) {
            *self = Self { anchor: Some(reading), expected: 0.0, still: 0 };
        }
    }

    /// Expected motion without a response, not negative.
    pub fn unanswered(&self) -> f64 {
        self.expected.abs()
    }

    /// The same with its sign.
    pub fn missed(&self) -> f64 {
        self.expected
    }

    /// Samples since the signal moved, whatever was expected.
    pub fn still(&self) -> u32 {
        self.still
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const QUANTUM: f64 = 1e-3;
    const BAND: f64 = 1.5 * QUANTUM;
    const STEP: f64 = 1e-4;

    fn rounded(value: f64) -> f64 {
        (value / QUANTUM).round() * QUANTUM
    }

    /// The largest motion without a response in 10,000 samples at a constant speed.
    fn largest(reading: impl Fn(u32) -> f64) -> f64 {
        let mut frozen = Frozen::default();
        let unanswered = (0..10_000u32).map(|k| {
            frozen.update(reading(k), STEP, BAND);
            frozen.unanswered()
        });
        unanswered.fold(0.0, f64::max)
    }

    #[test]
    fn what_is_missed_has_the_sign_of_the_motion() {
        let mut frozen = Frozen::default();
        for motion in [0.0, -2.0, 0.5] {
            frozen.update(7.0, motion, BAND);
        }
        assert_eq!((frozen.missed(), frozen.unanswered()), (-1.5, 1.5));
    }

    #[test]
    fn a_valid_measurement_responds_within_the_band_and_its_lag() {
        for lag in [0.0, 0.5e-3, 20e-3] {
            let maximum = largest(|k| rounded((STEP * f64::from(k) - lag).max(0.0)));
            // one quantum more by rounding
            assert!(maximum <= BAND + lag + QUANTUM, "{lag}: {maximum}");
        }
    }

    #[test]
    fn a_coarse_reading_is_not_frozen_between_its_steps() {
        // ten samples for each quantum
        assert!(largest(|k| rounded(STEP * f64::from(k))) <= BAND + QUANTUM);
    }

    #[test]
    fn a_frozen_reading_is_detected_by_the_motion_only() {
        let maximum = largest(|_| 0.0);
        assert!((maximum - 9_999.0 * STEP).abs() < 1e-9, "{maximum}");
    }

    #[test]
    fn a_last_bit_that_flickers_hides_nothing() {
        let maximum = largest(|k| QUANTUM * f64::from(k % 2));
        assert!((maximum - 9_999.0 * STEP).abs() < 1e-9, "{maximum}");
    }

    #[test]
    fn back_and_forth_is_no_motion_to_answer_where_it_returns() {
        let mut frozen = Frozen::default();
        for k in 0..1000 {
            frozen.update(0.0, if k % 2 == 0 { STEP } else { -STEP }, BAND);
            assert!(frozen.unanswered() < 1.5 * STEP);
        }
        assert_eq!(frozen.still(), 999);
    }

    #[test]
    fn noise_proves_a_valid_signal_at_rest() {
        let mut frozen = Frozen::default();
        let longest = (0..1000u32)
            .map(|k| {
                frozen.update(4.0 * QUANTUM * (f64::from(k) * 1.7).sin(), 0.0, BAND);
                frozen.still()
            })
            .max();
        assert!(longest < Some(5), "{longest:?}");
    }
}

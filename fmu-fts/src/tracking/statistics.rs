//! Statistics of the tracking error over each full turn of the spindle.

use std::f64::consts::TAU;

use nalgebra::Complex;
use serde::{Deserialize, Serialize};

use crate::interface::ERROR_HARMONICS;

/// Error over one revolution, m.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct Turn {
    /// Root mean square.
    pub rms: f64,
    /// Largest magnitude.
    pub peak: f64,
    /// Amplitudes of the harmonics, n = 1 first.
    pub amplitudes: [f64; ERROR_HARMONICS],
}

/// Harmonics c_n of Re sum c_n e^(j n theta) over one revolution, n = 1 first, m.
pub type TurnHarmonics = [Complex<f64>; ERROR_HARMONICS];

impl Turn {
    /// No error.
    pub const ZERO: Self = Self { rms: 0.0, peak: 0.0, amplitudes: [0.0; ERROR_HARMONICS] };
}

/// Sums of the present turn and the result of the last one.
#[derive(Clone, Debug, Serialize, Deserialize)]
pub struct ErrorStatistics {
    begin: Option<f64>,
    count: f64,
    squares: f64,
    peak: f64,
    sums: TurnHarmonics,
    last: Turn,
}

impl Default for ErrorStatistics {
    fn default() -> Self {
        let sums = [Complex::new(0.0, 0.0); ERROR_HARMONICS];
        Self { begin: None, count: 0.0, squares: 0.0, peak: 0.0, sums, last: Turn::ZERO }
    }
}

impl ErrorStatistics {
    /// Adds an error (m) at the spindle angle without wraps (rad) with e^(j n theta), n = 1 first; gives the harmonics of
    /// a complete revolution.
    pub fn add(&mut self, error: f64, angle: f64, phasors: &[Complex<f64>]) -> Option<TurnHarmonics> {
        let begin = *self.begin.get_or_insert(angle);
        let full = ((angle - begin).abs() >= TAU).then(|| self.sums.map(|sum| sum * (2.0 / self.count)));
        if let Some(harmonics) = &full {
            *self = Self { begin: Some(angle), last: self.finish(harmonics), ..Self::default() };
        }
        self.count += 1.0;
        self.squares += error * error;
        self.peak = self.peak.max(error.abs());
        for (sum, phasor) in self.sums.iter_mut().zip(phasors) {
            sum.re += error * phasor.re;
            sum.im -= error * phasor.im;
        }
        full
    }

    /// The last full turn.
    pub fn last(&self) -> &Turn {
        &self.last
    }

    fn finish(&self, harmonics: &TurnHarmonics) -> Turn {
        Turn { rms: (self.squares / self.count).sqrt(), peak: self.peak, amplitudes: harmonics.map(|c| c.norm()) }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::tracking::phasors::Phasors;

    /// Statistics of some samples, with the harmonics of the last full turn.
    fn turned(samples: u32, speed: f64, error: impl Fn(f64) -> f64) -> (ErrorStatistics, Option<TurnHarmonics>) {
        let (mut statistics, mut harmonics) = (ErrorStatistics::default(), None);
        for k in 0..samples {
            let angle = speed * 1e-4 * f64::from(k);
            harmonics = statistics.add(error(angle), angle, Phasors::new(angle, 24).from_one()).or(harmonics);
        }
        (statistics, harmonics)
    }

    #[test]
    fn harmonics_peak_and_rms_of_a_turn() {
        for speed in [62.83, -251.3] {
            let error = |t: f64| 3e-6 * (12.0 * t + 0.4).cos() + 4e-6 * (2.0 * t).sin();
            let (statistics, harmonics) = turned(2500, speed, error);
            let (turn, harmonics) = (statistics.last(), harmonics.unwrap());
            assert!((turn.rms - 3.5355e-6).abs() < 0.02e-6, "{turn:?}");
            assert!((harmonics[11] - Complex::from_polar(3e-6, 0.4)).norm() < 0.03e-6, "{turn:?}");
            assert!((harmonics[1] - Complex::new(0.0, -4e-6)).norm() < 0.03e-6, "{turn:?}");
            assert!(turn.amplitudes[6] < 0.03e-6, "{turn:?}");
            assert_eq!(turn.amplitudes, harmonics.map(|c| c.norm()));
            assert!(turn.peak > 6.5e-6 && turn.peak <= 7e-6, "{turn:?}");
        }
    }

    #[test]
    fn before_a_full_revolution_there_is_nothing() {
        let (statistics, harmonics) = turned(999, 62.83, |_| 1.0);
        assert_eq!((statistics.last(), harmonics), (&Turn::ZERO, None));
        assert!(turned(1002, 62.83, |_| 1.0).0.last().rms > 0.99);
    }

    #[test]
    fn at_rest_the_last_revolution_stays() {
        assert_eq!(turned(5000, 0.0, |_| 1.0).0.last(), &Turn::ZERO);
    }
}

//! Statistics of the tracking error over each full turn of the spindle.

use std::f64::consts::TAU;

use nalgebra::Complex;
use serde::{Deserialize, Serialize};

use crate::interface::ERROR_HARMONICS;

/// Error over one revolution, m.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct RevolutionStatistics {
    /// Root mean square.
    pub rms: f64,
    /// Largest magnitude.
    pub peak: f64,
    /// Amplitudes of the harmonics, n = 1 first.
    pub amplitudes: [f64; ERROR_HARMONICS],
}

/// Harmonics c_n of Re sum c_n e^(j n theta) over one revolution, n = 1 first, m.
pub type RevolutionHarmonics = [Complex<f64>; ERROR_HARMONICS];

impl RevolutionStatistics {
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
    sums: RevolutionHarmonics,
    last: RevolutionStatistics,
}

impl Default for ErrorStatistics {
    fn default() -> Self {
        let sums = [Complex::new(0.0, 0.0); ERROR_HARMONICS];
        Self { begin: None, count: 0.0, squares: 0.0, peak: 0.0, sums, last: RevolutionStatistics::ZERO }
    }
}

impl ErrorStatistics {
    /// Adds an error (m) at the spindle angle without wraps (rad) with e^(j n theta), n = 1 first; gives the harmonics of
    /// a complete revolution.
    pub fn add(&mut self, error: f64, angle: f64, phasors: &[Complex<f64>]) -> Option<RevolutionHarmonics> {
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
    pub fn last(&self) -> &RevolutionStatistics {
        &self.last
    }

    fn finish(&self, harmonics: &RevolutionHarmonics) -> RevolutionStatistics {
        RevolutionStatistics {
            rms: (self.squares / self.count).sqrt(),
            peak: self.peak,
            amplitudes: harmonics.map(|c| c.norm()),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::tracking::phasors::Phasors;

    /// Statistics of some samples, with the harmonics of the last full turn.
    fn rotated(samples: u32, speed: f64, error: impl Fn(f64) -> f64) -> (ErrorStatistics, Option<RevolutionHarmonics>) {
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
            let (statistics, harmonics) = rotated(2500, speed, error);
            let (revolution, harmonics) = (statistics.last(), harmonics.unwrap());
            assert!((revolution.rms - 3.5355e-6).abs() < 0.02e-6, "{revolution:?}");
            assert!((harmonics[11] - Complex::from_polar(3e-6, 0.4)).norm() < 0.03e-6, "{revolution:?}");
            assert!((harmonics[1] - Complex::new(0.0, -4e-6)).norm() < 0.03e-6, "{revolution:?}");
            assert!(revolution.amplitudes[6] < 0.03e-6, "{revolution:?}");
            assert_eq!(revolution.amplitudes, harmonics.map(|c| c.norm()));
            assert!(revolution.peak > 6.5e-6 && revolution.peak <= 7e-6, "{revolution:?}");
        }
    }

    #[test]
    fn before_a_full_revolution_there_is_nothing() {
        let (statistics, harmonics) = rotated(999, 62.83, |_| 1.0);
        assert_eq!((statistics.last(), harmonics), (&RevolutionStatistics::ZERO, None));
        assert!(rotated(1002, 62.83, |_| 1.0).0.last().rms > 0.99);
    }

    #[test]
    fn at_rest_the_last_revolution_stays() {
        assert_eq!(rotated(5000, 0.0, |_| 1.0).0.last(), &RevolutionStatistics::ZERO);
    }
}

//! What a measured closed-loop response T says of the loop: bandwidth, phase margin, sensitivity peak.
//!
//! With the error e = r - b inside the controller, T = L / (1 + L): the open loop L = T / (1 - T) and the
//! sensitivity S = 1 - T follow from T alone, with all delays in them.

use std::f64::consts::{FRAC_1_SQRT_2, PI};

use nalgebra::Complex;
use serde::{Deserialize, Serialize};

use crate::response::FrequencyResponse;

/// Places between two points of the table at which T is looked up.
const PIECES: usize = 16;

/// Figures of merit of the loop, within the frequencies of the table.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct Margins {
    /// Lowest frequency at which abs(T) falls below -3 dB, rad/s; 0 if it does not.
    pub bandwidth: f64,
    /// Smallest phase margin where abs(L) = 1, rad; 0 without such a frequency.
    pub phase_margin: f64,
    /// Largest abs(S), 1; 0 for an empty table.
    pub sensitivity_peak: f64,
}

impl Margins {
    /// Nothing known.
    pub const NONE: Self = Self { bandwidth: 0.0, phase_margin: 0.0, sensitivity_peak: 0.0 };
}

/// Figures of merit of the loop with the response `t`.
pub fn margins(t: &FrequencyResponse) -> Margins {
    let mut found = Margins::NONE;
    let mut before = (0.0, Complex::new(1.0, 0.0));
    for point in t.points() {
        let width = (point.frequency - before.0) / PIECES as f64;
        let start = before.0;
        for piece in 1..=PIECES {
            let frequency = start + width * piece as f64;
            let now = (frequency, t.at(frequency));
            found.look(before, now);
            before = now;
        }
    }
    found
}

impl Margins {
    /// Looks at the straight line between two neighbours (frequency, T).
    fn look(&mut self, before: (f64, Complex<f64>), now: (f64, Complex<f64>)) {
        self.sensitivity_peak = self.sensitivity_peak.max((1.0 - now.1).norm());
        let (high, low) = (before.1.norm(), now.1.norm());
        if self.bandwidth == 0.0 && high >= FRAC_1_SQRT_2 && low < FRAC_1_SQRT_2 {
            self.bandwidth = before.0 + (now.0 - before.0) * (high - FRAC_1_SQRT_2) / (high - low);
        }
        // abs(L) = 1 where T and 1 - T are equally long: Re T = 1/2, and arg L = 2 arg T there
        let (left, right) = (before.1.re - 0.5, now.1.re - 0.5);
        if left * right < 0.0 {
            let t = before.1 + (now.1 - before.1) * (left / (left - right));
            let margin = PI - 2.0 * t.arg().abs();
            self.phase_margin = if self.phase_margin == 0.0 { margin } else { self.phase_margin.min(margin) };
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Open loop of a double integrator with a lead from a fourth of the crossover to four times it.
    fn open(w: f64) -> Complex<f64> {
        let s = Complex::new(0.0, w / 700.0);
        (s * 4.0 + 1.0) / (s / 4.0 + 1.0) / (s * s) / 4.0
    }

    fn table(open: impl Fn(f64) -> Complex<f64>) -> FrequencyResponse {
        let grid: Vec<f64> = (1..=32).map(|i| 90.0 * f64::from(i)).collect();
        FrequencyResponse::from_model(&grid, |w| open(w) / (1.0 + open(w)))
    }

    /// Root of a falling function by bisection.
    fn root(falling: impl Fn(f64) -> f64) -> f64 {
        let (mut low, mut high) = (100.0, 2880.0);
        for _ in 0..60 {
            let middle = 0.5 * (low + high);
            if falling(middle) > 0.0 { low = middle } else { high = middle }
        }
        low
    }

    #[test]
    fn agree_with_the_open_loop_they_were_made_from() {
        for delay in [0.0, 2e-4, 4e-4] {
            let late = |w: f64| open(w) * Complex::new(0.0, -w * delay).exp();
            let found = margins(&table(late));
            let crossover = root(|w| late(w).norm() - 1.0);
            assert!((crossover - 700.0).abs() < 1e-6);
            let margin = PI + late(crossover).arg();
            assert!((found.phase_margin - margin).abs() < 2e-3, "{} : {margin}", found.phase_margin);
            let bandwidth = root(|w| (late(w) / (1.0 + late(w))).norm() - FRAC_1_SQRT_2);
            assert!((found.bandwidth / bandwidth - 1.0).abs() < 2e-3, "{} : {bandwidth}", found.bandwidth);
            let peak = (1..2880).map(|i| (1.0 + late(f64::from(i))).norm().recip()).fold(0.0, f64::max);
            assert!((found.sensitivity_peak / peak - 1.0).abs() < 3e-3, "{} : {peak}", found.sensitivity_peak);
        }
    }

    #[test]
    fn what_the_table_does_not_reach_is_zero() {
        assert_eq!(margins(&FrequencyResponse::EMPTY), Margins::NONE);
        let flat = FrequencyResponse::from_model(&[60.0, 120.0], |_| Complex::new(1.0, -0.1));
        let found = margins(&flat);
        assert_eq!((found.bandwidth, found.phase_margin), (0.0, 0.0));
        assert!((found.sensitivity_peak - 0.1).abs() < 1e-12);
    }
}

//! Bandwidth, phase margin and sensitivity peak from a closed-loop response T.
//!
//! With the error e = r - b inside the controller, T = L / (1 + L): the open loop L = T / (1 - T) and the
//! sensitivity S = 1 - T follow from T alone, with all delays in them.

use std::f64::consts::{FRAC_1_SQRT_2, PI};

use nalgebra::Complex;

use crate::interface::ResponseOutput;
use crate::servo::flexure::Flexure;
use crate::servo::loop_response::LoopResponse;
use crate::servo::response::{FrequencyResponse, Point};

/// Frequencies looked at, per octave.
const PER_OCTAVE: f64 = 48.0;

/// Figures of merit of the loop, within a range of frequencies.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Margins {
    /// Lowest frequency at which abs(T) falls below -3 dB, rad/s; 0 if it does not.
    pub bandwidth: f64,
    /// Smallest phase margin where abs(L) = 1, rad; 0 without such a frequency.
    pub phase_margin: f64,
    /// Largest abs(S), 1.
    pub sensitivity_peak: f64,
}

impl Margins {
    /// Nothing known.
    pub const NONE: Self = Self { bandwidth: 0.0, phase_margin: 0.0, sensitivity_peak: 0.0 };
}

impl ResponseOutput {
    /// The points of a response, what follows from the loop in use that they belong to, and the flexure that is compensated.
    pub fn of(response: &FrequencyResponse, in_use: &LoopResponse, flexure: &Flexure) -> Self {
        let frequency = |point: Option<&Point>| point.map_or(0.0, |point| point.frequency);
        let (first, last) = (frequency(response.points().first()), frequency(response.points().last()));
        let Margins { bandwidth, phase_margin, sensitivity_peak } = margins(first, last, |omega| in_use.at(omega));
        let mut output = Self {
            bandwidth,
            phase_margin,
            sensitivity_peak,
            tip_frequency: flexure.frequency,
            tip_damping: flexure.damping,
            tip_frequency_std: flexure.sigma,
            ..Self::START
        };
        for (i, point) in response.points().iter().enumerate() {
            output.frequency[i] = point.frequency;
            output.magnitude[i] = point.magnitude;
            output.phase[i] = point.phase;
        }
        output
    }
}

/// Figures of merit of the loop with the response `t` at a frequency (rad/s), looked at from `first` (above 0) to `last`.
pub fn margins(first: f64, last: f64, t: impl Fn(f64) -> Complex<f64>) -> Margins {
    let mut found = Margins::NONE;
    if !(first > 0.0 && last > first) {
        return found;
    }
    let pieces = (PER_OCTAVE * (last / first).log2()).ceil();
    let mut before = (first, t(first));
    for piece in 1..=pieces as u32 {
        let frequency = first * (last / first).powf(f64::from(piece) / pieces);
        let now = (frequency, t(frequency));
        found.look(before, now);
        before = now;
    }
    found
}

impl Margins {
    /// Looks at the straight line between two neighbors (frequency, T).
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
    fn agree_with_the_open_loop_that_they_belong_to() {
        for delay in [0.0, 2e-4, 4e-4] {
            let late = |w: f64| open(w) * Complex::new(0.0, -w * delay).exp();
            let closed = |w: f64| late(w) / (1.0 + late(w));
            let found = margins(60.0, 2880.0, closed);
            let crossover = root(|w| late(w).norm() - 1.0);
            assert!((crossover - 700.0).abs() < 1e-6);
            let margin = PI + late(crossover).arg();
            assert!((found.phase_margin - margin).abs() < 1e-4, "{} : {margin}", found.phase_margin);
            let bandwidth = root(|w| closed(w).norm() - FRAC_1_SQRT_2);
            assert!((found.bandwidth / bandwidth - 1.0).abs() < 1e-4, "{} : {bandwidth}", found.bandwidth);
            let peak = (1..2880).map(|i| (1.0 + late(f64::from(i))).norm().recip()).fold(0.0, f64::max);
            assert!((found.sensitivity_peak / peak - 1.0).abs() < 1e-3, "{} : {peak}", found.sensitivity_peak);
        }
    }

    #[test]
    fn of_several_crossings_the_lowest_bandwidth_and_the_smallest_margin_count() {
        // Re T passes 1/2 at 100, 200 and 300 rad/s with the phases -30, -60 and -45 degrees; abs(T) leaves -3 dB twice
        let (frequencies, phases) =
            ([50.0, 100.0, 150.0, 200.0, 250.0, 300.0, 350.0], [0.0, 30.0, 30.0, 60.0, 60.0, 45.0, 80.0]);
        let t = |w: f64| {
            let k = frequencies.iter().rposition(|at| *at <= w).unwrap_or(0).min(5);
            let fraction = (w - frequencies[k]) / 50.0;
            let phase: f64 = phases[k] + fraction * (phases[k + 1] - phases[k]);
            let real = [1.0, 0.5, 0.3, 0.5, 0.8, 0.5, 0.1];
            let re: f64 = real[k] + fraction * (real[k + 1] - real[k]);
            Complex::new(re, -re * phase.to_radians().tan())
        };
        let found = margins(50.0, 350.0, t);
        assert!((found.phase_margin - 60f64.to_radians()).abs() < 1e-2, "{found:?}");
        let bandwidth = (50..100).map(f64::from).find(|w| t(*w).norm() < FRAC_1_SQRT_2).unwrap();
        assert!((found.bandwidth - bandwidth).abs() < 1.5, "{found:?} {bandwidth}");
    }

    #[test]
    fn what_the_range_does_not_reach_is_zero() {
        let flat = |_| Complex::new(1.0, -0.1);
        assert_eq!(margins(0.0, 100.0, flat), Margins::NONE);
        assert_eq!(margins(100.0, 100.0, flat), Margins::NONE);
        let found = margins(60.0, 120.0, flat);
        assert_eq!((found.bandwidth, found.phase_margin), (0.0, 0.0));
        assert!((found.sensitivity_peak - 0.1).abs() < 1e-12);
    }
}

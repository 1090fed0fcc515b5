//! Adaptive feedforward cancellation: one resonator for each harmonic of the spindle, in the spindle-angle domain.
//!
//! Eq. 3, k (1 + sum g_n s / (s^2 + n^2 w^2)), has no phase advance and is unstable where the position loop is more than
//! a quarter turn late. The form of Messner and Bodson turns each resonator by the phase of the loop:
//!
//! ```text
//! R_n = g_n (s cos f_n - n w sin f_n) / (s^2 + n^2 w^2),   f_n = -arg T(j n w),   g_n = 2 / (tau |T|).
//! ```
//!
//! In the angle domain it needs no speed: xi_n += 2 T_s / (tau |T|) e exp(-j (n theta + arg T)), u = Re xi_n e^(j n theta).
//!
//! The error that a feedforward with a wrong response leaves is proportional to the harmonic B_n of the path. Where the
//! response is not learned (`expert.feedforward.adaptive` is false), xi_n is therefore scaled to xi_n B_n(x) / B_n(x')
//! when the slide moves from x' to x. Without this scaling, xi_n would always be late by tau.

use control_blocks::{Canceller, adaptation_gain};
use nalgebra::Complex;
use serde::{Deserialize, Serialize};

use crate::interface::{Afc, Parameters};

/// T is never taken for less: the gain stays finite.
const RESPONSE_MIN: f64 = 0.05;
/// Factor by which the state of a harmonic that is not in use decays, at each tuning of it.
pub const FADE: f64 = 0.9;
/// Smallest harmonic of the path along which a state is scaled, rad: 0.1 um at the tool.
const PATH_MIN: f64 = 1e-6;
/// Largest change of it from one tuning to the next: what else is learned, in step with the spindle, must not grow
/// faster than it is corrected, 2.4 ms / `afc.tau`.
const CARRIED_MAX: f64 = 3e-3;

/// Resonators of the harmonics, n = 1 first.
#[derive(Clone, Debug, Serialize, Deserialize)]
pub struct Resonators {
    states: Vec<Canceller>,
    gains: Vec<Complex<f64>>,
    /// B_n at the last tuning, rad
    path: Vec<Complex<f64>>,
}

impl Resonators {
    /// Nothing learned.
    pub fn new(p: &Parameters) -> Self {
        let highest = p.afc.cancelled.highest();
        let none = vec![Complex::default(); highest];
        Self { states: vec![Canceller::default(); highest], gains: none.clone(), path: none }
    }

    /// Takes the gain of harmonic `n`; without one it is not in use and fades.
    pub fn tune(&mut self, n: usize, gain: Option<Complex<f64>>) {
        if let (Some(state), Some(before)) = (self.states.get_mut(n - 1), self.gains.get_mut(n - 1)) {
            *before = gain.unwrap_or_default();
            if gain.is_none() {
                state.fade(FADE);
            }
        }
    }

    /// Takes the harmonic `n` of the path, rad.
    pub fn carry(&mut self, n: usize, path: Complex<f64>) {
        if let (Some(state), Some(before)) = (self.states.get_mut(n - 1), self.path.get_mut(n - 1)) {
            let change = path - *before;
            if before.norm() >= PATH_MIN && change.norm() <= CARRIED_MAX * before.norm() {
                state.scale(path / *before);
            }
            *before = path;
        }
    }

    /// Learns from the error (rad) with e^(j n theta), n = 1 first.
    pub fn learn(&mut self, error: f64, phasors: &[Complex<f64>]) {
        for ((state, gain), phasor) in self.states.iter_mut().zip(&self.gains).zip(phasors) {
            state.learn(*gain, *phasor, error);
        }
    }

    /// Correction to add to the set-point, rad, from e^(j n theta), n = 1 first.
    pub fn output(&self, phasors: &[Complex<f64>]) -> f64 {
        self.states.iter().zip(phasors).map(|(state, phasor)| state.output(*phasor)).sum()
    }

    /// Discards what was learned.
    pub fn clear(&mut self) {
        self.states.fill(Canceller::default());
    }
}

/// The gain of a harmonic at `omega` (rad/s) with the response `t` of the position loop, none if it is not `enabled` or
/// too high.
pub fn gain_in_use(p: &Parameters, t: Complex<f64>, omega: f64, enabled: bool) -> Option<Complex<f64>> {
    (enabled && omega.abs() <= p.afc.frequency_max).then(|| gain_of(&p.afc, p.sample_period, t))
}

/// 2 T_s / (tau |T|) exp(-j arg T); without the advance, eq. 3 as printed, the phase is missing.
pub fn gain_of(afc: &Afc, period: f64, t: Complex<f64>) -> Complex<f64> {
    if afc.phase_advance {
        return adaptation_gain(period, afc.tau, t, RESPONSE_MIN);
    }
    Complex::new(2.0 * period / (afc.tau * t.norm().max(RESPONSE_MIN)), 0.0)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::tracking::phasors::Phasors;

    fn tuned(p: &Parameters, n: usize, t: Complex<f64>) -> Resonators {
        let mut resonators = Resonators::new(p);
        resonators.tune(n, gain_in_use(p, t, 1000.0, true));
        resonators
    }

    #[test]
    fn one_resonator_is_its_transfer_function() {
        // R(z) = g T_s (cos f - z^-1 cos(f - W)) / (1 - 2 z^-1 cos W + z^-2), W = n w T_s
        let p = Parameters::START;
        let (t, n, step) = (Complex::from_polar(0.8, -0.9), 5usize, 0.011);
        let mut resonators = tuned(&p, n, t);
        let (gain, f, w) = (2.0 * p.sample_period / (p.afc.tau * 0.8), 0.9f64, n as f64 * step);
        let (mut e, mut u) = ([0.0; 2], [0.0; 2]);
        for k in 0..2000 {
            let error = 1e-5 * (0.3 * f64::from(k)).sin();
            let phasors = Phasors::new(step * f64::from(k), 24);
            resonators.learn(error, phasors.from_one());
            let expected = gain * (f.cos() * error - (f - w).cos() * e[0]) + 2.0 * w.cos() * u[0] - u[1];
            let found = resonators.output(phasors.from_one());
            assert!((found - expected).abs() < 1e-13, "sample {k}: {found} {expected}");
            (e, u) = ([error, e[0]], [found, u[0]]);
        }
    }

    #[test]
    fn only_selected_harmonics_and_only_up_to_the_highest_frequency() {
        let mut p = Parameters::PAPER;
        p.afc.frequency_max = 4000.0;
        // either way round
        for speed in [600.0, -600.0] {
            let mut resonators = Resonators::new(&p);
            for n in 1..=24 {
                resonators.tune(n, gain_in_use(&p, Complex::new(0.9, -0.1), speed * n as f64, n % 2 == 0));
            }
            let learning: Vec<usize> = (1..=10).filter(|n| resonators.gains[n - 1].norm() > 0.0).collect();
            assert_eq!(learning, [2, 4, 6]);
        }
    }

    #[test]
    fn a_harmonic_beyond_the_highest_frequency_fades() {
        let p = Parameters::START;
        let mut resonators = tuned(&p, 3, Complex::new(1.0, 0.0));
        let phasors = Phasors::new(0.0, 24);
        (0..100).for_each(|_| resonators.learn(1e-4, phasors.from_one()));
        let before = resonators.output(phasors.from_one());
        (0..100).for_each(|_| resonators.tune(3, gain_in_use(&p, Complex::ONE, 1e6, true)));
        assert!(before > 0.0 && resonators.output(phasors.from_one()) < 1e-4 * before);
        resonators.clear();
        assert_eq!(resonators.output(phasors.from_one()), 0.0);
    }

    #[test]
    fn what_is_learned_goes_along_with_the_path() {
        let p = Parameters::START;
        let phasors = Phasors::new(0.0, 24);
        let learned = |from: Complex<f64>, to: Complex<f64>| {
            let mut resonators = tuned(&p, 2, Complex::new(1.0, 0.0));
            resonators.carry(2, from);
            resonators.learn(1e-4, phasors.from_one());
            let before = resonators.output(phasors.from_one());
            resonators.carry(2, to);
            // of no concern to the others
            resonators.carry(3, to);
            resonators.output(phasors.from_one()) / before
        };
        let path = Complex::new(0.01, 0.02);
        assert!((learned(path, path * 1.002) - 1.002).abs() < 1e-12);
        // too large a change, or too small a harmonic
        assert_eq!(learned(path, path * 1.01), 1.0);
        assert_eq!(learned(path * 1e-5, path * 1.002e-5), 1.0);
        assert_eq!(learned(Complex::default(), path), 1.0);
    }

    #[test]
    fn no_response_gives_no_infinite_gain() {
        for advance in [true, false] {
            let mut p = Parameters::START;
            p.afc.phase_advance = advance;
            assert!(gain_of(&p.afc, 1e-4, Complex::default()).norm() < 0.1);
        }
    }
}

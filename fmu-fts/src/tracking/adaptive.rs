//! Adaptive feedforward: it learns the response of the arm instead of the amplitude of the error.
//!
//! For the motion B the position loop, T = L / (1 + L), needs the set-point B / T = B + B / L; B / L is what makes the
//! torque of the path. An arm with an off-nominal torque or inertia needs (1 + eps) B / L, with one eps for every
//! radius, feed and speed. So each harmonic of the path gets
//!
//! ```text
//! u = Re sum (xi_n + eps_n P_n) e^(j n theta),   P_n = H_n B_n (1 / T_n - 1),
//! ```
//!
//! with the xi_n of the resonators for what does not come from the path. Both explain the same error, so the correction c
//! of the set-point that a resonator learns from it is divided as a Kalman filter does, by what each may be beforehand:
//!
//! ```text
//! eps_n += w c / P_n,   xi_n += (1 - w) c,   w = (s M)^2 / ((s M)^2 + r^2),   M = J (n omega)^2 |B_n|
//! ```
//!
//! where s is the relative uncertainty of the torque M of the path, and r the torque of ripple and cut at one harmonic.
//! On a constant path, d(xi + eps P) = c: stability is that of the resonators. On a changing path, eps P follows immediately
//! where a learned amplitude would be late by tau, for ever.
//!
//! Most of the path is in few harmonics. At first, when all of it is unknown, they learn quicker: w (1 + q |P_n|^2 /
//! sum |P|^2), which all together is no more than q harmonics more, whatever the path; q falls with tau while it is
//! learned, as the gain of least squares does. What is left of an error after the time t is exp(-t / tau - q (1 -
//! exp(-t / tau))).

use control_blocks::Canceller;
use nalgebra::Complex;
use serde::{Deserialize, Serialize};

use crate::interface::Parameters;
use crate::tracking::resonators::FADE;

/// s: relative uncertainty of the torque of the path.
const WEIGHT: f64 = 0.25;
/// r: torque of ripple, friction and cut at one harmonic, relative to the largest torque.
const RIPPLE: f64 = 1.5e-3;
/// q at first: harmonics of `afc.tau` that the quicker learning of the strongest ones is worth.
pub const QUICKER: f64 = 5.0;

/// A harmonic of the path at the present speed and slide position.
#[derive(Clone, Copy, Debug)]
pub struct PathHarmonic {
    /// Frequency, rad/s.
    pub omega: f64,
    /// B, rad.
    pub path: Complex<f64>,
    /// T.
    pub response: Complex<f64>,
    /// H, hub over tool of the flexure.
    pub hub_over_tool: Complex<f64>,
}

/// Learned relative error eps_n of the nominal torque at each harmonic of the path, n = 1 first.
#[derive(Clone, Debug, Serialize, Deserialize)]
pub struct AdaptiveFeedforward {
    /// eps
    learned: Vec<Canceller>,
    gains: Vec<Complex<f64>>,
    /// P / B
    factors: Vec<Complex<f64>>,
    /// |P|^2 of those that learn, rad2
    strengths: Vec<f64>,
    /// q, and its decay factor per sample
    quicker: f64,
    keep: f64,
}

impl AdaptiveFeedforward {
    /// Nothing learned of `count` harmonics.
    pub fn new(p: &Parameters, count: usize) -> Self {
        let none = vec![Complex::default(); count];
        Self {
            learned: vec![Canceller::default(); count],
            gains: none.clone(),
            factors: none,
            strengths: vec![0.0; count],
            quicker: QUICKER,
            keep: (-p.sample_period / p.afc.tau).exp(),
        }
    }

    /// Takes harmonic `n` of the path and the gain of its resonator, none if it is not in use; gives w, the part of what is
    /// learned that is learned here.
    pub fn tune(&mut self, p: &Parameters, n: usize, harmonic: &PathHarmonic, gain: Option<Complex<f64>>) -> f64 {
        let Some(learned) = self.learned.get_mut(n - 1) else { return 0.0 };
        let PathHarmonic { omega, path, response, hub_over_tool } = *harmonic;
        let factor = hub_over_tool * (1.0 - response) / response;
        // far below the bandwidth no torque is to be seen
        let seen = factor.is_finite() && factor.norm() > 0.0;
        let Some(gain) = gain.filter(|_| seen) else {
            learned.fade(FADE);
            (self.gains[n - 1], self.strengths[n - 1]) = (Complex::default(), 0.0);
            return 0.0;
        };
        (self.factors[n - 1], self.strengths[n - 1]) = (factor, (factor * path).norm_sqr());
        let torque = WEIGHT * p.servo.inertia * omega * omega;
        let ripple = RIPPLE * p.servo.torque_max;
        // w / |B|^2 is finite where there is no path
        let slope = torque * torque / (torque * torque * path.norm_sqr() + ripple * ripple);
        self.gains[n - 1] = gain * path.conj() * slope * self.quicker(n) / factor;
        slope * path.norm_sqr()
    }

    /// How much quicker harmonic `n` learns.
    fn quicker(&self, n: usize) -> f64 {
        let sum: f64 = self.strengths.iter().sum();
        if sum > 0.0 { 1.0 + self.quicker * self.strengths[n - 1] / sum } else { 1.0 }
    }

    /// Learns from the error (rad) with e^(j n theta), n = 1 first.
    pub fn learn(&mut self, error: f64, phasors: &[Complex<f64>]) {
        self.quicker *= self.keep;
        for ((learned, gain), phasor) in self.learned.iter_mut().zip(&self.gains).zip(phasors) {
            learned.learn(*gain, *phasor, error);
        }
    }

    /// Correction to add to the set-point, rad; from the harmonics of the path (rad) and e^(j n theta), n = 1 first.
    pub fn output(&self, path: &[Complex<f64>], phasors: &[Complex<f64>]) -> f64 {
        let all = self.learned.iter().zip(&self.factors).zip(path).zip(phasors);
        all.map(|(((learned, factor), path), phasor)| learned.output(factor * path * phasor)).sum()
    }

    /// 1 + Re eps of the harmonic that takes most: torque that the path takes over that which the response says.
    pub fn torque_ratio(&self) -> f64 {
        let strongest = self.strengths.iter().zip(&self.learned).max_by(|a, b| a.0.total_cmp(b.0));
        strongest.map_or(1.0, |(_, learned)| 1.0 + learned.output(Complex::ONE))
    }

    /// Discards what was learned.
    pub fn clear(&mut self) {
        self.learned.fill(Canceller::default());
        self.quicker = QUICKER;
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::tracking::phasors::Phasors;
    use crate::tracking::resonators::{Resonators, gain_in_use};

    const PERIOD: f64 = 1e-4;

    /// L of a double integrator that crosses over at 100 Hz, a little late; nominal, and with the drive gain `k`.
    fn open(omega: f64, k: f64) -> Complex<f64> {
        let s = Complex::new(0.0, omega / 628.0);
        k * (s * 2.0 + 1.0) / (s * s * 2.0) * Complex::cis(-omega * 3e-4)
    }

    fn closed(omega: f64, k: f64) -> Complex<f64> {
        let l = open(omega, k);
        l / (l + 1.0)
    }

    /// A loop without transients that follows harmonic 2 with a drive of the gain `k`.
    struct Steady {
        p: Parameters,
        adaptive: AdaptiveFeedforward,
        resonators: Resonators,
        k: f64,
        angle: f64,
    }

    impl Steady {
        fn new(k: f64) -> Self {
            let p = Parameters::START;
            Self { adaptive: AdaptiveFeedforward::new(&p, 4), resonators: Resonators::new(&p), p, k, angle: 0.0 }
        }

        /// Follows for `time` (s) the path that `path` gives over the time, at `omega` of harmonic 2; the largest error
        /// (rad) of the last tenth.
        fn follow(&mut self, time: f64, omega: f64, path: impl Fn(f64) -> Complex<f64>) -> f64 {
            let (nominal, real) = (closed(omega, 1.0), closed(omega, self.k));
            let (steps, mut largest) = ((time / PERIOD) as u32, 0.0);
            for step in 0..steps {
                let b = path(PERIOD * f64::from(step));
                let harmonic = PathHarmonic { omega, path: b, response: nominal, hub_over_tool: Complex::ONE };
                let gain = gain_in_use(&self.p, nominal, omega, true);
                let weight = self.adaptive.tune(&self.p, 2, &harmonic, gain);
                self.resonators.tune(2, gain.map(|gain| gain * (1.0 - weight)));
                self.angle += 0.5 * omega * PERIOD;
                let phasors = Phasors::new(self.angle, 4);
                let path = [Complex::ZERO, b, Complex::ZERO, Complex::ZERO];
                // the amplitude of what is added, from two phases
                let amplitude = |rotation: Complex<f64>| {
                    let rotated = phasors.from_one().iter().map(|phasor| phasor * rotation).collect::<Vec<_>>();
                    self.adaptive.output(&path, &rotated) + self.resonators.output(&rotated)
                };
                let added =
                    Complex::new(amplitude(Complex::ONE), -amplitude(Complex::I)) * phasors.from_one()[1].conj();
                let error = ((b - real * (b / nominal + added)) * phasors.from_one()[1]).re;
                self.resonators.learn(error, phasors.from_one());
                self.adaptive.learn(error, phasors.from_one());
                if step > steps - steps / 10 {
                    largest = f64::max(largest, error.abs());
                }
            }
            largest
        }
    }

    #[test]
    fn the_gain_of_the_drive_is_learned() {
        for k in [0.7, 0.8, 1.0, 1.25] {
            let mut steady = Steady::new(k);
            let left = steady.follow(4.0, 500.0, |_| Complex::new(0.01, -0.02));
            assert!(left < 1e-7, "{left}");
            // (1 + eps) / L = 1 / (k L); what the resonators have taken is 1 - w of it
            assert!((steady.adaptive.torque_ratio() * k - 1.0).abs() < 2e-3, "{k}: {}", steady.adaptive.torque_ratio());
        }
    }

    #[test]
    fn it_is_learned_quickly_at_first_and_with_tau_later() {
        for part in [1.0 / 6.0, 0.5, 1.0] {
            // a small difference, so that the loop is nominal
            let mut steady = Steady::new(1.001);
            steady.follow(part * steady.p.afc.tau, 500.0, |_| Complex::new(0.02, 0.01));
            let learned = (1.0 - steady.adaptive.torque_ratio()) / (1.0 - 1.0 / 1.001);
            let left = (-part - QUICKER * (1.0 - (-part).exp())).exp();
            assert!((learned - (1.0 - left)).abs() < 0.02, "{part}: {learned}");
        }
        // a discarded ratio is learned quickly again
        let mut steady = Steady::new(1.001);
        steady.follow(2.0, 500.0, |_| Complex::new(0.02, 0.01));
        steady.adaptive.clear();
        assert_eq!(steady.adaptive.quicker, QUICKER);
    }

    #[test]
    fn what_is_learned_is_right_at_every_amplitude_and_speed() {
        let mut steady = Steady::new(0.8);
        steady.follow(4.0, 500.0, |_| Complex::new(0.02, 0.0));
        // half of it within a second: learned alone, an amplitude lags by tau times its slope
        let alone = 0.5 * 0.02 * 0.3 * (1.0 - closed(500.0, 0.8) / closed(500.0, 1.0)).norm();
        let left = steady.follow(1.0, 500.0, |t| Complex::new(0.02 - 0.01 * t, 0.0));
        assert!(left < 2e-3 * alone, "{left} {alone}");
        // immediately at another speed
        let without = 0.01 * (1.0 - closed(400.0, 0.8) / closed(400.0, 1.0)).norm();
        let left = steady.follow(0.02, 400.0, |_| Complex::new(0.01, 0.0));
        assert!(left < 0.01 * without, "{left} {without}");
    }

    /// w, and the change of the set-point that an error along the phasor makes over that of a resonator alone.
    fn tuned(p: &Parameters, path: f64) -> (f64, f64) {
        let (omega, path, t) = (500.0, Complex::new(path, 0.0), Complex::new(0.8, -0.5));
        let mut adaptive = AdaptiveFeedforward::new(p, 2);
        let gain = gain_in_use(p, t, omega, true);
        let harmonic = PathHarmonic { omega, path, response: t, hub_over_tool: Complex::ONE };
        let weight = adaptive.tune(p, 2, &harmonic, gain);
        let phasors = [Complex::ZERO, Complex::ONE];
        adaptive.learn(1e-6, &phasors);
        let added = adaptive.output(&[Complex::ZERO, path], &phasors);
        (weight, added / (1e-6 * gain.unwrap().re))
    }

    #[test]
    fn both_explain_an_error_by_what_they_may_be() {
        let p = Parameters::START;
        // as much torque from a wrong gain as from ripple
        let even = RIPPLE * p.servo.torque_max / (WEIGHT * p.servo.inertia * 500.0 * 500.0);
        for (path, w) in [(0.0, 0.0), (even / 3.0, 0.1), (even, 0.5), (3.0 * even, 0.9), (1e3 * even, 1.0)] {
            let (weight, change) = tuned(&p, path);
            assert!((weight - w).abs() < 1e-5, "{path}: {weight}");
            // the resonators have 1 - w of it: without the quicker learning the sum is that of a resonator alone
            assert!((change - w * (1.0 + QUICKER)).abs() < 1e-4, "{path}: {change}");
        }
    }

    #[test]
    fn all_together_are_no_more_than_so_many_harmonics_quicker() {
        let p = Parameters::START;
        let mut adaptive = AdaptiveFeedforward::new(&p, 8);
        let (t, gain) = (Complex::new(0.8, -0.5), Some(Complex::ONE));
        for _ in 0..2 {
            for n in 1..=8 {
                let path = Complex::new(1e-3 * n as f64, 0.0);
                let harmonic = PathHarmonic { omega: 500.0, path, response: t, hub_over_tool: Complex::ONE };
                adaptive.tune(&p, n, &harmonic, gain);
            }
        }
        let all: f64 = (1..=8).map(|n| adaptive.quicker(n) - 1.0).sum();
        assert!((all - QUICKER).abs() < 1e-12 && adaptive.quicker(8) > adaptive.quicker(1), "{all}");
    }

    #[test]
    fn what_is_not_in_use_fades_and_learns_nothing() {
        let mut steady = Steady::new(0.8);
        steady.follow(0.5, 500.0, |_| Complex::new(0.02, 0.0));
        let (p, mut adaptive) = (steady.p, steady.adaptive);
        let harmonic = |response| PathHarmonic {
            omega: 500.0,
            path: Complex::new(0.02, 0.0),
            response,
            hub_over_tool: Complex::ONE,
        };
        // too fast or disabled, a loop that follows ideally, and none that follows
        for (response, gain) in
            [(Complex::I, None), (Complex::ONE, Some(Complex::ONE)), (Complex::ZERO, Some(Complex::ONE))]
        {
            let mut fading = adaptive.clone();
            for _ in 0..200 {
                assert_eq!(fading.tune(&p, 2, &harmonic(response), gain), 0.0);
                fading.learn(1.0, &[Complex::ONE; 4]);
            }
            assert!((fading.torque_ratio() - 1.0).abs() < 1e-6, "{response}: {}", fading.torque_ratio());
            let added = |of: &AdaptiveFeedforward| of.output(&[Complex::ONE; 4], &[Complex::ONE; 4]).abs();
            assert!(added(&fading) < 1e-6 * added(&adaptive), "{response}: {:e}", added(&fading));
        }
        assert!(adaptive.torque_ratio() > 1.2);
        adaptive.clear();
        assert_eq!(adaptive.torque_ratio(), 1.0);
        assert_eq!(adaptive.tune(&p, 9, &harmonic(Complex::I), Some(Complex::ONE)), 0.0);
    }
}

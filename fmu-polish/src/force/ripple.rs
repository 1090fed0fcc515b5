//! Cancels the force ripple at the frequency of the stick-slip and twice that; its phases come from the drive model.

use nalgebra::Complex;
use serde::{Deserialize, Serialize};

use super::harmonic::{FREQUENCY_SHARE, Harmonic};
use super::impedance::Coefficients;
use super::response::closed;
use crate::interface::Parameters;
use crate::motion::stick_slip::phase;

/// What is told when the cancellation has ended itself.
pub const FROZEN: &str = "a part of the ripple cancellation made it worse and has ended\n\
                          hint: make `drive` and `io_delay` those of the machine, or set `ripple.gain` = 0";

/// Harmonics of the stick-slip frequency.
const HARMONICS: usize = 2;
/// Largest velocity of each harmonic, m/s: a tip that bends instead of sliding on a slope of 14 degrees makes a ripple of a
/// quarter of K_v, and 20 mm/s are the most of it.
const VELOCITY_MAX: f64 = 5e-3;
/// Periods over which the amplitude of a ripple is taken.
const WINDOW_PERIODS: u32 = 10;

/// The cancellation.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct RippleCancellation {
    /// velocity to force error at each frequency, N s/m; none if it is too high
    responses: [Option<Complex<f64>>; HARMONICS],
    /// velocities, m/s
    harmonics: [Harmonic; HARMONICS],
    half: u32,
    samples: u32,
    frozen: bool,
}

impl RippleCancellation {
    /// Nothing learned, for the force law `law` on a contact of `stiffness` N/m.
    pub fn new(p: &Parameters, law: &Coefficients, stiffness: f64) -> Self {
        let half = p.stick_slip.half_period.unsigned_abs().max(1);
        let rate = std::f64::consts::TAU / p.sample_period;
        let responses = std::array::from_fn(|i| {
            let omega = rate * (i as f64 + 1.0) / f64::from(2 * half);
            (omega <= FREQUENCY_SHARE * rate).then(|| closed(p, law, stiffness, omega))
        });
        Self { responses, harmonics: Default::default(), half, samples: 0, frozen: false }
    }

    /// Whether a ripple has grown and is not cancelled any more.
    pub fn frozen(&self) -> bool {
        self.frozen
    }

    /// Velocity (m/s) of sample `k` for the force error `error` (N).
    pub fn step(&mut self, p: &Parameters, k: u32, error: f64) -> f64 {
        if p.ripple.gain == 0.0 {
            return 0.0;
        }
        let mut velocity = 0.0;
        for ((m, harmonic), response) in (1..).zip(&mut self.harmonics).zip(self.responses) {
            let Some(response) = response else { continue };
            let carrier = Complex::cis(phase(self.half, m * (k % (2 * self.half))));
            harmonic.observe(carrier, error);
            harmonic.learn(2.0 * p.ripple.gain * p.sample_period, response, carrier, error, VELOCITY_MAX);
            velocity += harmonic.output(carrier);
        }
        self.judge(p);
        velocity
    }

    /// Freezes what makes the ripple worse: a phase of the model is more than a quarter wrong.
    fn judge(&mut self, p: &Parameters) {
        self.samples += 1;
        let window = WINDOW_PERIODS * 2 * self.half;
        if self.samples < window {
            return;
        }
        self.samples = 0;
        for harmonic in &mut self.harmonics {
            self.frozen |= harmonic.judge(p, window, VELOCITY_MAX);
        }
    }
}

#[cfg(test)]
mod tests {
    use std::ops::Range;

    use super::super::impedance::damping;
    use super::*;

    const P: Parameters = Parameters::START;

    /// What a harmonic leaves of a ripple of the amplitude `size` N through the true response, at the angle `angle`.
    fn part(harmonic: &Harmonic, response: Complex<f64>, size: f64, angle: f64) -> f64 {
        let carrier = Complex::cis(angle);
        harmonic.output(response * carrier) + size * carrier.re
    }

    /// Largest error in the samples `counted`, the last ones of a run with ripples of `size` N when the true phase is
    /// `phase_error` rad off; and whether the cancellation has ended itself.
    fn worst_error(phase_error: f64, size: f64, counted: Range<u32>) -> (f64, bool) {
        let law = Coefficients::new(&P, damping(&P, 178e3));
        let mut ripple = RippleCancellation::new(&P, &law, 178e3);
        let truth = ripple.responses.map(|response| response.unwrap() * Complex::cis(phase_error));
        let mut worst: f64 = 0.0;
        for k in 1..counted.end {
            // the plant in the steady state of the learned amplitudes
            let error: f64 =
                (1..).zip(ripple.harmonics).zip(truth).map(|((m, h), t)| part(&h, t, size, phase(10, m * k))).sum();
            ripple.step(&P, k, error);
            if counted.contains(&k) {
                worst = worst.max(error.abs());
            }
        }
        (worst, ripple.frozen())
    }

    #[test]
    fn a_ripple_vanishes_if_the_phase_is_about_right() {
        for phase_error in [0.0, 0.7, -0.7] {
            let (worst, frozen) = worst_error(phase_error, 0.2, 3501..4000);
            assert!(worst < 0.02 && !frozen, "{phase_error}: {worst}");
        }
    }

    #[test]
    fn a_wrong_phase_ends_the_cancellation() {
        for phase_error in [2.5, -2.5] {
            let (worst, frozen) = worst_error(phase_error, 0.1, 1..6000);
            assert!(frozen && worst < 2.5, "{phase_error}: {worst}");
        }
    }

    #[test]
    fn the_first_amplitude_is_that_of_the_ripple() {
        let mut p = P;
        p.ripple.gain = 1e-9;
        let mut ripple = RippleCancellation::new(&p, &Coefficients::new(&p, damping(&p, 178e3)), 178e3);
        for k in 1..=200 {
            ripple.step(&p, k, 0.1 + 0.3 * phase(10, k).cos() + 0.2 * phase(10, 2 * k).sin());
        }
        let [one, two] = ripple.harmonics.map(|harmonic| harmonic.first().unwrap());
        assert!((one - 0.3).abs() < 1e-9 && (two - 0.2).abs() < 1e-9, "{one} {two}");
    }

    #[test]
    fn too_high_a_frequency_is_left_alone() {
        let mut p = P;
        p.stick_slip.half_period = 1;
        let mut ripple = RippleCancellation::new(&p, &Coefficients::new(&p, 1e4), 178e3);
        assert!((1..1000).all(|k| ripple.step(&p, k, if k % 2 == 0 { 1.0 } else { -1.0 }) == 0.0));
    }
}

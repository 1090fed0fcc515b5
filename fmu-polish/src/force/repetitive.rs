//! Repetitive control: learns disturbances that recur with each revolution of the path, from the friction of the axes at
//! their reversals and from the residual of the estimated misalignment.
//!
//! On a spiral both depend on the angle theta of the tangent, in the projection along z, at any feed. The controller
//! learns a travel along the normal, h(theta) = Re sum c_m e^(j m theta), and commands its velocity w dh/dtheta, w =
//! dtheta/dt. On a straight path that is zero. From this travel to the force error the response is H = j m w T(j m w),
//! T that of a velocity. Per radian the fraction `expert.repetitive.gain` of the residual is corrected, so one
//! revolution leaves exp(-2 pi gain), at every feed. Where the loop itself removes more than 1 - `RESPONSE_MIN` of a
//! travel, the correction is slower.

use nalgebra::Complex;
use serde::{Deserialize, Serialize};

use super::harmonic::{FREQUENCY_RATIO, Harmonic};
use super::impedance::Coefficients;
use super::response::closed;
use super::turning::{Rotation, WholeRevolution};
use crate::interface::Parameters;

/// Harmonics of a revolution: four reversals of two axes, and one of the third.
const HARMONICS: usize = 4;
/// Change of the rate after which the responses are computed again, over the rate.
const RATE_CHANGE: f64 = 0.02;
/// Largest way of each, m: friction of 5 N in drives of 0.35 N/um.
const TRAVEL_MAX: f64 = 15e-6;
/// Largest force error that is learned from, over the target force.
pub const ERROR_RATIO: f64 = 0.05;
/// Minimum response, over the stiffness.
const RESPONSE_MIN: f64 = 0.1;

/// The learned harmonics; none by default.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct RepetitiveControl {
    harmonics: [Harmonic; HARMONICS],
    /// way to force error at a rate (rad/s), N/m
    responses: [Complex<f64>; HARMONICS],
    rate: f64,
    window: WholeRevolution,
    frozen: bool,
}

impl RepetitiveControl {
    /// Whether a harmonic has grown and was stopped.
    pub fn stopped(&self) -> bool {
        self.frozen
    }

    /// Velocity (m/s) along the normal where the path turns by `rotation`, from the force error `error` (N), for the
    /// force control `law` on a contact of `stiffness` N/m.
    pub fn step(&mut self, p: &Parameters, law: &Coefficients, stiffness: f64, rotation: Rotation, error: f64) -> f64 {
        let Rotation { angle: theta, step: rotation } = rotation;
        let rate = rotation / p.sample_period;
        let highest = FREQUENCY_RATIO * std::f64::consts::TAU / p.sample_period;
        if p.repetitive.gain == 0.0 || rotation == 0.0 || HARMONICS as f64 * rate.abs() > highest {
            return 0.0;
        }
        if (rate - self.rate).abs() > RATE_CHANGE * rate.abs() {
            self.rate = rate;
            self.responses = std::array::from_fn(|i| response(p, law, stiffness, (i + 1) as f64 * rate));
        }
        // an oscillation is larger than a recurring error
        let maximum = ERROR_RATIO * p.force.target;
        let bounded = error.clamp(-maximum, maximum);
        let mut velocity = 0.0;
        for ((m, harmonic), response) in (1..).map(f64::from).zip(&mut self.harmonics).zip(self.responses) {
            let carrier = Complex::cis(m * theta);
            harmonic.observe(carrier, error);
            harmonic.learn(2.0 * p.repetitive.gain * rotation.abs(), response, carrier, bounded, TRAVEL_MAX);
            velocity += harmonic.output(Complex::new(0.0, m * rate) * carrier);
        }
        self.evaluate(rotation);
        velocity
    }

    /// Stops harmonics that increase the error, after each revolution.
    fn evaluate(&mut self, rotation: f64) {
        let Some(samples) = self.window.ends(rotation) else { return };
        for harmonic in &mut self.harmonics {
            // friction and mold stay as they are
            self.frozen |= harmonic.evaluate(samples, 1.0, TRAVEL_MAX);
        }
    }
}

/// Force error over way (N/m) along the normal at `omega` rad/s; no less than what would learn noise.
fn response(p: &Parameters, law: &Coefficients, stiffness: f64, omega: f64) -> Complex<f64> {
    let response = Complex::new(0.0, omega) * closed(p, law, stiffness, omega);
    response * (RESPONSE_MIN * stiffness / response.norm()).max(1.0)
}

#[cfg(test)]
mod tests {
    use super::super::impedance::damping;
    use super::super::turning::Turning;
    use super::*;
    use nalgebra::Vector3;

    const P: Parameters = Parameters::START;
    const K: f64 = 178e3;

    /// Force errors of `revolutions` turns at `rate` rad/s, in the steady state of the loop, where the travels of a
    /// disturbance along the normal are `size` m in each harmonic and the true phase is `late` rad off: root mean
    /// square of each revolution, and whether the learning has ended itself.
    fn errors(p: &Parameters, rate: f64, size: f64, late: f64, revolutions: u32) -> (Vec<f64>, bool) {
        let law = Coefficients::new(p, damping(p, K));
        let (mut learning, mut turning) = (RepetitiveControl::default(), Turning::default());
        let actual: [Complex<f64>; HARMONICS] = std::array::from_fn(|i| {
            let omega = rate * (i as f64 + 1.0);
            Complex::new(0.0, omega) * closed(p, &law, K, omega) * Complex::cis(-late)
        });
        let period = (std::f64::consts::TAU / rate.abs() / p.sample_period).round();
        let mut found = Vec::new();
        for _ in 0..revolutions {
            let mut square = 0.0;
            for k in 0..period as u32 {
                let theta = std::f64::consts::TAU * f64::from(k) / period * rate.signum();
                let error: f64 = (1..)
                    .map(f64::from)
                    .zip(&learning.harmonics)
                    .zip(actual)
                    .map(|((m, h), t)| h.output(t * Complex::cis(m * theta)) + size * (t * Complex::cis(m * theta)).re)
                    .sum();
                square += error * error / period;
                learning.step(p, &law, K, turning.step(&Vector3::new(theta.cos(), theta.sin(), 0.0)), error);
            }
            found.push(square.sqrt());
        }
        (found, learning.stopped())
    }

    #[test]
    fn a_revolution_leaves_its_fraction_at_every_feed_and_in_both_directions() {
        let ratio = (-std::f64::consts::TAU * P.repetitive.gain).exp();
        for rate in [25.0, -25.0, 8.0] {
            let (found, frozen) = errors(&P, rate, 0.4e-6, 0.0, 8);
            assert!((found[4] / found[3] - ratio).abs() < 0.12 && !frozen, "{rate}: {found:?}");
            assert!(found[7] < 0.02 * found[0], "{rate}: {found:?}");
        }
    }

    #[test]
    fn a_phase_that_is_a_sixth_of_a_turn_off_only_makes_it_slower() {
        for late in [0.9, -0.9] {
            let (found, frozen) = errors(&P, 25.0, 0.4e-6, late, 12);
            assert!(found[11] < 0.1 * found[0] && !frozen, "{late}: {found:?}");
        }
    }

    #[test]
    fn a_phase_with_the_wrong_sign_ends_it() {
        let (found, frozen) = errors(&P, 25.0, 3e-6, 2.8, 12);
        assert!(frozen && found.iter().all(|&error| error < 6.0), "{found:?}");
    }

    #[test]
    fn nothing_is_moved_on_a_straight_path_and_beyond_what_the_loop_can_do() {
        let law = Coefficients::new(&P, damping(&P, K));
        let (mut learning, mut turning) = (RepetitiveControl::default(), Turning::default());
        assert!((0..1000).all(|_| learning.step(&P, &law, K, turning.step(&Vector3::x()), 1.0) == 0.0));
        // a curve so sharp that only the lower harmonics are slow enough: none is learned
        let highest = FREQUENCY_RATIO * std::f64::consts::TAU / P.sample_period;
        for (ratio, moves) in [(0.99, true), (1.01, false)] {
            let rotation = ratio * highest / HARMONICS as f64 * P.sample_period;
            let (mut learning, mut turning) = (RepetitiveControl::default(), Turning::default());
            let mut step = |k: u32| {
                let theta = rotation * f64::from(k);
                learning.step(&P, &law, K, turning.step(&Vector3::new(theta.cos(), theta.sin(), 0.0)), 0.5)
            };
            assert_eq!((0..100).any(|k| step(k) != 0.0), moves, "{ratio}");
        }
        // a corner within a sample
        assert_eq!(learning.step(&P, &law, K, turning.step(&-Vector3::x()), 1.0), 0.0);
    }
}

//! Feedforward: each harmonic of the path is shifted by the inverse of the position loop's response.
//!
//! The angle b_d itself comes exactly from the depth; only what is added to it is a series:
//! Re sum (H/T - 1) B_n e^(j n theta), with T at n times the spindle speed and H = hub over tool of the flexure.

use nalgebra::Complex;
use serde::{Deserialize, Serialize};

/// T is never taken for less, so that a loop that does not follow is not driven without limit.
const RESPONSE_MIN: f64 = 0.02;

/// Feedforward that is added to the reference angle, rad.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Shift {
    /// To the angle that the hub should have.
    pub target: f64,
    /// To the set-point of the position loop, target included.
    pub set_point: f64,
}

/// Factors of the harmonics, n = 1 first.
#[derive(Clone, Debug, Serialize, Deserialize)]
pub struct HarmonicFeedforward {
    target: Vec<Complex<f64>>,
    set_point: Vec<Complex<f64>>,
}

impl HarmonicFeedforward {
    /// No shift of any of `highest` harmonics.
    pub fn new(highest: usize) -> Self {
        Self { target: vec![Complex::default(); highest], set_point: vec![Complex::default(); highest] }
    }

    /// Takes the response `t` and the flexure `hub_over_tool` at harmonic `n`.
    pub fn tune(&mut self, n: usize, t: Complex<f64>, hub_over_tool: Complex<f64>) {
        if let (Some(target), Some(set_point)) = (self.target.get_mut(n - 1), self.set_point.get_mut(n - 1)) {
            *target = hub_over_tool - 1.0;
            *set_point = hub_over_tool / at_least(t, RESPONSE_MIN) - 1.0;
        }
    }

    /// The shifts from the harmonics of the angle and e^(j n theta), n = 1 first.
    pub fn shift(&self, angle: &[Complex<f64>], phasors: &[Complex<f64>]) -> Shift {
        let mut shift = Shift::default();
        for (((b, phasor), target), set_point) in angle.iter().zip(phasors).zip(&self.target).zip(&self.set_point) {
            let rotated = b * phasor;
            shift.target += target.re * rotated.re - target.im * rotated.im;
            shift.set_point += set_point.re * rotated.re - set_point.im * rotated.im;
        }
        shift
    }
}

/// The same phase with a magnitude of at least `minimum`.
fn at_least(t: Complex<f64>, minimum: f64) -> Complex<f64> {
    let magnitude = t.norm();
    if magnitude >= minimum { t } else { Complex::from_polar(minimum, t.arg()) }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::tracking::phasors::Phasors;

    #[test]
    fn a_shifted_harmonic_arrives_at_its_reference() {
        let (b, t, h) = (Complex::new(0.02, -0.01), Complex::new(0.9, -0.4), Complex::new(0.97, 0.001));
        let mut feedforward = HarmonicFeedforward::new(3);
        feedforward.tune(2, t, h);
        let harmonics = [Complex::default(), b, Complex::new(5.0, 5.0)];
        for theta in [0.0, 0.5, 2.0] {
            let phasors = Phasors::new(theta, 3);
            let shift = feedforward.shift(&harmonics, phasors.from_one());
            let rotated = b * phasors.from_one()[1];
            // set-point B (1 + shift) times T is the motion of the hub H B
            let set_point = (b * (h / t - 1.0) * phasors.from_one()[1]).re;
            assert!((shift.set_point - set_point).abs() < 1e-15);
            assert!((shift.target - (rotated * (h - 1.0)).re).abs() < 1e-15);
        }
    }

    #[test]
    fn a_loop_that_does_not_follow_is_not_driven_without_limit() {
        let mut feedforward = HarmonicFeedforward::new(1);
        feedforward.tune(1, Complex::default(), Complex::new(1.0, 0.0));
        feedforward.tune(7, Complex::default(), Complex::new(1.0, 0.0));
        let shift = feedforward.shift(&[Complex::new(1e-3, 0.0)], &[Complex::new(1.0, 0.0)]);
        assert!(shift.set_point.abs() < 0.06, "{shift:?}");
    }
}

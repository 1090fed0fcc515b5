//! Lead-lag compensator: crossover, Tustin discretization, recursion with the torque limit inside.
//!
//! ```text
//! K(s) = K (s + w_z)(s + w_i) / ((s + w_p) s (s / w_r + 1))
//! ```

use nalgebra::Complex;
use serde::{Deserialize, Serialize};

use crate::servo::nominal::Nominal;

/// Crossover over the zero of the integrator: 6 degrees of phase at the crossover.
pub const LAG: f64 = 10.0;

/// Coefficients of the discrete compensator in falling powers of z.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct LeadLag {
    /// Numerator, N.m/rad.
    pub numerator: [f64; 4],
    /// Denominator; the first is 1.
    pub denominator: [f64; 4],
}

impl LeadLag {
    /// Compensator for a rigid arm with its crossover at `crossover` (rad/s).
    pub fn new(nominal: impl Into<Nominal>, crossover: f64) -> Self {
        let Nominal { servo, sample_period, .. } = nominal.into();
        let (zero, pole) = (crossover / servo.lead, crossover * servo.lead);
        let (integral, roll_off) = (crossover / LAG, servo.roll_off);
        let numerator = [zero * integral, zero + integral, 1.0, 0.0];
        let denominator = [0.0, pole, 1.0 + pole / roll_off, 1.0 / roll_off];
        // unit loop gain of a rigid arm at the crossover
        let at = Complex::new(0.0, crossover);
        let gain =
            servo.inertia * crossover * crossover * evaluate(&denominator, at).norm() / evaluate(&numerator, at).norm();
        let (b, a) = (tustin(&numerator, sample_period), tustin(&denominator, sample_period));
        Self { numerator: b.map(|x| gain * x / a[0]), denominator: a.map(|x| x / a[0]) }
    }

    /// Response (N.m/rad) at z.
    pub fn response(&self, z: Complex<f64>) -> Complex<f64> {
        let falling = |c: &[f64; 4]| ((z * c[0] + c[1]) * z + c[2]) * z + c[3];
        falling(&self.numerator) / falling(&self.denominator)
    }
}

/// Polynomial with rising coefficients.
fn evaluate(rising: &[f64; 4], s: Complex<f64>) -> Complex<f64> {
    rising.iter().rev().fold(Complex::new(0.0, 0.0), |sum, c| sum * s + c)
}

/// A polynomial in s (rising) as one in z (falling): s = 2/T (z - 1)/(z + 1), times (z + 1)^3.
fn tustin(rising: &[f64; 4], period: f64) -> [f64; 4] {
    const POWERS: [[f64; 4]; 4] =
        [[1.0, 3.0, 3.0, 1.0], [1.0, 1.0, -1.0, -1.0], [1.0, -1.0, -1.0, 1.0], [1.0, -3.0, 3.0, -1.0]];
    let mut falling = [0.0; 4];
    let mut scale = 1.0;
    for (coefficient, power) in rising.iter().zip(&POWERS) {
        falling.iter_mut().zip(power).for_each(|(sum, x)| *sum += coefficient * scale * x);
        scale *= 2.0 / period;
    }
    falling
}

/// The recursion; by default at rest.
#[derive(Clone, Debug, Default, Serialize, Deserialize)]
pub struct Recursion {
    errors: [f64; 3],
    torques: [f64; 3],
    /// The last torque was cut off.
    pub saturated: bool,
}

impl Recursion {
    /// Torque (N.m) for an error (rad), at most `limit` (N.m); the recursion stores the limited torque, so nothing winds up.
    pub fn update(&mut self, k: &LeadLag, error: f64, limit: f64) -> f64 {
        let (b, a) = (&k.numerator, &k.denominator);
        let [e1, e2, e3] = self.errors;
        let [u1, u2, u3] = self.torques;
        let unlimited = b[0] * error + b[1] * e1 + b[2] * e2 + b[3] * e3 - a[1] * u1 - a[2] * u2 - a[3] * u3;
        let torque = unlimited.clamp(-limit, limit);
        self.saturated = torque != unlimited;
        (self.errors, self.torques) = ([error, e1, e2], [torque, u1, u2]);
        torque
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::interface::Parameters;
    use std::f64::consts::TAU;

    #[test]
    fn the_coefficients_for_a_crossover_of_118_843_hz() {
        let k = LeadLag::new(&Parameters::START, TAU * 118.843);
        let b = [689.200_126_12, -671.326_035_73, -689.105_297_56, 671.420_864_33];
        let a = [1.0, -1.860_323_523_25, 0.949_285_321_23, -0.088_961_797_98];
        for (found, expected) in k.numerator.iter().zip(b).chain(k.denominator.iter().zip(a)) {
            assert!((found - expected).abs() < 2e-5 * expected.abs(), "{found} {expected}");
        }
    }

    #[test]
    fn the_recursion_is_the_transfer_function() {
        let k = LeadLag::new(&Parameters::START, TAU * 118.843);
        let omega: f64 = TAU * 80.0 * 1e-4;
        let z = Complex::new(omega.cos(), omega.sin());
        let (mut recursion, mut sum) = (Recursion::default(), Complex::new(0.0, 0.0));
        // 80 periods to settle, 8 to measure; the integrator keeps a constant that a whole period averages out
        for n in 0..11_000 {
            let phase = omega * f64::from(n);
            let torque = recursion.update(&k, phase.cos(), f64::INFINITY);
            if n >= 10_000 {
                sum += torque * Complex::new(phase.cos(), -phase.sin()) * 2.0 / 1000.0;
            }
        }
        assert!((sum - k.response(z)).norm() < 1e-3 * k.response(z).norm(), "{sum} {}", k.response(z));
    }

    #[test]
    fn a_long_saturation_is_over_as_soon_as_the_error_turns() {
        let k = LeadLag::new(&Parameters::START, TAU * 118.843);
        let mut recursion = Recursion::default();
        // the error rises slowly, stays for 2 s and falls again
        for n in 0..21_000 {
            let torque = recursion.update(&k, 1e-4 * f64::from(n.min(1000)), 7.0);
            assert!(torque.abs() <= 7.0);
        }
        assert!(recursion.saturated);
        assert!(recursion.update(&k, 0.0999, 7.0) < 7.0);
    }
}

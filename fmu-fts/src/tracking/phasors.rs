//! e^(j n theta) for all harmonics of one sample: one sine and cosine, then a rotation for each harmonic.

use nalgebra::Complex;

use crate::lists::harmonics::HIGHEST;

/// e^(j n theta) for n = 0 to the highest harmonic in use.
#[derive(Clone, Debug)]
pub struct Phasors {
    values: [Complex<f64>; HIGHEST + 1],
    count: usize,
}

impl Phasors {
    /// The phasors of the angle `theta` (rad) up to harmonic `highest`.
    pub fn new(theta: f64, highest: usize) -> Self {
        let mut values = [Complex::new(1.0, 0.0); HIGHEST + 1];
        let (sine, cosine) = theta.sin_cos();
        let rotation = Complex::new(cosine, sine);
        let count = highest.min(HIGHEST) + 1;
        for n in 1..count {
            values[n] = values[n - 1] * rotation;
        }
        Self { values, count }
    }

    /// e^(j n theta), n = 0 first.
    pub fn from_zero(&self) -> &[Complex<f64>] {
        &self.values[..self.count]
    }

    /// e^(j n theta), n = 1 first.
    pub fn from_one(&self) -> &[Complex<f64>] {
        &self.values[1..self.count]
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_recurrence_is_exact_to_rounding() {
        for theta in [0.0, 1.0, -2.5, 1e6] {
            let phasors = Phasors::new(theta, 64);
            for (n, phasor) in phasors.from_zero().iter().enumerate() {
                let (s, c) = (n as f64 * (theta % std::f64::consts::TAU)).sin_cos();
                assert!(
                    (phasor - Complex::new(c, s)).norm() < 1e-8_f64.min(1e-14 * theta.abs().max(1e2)),
                    "{theta} {n}"
                );
            }
        }
    }

    #[test]
    fn one_comes_after_zero() {
        let phasors = Phasors::new(0.3, 24);
        assert_eq!(phasors.from_zero().len(), 25);
        assert_eq!(phasors.from_one()[0], phasors.from_zero()[1]);
    }
}

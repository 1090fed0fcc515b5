//! Linear least squares of y = b0 + b1 sin(theta) + b2 cos(theta), eq. 24 to 27.

use nalgebra::{Matrix3, Vector3};
use serde::{Deserialize, Serialize};

/// Parameters of the sine.
const PARAMETERS: f64 = 3.0;

/// Sums of the normal equations; by default without data. Nothing is stored per sample.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct SineSums {
    count: u32,
    /// the first value: the others are taken relative to it, so that micrometers on meters keep their digits
    base: f64,
    normal: Matrix3<f64>,
    right: Vector3<f64>,
    square: f64,
}

/// A fitted sine.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Sine {
    /// Mean value b0.
    pub mean: f64,
    /// Coefficient b1 of the sine.
    pub sine: f64,
    /// Coefficient b2 of the cosine.
    pub cosine: f64,
    /// Standard deviation of b1 and b2, from the residuals.
    pub sigma: f64,
}

impl SineSums {
    /// Adds the value `y` at the angle `theta` rad.
    pub fn add(&mut self, theta: f64, y: f64) {
        if self.count == 0 {
            self.base = y;
        }
        let (sine, cosine) = theta.sin_cos();
        let row = Vector3::new(1.0, sine, cosine);
        let value = y - self.base;
        self.normal += row * row.transpose();
        self.right += row * value;
        self.square += value * value;
        self.count += 1;
    }

    /// Minimum of eq. 25; none if the angles do not determine the three coefficients.
    pub fn fit(&self) -> Option<Sine> {
        let spare = f64::from(self.count) - PARAMETERS;
        let factor = (self.normal / f64::from(self.count.max(1))).cholesky()?;
        let inverse = factor.inverse() / f64::from(self.count);
        let b = inverse * self.right;
        let residual = (self.square - b.dot(&self.right)).max(0.0);
        let variance = if spare > 0.0 { residual / spare } else { 0.0 };
        let sigma = (0.5 * variance * (inverse[(1, 1)] + inverse[(2, 2)])).sqrt();
        let sine = Sine { mean: self.base + b[0], sine: b[1], cosine: b[2], sigma };
        (spare >= 0.0 && b.iter().all(|x| x.is_finite())).then_some(sine)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::f64::consts::TAU;

    fn fitted(values: impl Iterator<Item = (f64, f64)>) -> Option<Sine> {
        let mut sums = SineSums::default();
        values.for_each(|(theta, y)| sums.add(theta, y));
        sums.fit()
    }

    #[test]
    fn a_sine_is_found_exactly() {
        let (b0, b1, b2) = (0.123, -3e-4, 4e-4);
        let angle = |k| TAU * f64::from(k) / 198.0 + 0.7;
        let sine = fitted((0..198).map(|k| (angle(k), b0 + b1 * angle(k).sin() + b2 * angle(k).cos()))).unwrap();
        assert!((sine.mean - b0).abs() < 1e-15 && (sine.sine - b1).abs() < 1e-15 && (sine.cosine - b2).abs() < 1e-15);
        assert!(sine.sigma < 1e-10, "{}", sine.sigma);
    }

    #[test]
    fn lobes_do_not_leak_into_a_full_turn() {
        let angle = |k| TAU * f64::from(k) / 200.0;
        let lobed = |x: f64| 1e-6 * (x.sin() + 3.0 * (2.0 * x + 1.0).cos() + 2.0 * (3.0 * x).sin());
        let sine = fitted((0..200).map(|k| (angle(k), lobed(angle(k))))).unwrap();
        assert!((sine.sine - 1e-6).abs() < 1e-15 && sine.cosine.abs() < 1e-15);
    }

    #[test]
    fn sigma_is_that_of_the_coefficients() {
        // alternating error of 1: variance of b1 and b2 is 2/n
        let sine = fitted((0..200).map(|k| (TAU * f64::from(k) / 200.0, f64::from(k % 2) * 2.0 - 1.0))).unwrap();
        assert!((sine.sigma - (2.0f64 / 200.0).sqrt()).abs() < 1e-3, "{}", sine.sigma);
    }

    #[test]
    fn a_spindle_at_rest_gives_no_sine() {
        assert_eq!(fitted(std::iter::empty()), None);
        assert_eq!(fitted((0..2).map(|k| (f64::from(k), 0.1))), None);
        assert_eq!(fitted((0..100).map(|_| (1.0, 0.1))), None);
    }
}

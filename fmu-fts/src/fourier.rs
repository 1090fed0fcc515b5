//! Fourier series of a function of the spindle angle: x(theta) = Re sum c_n e^(j n theta), c_n = a_n - j b_n.

use std::f64::consts::TAU;

use nalgebra::Complex;

/// Angles at which a function is sampled: four times the highest harmonic.
pub const SAMPLES: usize = 256;

/// The sampled angles, rad.
pub fn angles() -> impl Iterator<Item = f64> {
    (0..SAMPLES).map(|k| TAU * k as f64 / SAMPLES as f64)
}

/// Turns samples into harmonics and back.
pub struct Fourier {
    /// e^(j theta) at the sampled angles
    circle: Vec<Complex<f64>>,
}

impl Fourier {
    /// The table of the circle.
    pub fn new() -> Self {
        Self { circle: angles().map(|theta| Complex::new(theta.cos(), theta.sin())).collect() }
    }

    /// Coefficients c_0 to c_N of [`SAMPLES`] values.
    pub fn harmonics(&self, values: &[f64], highest: usize) -> Vec<Complex<f64>> {
        let coefficient = |n: usize| {
            let sum: Complex<f64> =
                values.iter().enumerate().map(|(k, x)| self.circle[n * k % SAMPLES].conj() * *x).sum();
            sum * (if n == 0 { 1.0 } else { 2.0 } / SAMPLES as f64)
        };
        (0..=highest).map(coefficient).collect()
    }

    /// The series at the sampled angles.
    pub fn values(&self, harmonics: &[Complex<f64>]) -> Vec<f64> {
        let value =
            |k: usize| harmonics.iter().enumerate().map(|(n, c)| (c * self.circle[n * k % SAMPLES]).re).sum::<f64>();
        (0..SAMPLES).map(value).collect()
    }
}

impl Default for Fourier {
    fn default() -> Self {
        Self::new()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn harmonics_are_found_and_give_the_values_back() {
        let function = |t: f64| 3.0 + 2.0 * (2.0 * t).cos() - 0.5 * (7.0 * t).sin() + 0.1 * (64.0 * t).cos();
        let values: Vec<f64> = angles().map(function).collect();
        let fourier = Fourier::new();
        let c = fourier.harmonics(&values, 64);
        let expect = |n: usize, re: f64, im: f64| assert!((c[n] - Complex::new(re, im)).norm() < 1e-14, "{n} {}", c[n]);
        expect(0, 3.0, 0.0);
        expect(2, 2.0, 0.0);
        // c_n = a_n - j b_n
        expect(7, 0.0, 0.5);
        expect(64, 0.1, 0.0);
        expect(3, 0.0, 0.0);
        let back = fourier.values(&c);
        assert!(values.iter().zip(back).all(|(x, y)| (x - y).abs() < 1e-13));
    }
}

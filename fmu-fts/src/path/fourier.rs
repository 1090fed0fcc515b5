//! Fourier series of a function of the spindle angle: x(theta) = Re sum c_n e^(j n theta), c_n = a_n - j b_n.

use std::f64::consts::TAU;

use nalgebra::Complex;

use crate::lists::harmonics::HIGHEST;

/// Angles at which a function is sampled: four times the highest harmonic.
pub const SAMPLES: usize = 256;
/// Harmonics with the constant.
const COUNT: usize = HIGHEST + 1;

/// The sampled angles, rad.
pub fn angles() -> impl Iterator<Item = f64> {
    (0..SAMPLES).map(|k| TAU * k as f64 / SAMPLES as f64)
}

/// Turns samples into harmonics and back.
///
/// Both sums run along the tables, not along their own terms: neighbors are independent, so that the
/// processor computes several simultaneously, and each is still summed in its order.
pub struct Fourier {
    /// e^(-j n theta), all harmonics of an angle, angle after angle
    by_angle: Vec<Complex<f64>>,
    /// cos(n theta) and sin(n theta), all angles of a harmonic, harmonic after harmonic
    by_harmonic: [Vec<f64>; 2],
}

impl Fourier {
    /// The tables of the circle.
    pub fn new() -> Self {
        let circle: Vec<_> = angles().map(|theta| Complex::new(theta.cos(), theta.sin())).collect();
        let at = |n: usize, k: usize| circle[n * k % SAMPLES];
        let by_harmonic = |part: fn(Complex<f64>) -> f64| {
            (0..COUNT).flat_map(|n| (0..SAMPLES).map(move |k| (n, k))).map(|(n, k)| part(at(n, k))).collect()
        };
        Self {
            by_angle: (0..SAMPLES)
                .flat_map(|k| (0..COUNT).map(move |n| (n, k)))
                .map(|(n, k)| at(n, k).conj())
                .collect(),
            by_harmonic: [by_harmonic(|c| c.re), by_harmonic(|c| c.im)],
        }
    }

    /// Coefficients c_0 to c_N of [`SAMPLES`] values, N at most [`HIGHEST`].
    pub fn harmonics(&self, values: &[f64], highest: usize) -> Vec<Complex<f64>> {
        let mut sums = vec![Complex::default(); highest + 1];
        for (x, circle) in values.iter().zip(self.by_angle.chunks_exact(COUNT)) {
            sums.iter_mut().zip(circle).for_each(|(sum, phasor)| *sum += phasor * *x);
        }
        let scale = |n: usize| if n == 0 { 1.0 } else { 2.0 } / SAMPLES as f64;
        sums.iter().enumerate().map(|(n, sum)| sum * scale(n)).collect()
    }

    /// The series at the sampled angles.
    pub fn values(&self, harmonics: &[Complex<f64>]) -> Vec<f64> {
        let [cosines, sines] = self.by_harmonic.each_ref().map(|table| table.chunks_exact(SAMPLES));
        let mut values = vec![0.0; SAMPLES];
        for ((c, cosines), sines) in harmonics.iter().zip(cosines).zip(sines) {
            values.iter_mut().zip(cosines).zip(sines).for_each(|((sum, cos), sin)| *sum += c.re * cos - c.im * sin);
        }
        values
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

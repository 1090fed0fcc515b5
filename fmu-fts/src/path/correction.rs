//! Correction of the form: added to the coefficients a_n(x) and b_n(x) of eq. 2, as derived from a probed lens.
//!
//! Constant errors of a machine are smooth over the lens: a wrong arm length, center offset or angle, the wind-up of
//! the arm and a late spindle reading make errors of the few harmonics of the lens itself, which change with the radius
//! as its slope and its depth do. So each coefficient is a polynomial of the third degree in the slide position, over
//! what was probed.

use nalgebra::Complex;
use serde::{Deserialize, Serialize};

/// Highest harmonic that is corrected.
pub const HIGHEST_CORRECTED: usize = 4;
/// Legendre polynomials over the slide position.
pub const POLYNOMIALS: usize = 4;

/// Correction of the depth over slide position and spindle angle.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct Correction {
    /// Slide positions between which it was probed, m; beyond, that of the nearer end counts.
    pub span: [f64; 2],
    /// Coefficients c_nk of P_k in c_n = a_n - j b_n, m.
    pub coefficients: [[Complex<f64>; POLYNOMIALS]; HIGHEST_CORRECTED + 1],
}

impl Correction {
    /// Harmonics c_n (m) at a slide position (m).
    pub fn harmonics(&self, slide_position: f64) -> [Complex<f64>; HIGHEST_CORRECTED + 1] {
        let basis = legendre(scaled(&self.span, slide_position));
        self.coefficients.each_ref().map(|row| row.iter().zip(basis).map(|(c, p)| c * p).sum())
    }

    /// Depth (m) that is added at a slide position (m), with e^(j n theta), n = 0 first.
    pub fn depth(&self, slide_position: f64, phasors: &[Complex<f64>]) -> f64 {
        self.harmonics(slide_position).iter().zip(phasors).map(|(c, phasor)| (c * phasor).re).sum()
    }

    /// The same without the harmonics above one.
    pub fn up_to(mut self, harmonic: usize) -> Self {
        self.coefficients.iter_mut().skip(harmonic + 1).for_each(|row| *row = Default::default());
        self
    }

    /// Upper bound of the magnitude of the derivative of the depth by the spindle angle, of the given order (0: the
    /// depth), m/rad^order.
    pub fn bound(&self, order: i32) -> f64 {
        let row = |(n, row): (usize, &[Complex<f64>; POLYNOMIALS])| {
            // no Legendre polynomial is above 1
            (n as f64).powi(order) * row.iter().map(|c| c.norm()).sum::<f64>()
        };
        self.coefficients.iter().enumerate().map(row).sum()
    }
}

/// Place of a slide position between two others, -1 to 1.
pub fn scaled(span: &[f64; 2], slide_position: f64) -> f64 {
    ((2.0 * slide_position - span[0] - span[1]) / (span[1] - span[0])).clamp(-1.0, 1.0)
}

/// Legendre polynomials P_0 to P_3.
pub fn legendre(u: f64) -> [f64; POLYNOMIALS] {
    [1.0, u, 1.5 * u * u - 0.5, (2.5 * u * u - 1.5) * u]
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::tracking::phasors::Phasors;

    fn correction() -> Correction {
        let mut coefficients = [[Complex::default(); POLYNOMIALS]; HIGHEST_CORRECTED + 1];
        coefficients[0][1] = Complex::new(2e-6, 0.0);
        coefficients[2] = [1e-6, 3e-6, -2e-6, 5e-7].map(|a| Complex::new(a, -2.0 * a));
        Correction { span: [0.04, 0.05], coefficients }
    }

    #[test]
    fn the_depth_is_the_sum_of_its_harmonics_and_holds_its_ends() {
        let correction = correction();
        for (x, u) in [(0.04, -1.0), (0.0425, -0.5), (0.05, 1.0), (0.02, -1.0), (0.09, 1.0)] {
            let u: f64 = u;
            let [p1, p2, p3] = [u, 1.5 * u * u - 0.5, 2.5 * u.powi(3) - 1.5 * u];
            let a2 = 1e-6 + 3e-6 * p1 - 2e-6 * p2 + 5e-7 * p3;
            for theta in [0.0, 0.3, 2.0] {
                let expected = 2e-6 * u + a2 * (2.0 * f64::cos(2.0 * theta) * 0.5 + 2.0 * f64::sin(2.0 * theta));
                let depth = correction.depth(x, Phasors::new(theta, 12).from_zero());
                assert!((depth - expected).abs() < 1e-18, "{x} {theta}: {depth:e} {expected:e}");
            }
        }
    }

    #[test]
    fn nothing_is_above_its_bound() {
        let correction = correction();
        for order in 0..3 {
            let mut largest: f64 = 0.0;
            for k in 0..40 {
                let harmonics = correction.harmonics(0.04 + 2.5e-4 * f64::from(k));
                for theta in (0..60).map(|i| 0.1 * f64::from(i)) {
                    let term = |(n, c): (usize, &Complex<f64>)| {
                        let n = n as f64;
                        (c * Complex::new(0.0, n).powi(order) * Complex::from_polar(1.0, n * theta)).re
                    };
                    largest = largest.max(harmonics.iter().enumerate().map(term).sum::<f64>().abs());
                }
            }
            let bound = correction.bound(order);
            assert!(largest <= bound && largest > 0.4 * bound, "{order}: {largest:e} {bound:e}");
        }
    }

    #[test]
    fn the_polynomials_are_orthogonal() {
        for (i, j) in [(0, 1), (0, 2), (1, 2), (1, 3), (2, 3)] {
            let product = |k: i32| {
                let basis = legendre((f64::from(k) + 0.5) / 500.0 - 1.0);
                basis[i] * basis[j] / 500.0
            };
            assert!((0..1000).map(product).sum::<f64>().abs() < 1e-5, "{i} {j}");
        }
    }
}

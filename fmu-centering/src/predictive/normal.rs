//! Normal equations of weighted least squares with a prior, relative to the point of linearization.

use serde::{Deserialize, Serialize};

use crate::predictive::ring_estimate::{Gaussian, Matrix};
use crate::predictive::ring_line::{ANY, Vector};

/// Prior: a mean, and the inverse of its covariance.
#[derive(Clone, Debug, Serialize, Deserialize)]
pub struct Prior {
    mean: Vector<ANY>,
    /// only the lower triangle is used
    information: Matrix<ANY>,
}

impl Prior {
    /// Prior from a lower triangular square root of the covariance.
    pub fn of(known: &Gaussian<ANY>) -> Self {
        let inverse = inverse(&known.root);
        Self { mean: known.mean, information: inverse.tr_mul(&inverse) }
    }
}

/// Sums of the normal equations; lower triangle of the symmetric matrix.
#[derive(Clone, Debug)]
pub struct NormalEquations {
    information: Matrix<ANY>,
    product: Vector<ANY>,
}

/// A solution.
#[derive(Clone, Debug)]
pub struct Solution {
    /// Difference from the point of linearization.
    pub step: Vector<ANY>,
    /// A square root of the covariance.
    pub root: Matrix<ANY>,
}

impl NormalEquations {
    /// The prior alone, at a point of linearization.
    pub fn new(prior: &Prior, linear: &Vector<ANY>) -> Self {
        Self { information: prior.information, product: prior.information * (prior.mean - linear) }
    }

    /// Adds a measurement that is `innovation` more than at the point of linearization; its `weight` is the inverse of its
    /// variance.
    pub fn add(&mut self, innovation: f64, gradient: &Vector<ANY>, weight: f64) {
        self.product.axpy(weight * innovation, gradient, 1.0);
        let (gradient, sums) = (gradient.as_slice(), self.information.as_mut_slice());
        for (i, column) in sums.chunks_exact_mut(ANY).enumerate() {
            let factor = weight * gradient[i];
            for (sum, term) in column[i..].iter_mut().zip(&gradient[i..]) {
                *sum += factor * term;
            }
        }
    }

    /// The minimum; none where rounding leaves none.
    pub fn solve(&self) -> Option<Solution> {
        // only the lower triangle is read
        let inverse = inverse(&self.information.cholesky()?.l());
        let root = inverse.transpose();
        let step = root * (inverse * self.product);
        step.iter().all(|x| x.is_finite()).then_some(Solution { step, root })
    }
}

/// Inverse of a lower triangle, column by column and without what is zero.
fn inverse(lower: &Matrix<ANY>) -> Matrix<ANY> {
    let mut inverse = Matrix::<ANY>::identity();
    for (j, column) in inverse.as_mut_slice().chunks_exact_mut(ANY).enumerate() {
        for (k, pivots) in lower.as_slice().chunks_exact(ANY).enumerate().skip(j) {
            column[k] /= pivots[k];
            let solved = column[k];
            column[k + 1..].iter_mut().zip(&pivots[k + 1..]).for_each(|(rest, factor)| *rest -= factor * solved);
        }
    }
    inverse
}

#[cfg(test)]
mod tests {
    use super::*;

    fn prior(sigma: f64) -> Prior {
        Prior::of(&Gaussian { mean: Vector::from_element(0.5), root: Matrix::identity() * sigma })
    }

    #[test]
    fn a_state_that_is_measured_once_is_the_mean_by_information() {
        let (prior, linear) = (prior(1.0), Vector::from_element(0.25));
        let mut equations = NormalEquations::new(&prior, &linear);
        let mut gradient = Vector::zeros();
        gradient[7] = 2.0;
        // prior 0.5 with variance 1, measured 1 with variance 1/3 of its double
        equations.add(1.5, &gradient, 3.0 / 4.0);
        let found = equations.solve().unwrap();
        assert!((found.step[7] - (0.25 * 1.0 + 0.75 * 3.0) / 4.0).abs() < 1e-15, "{}", found.step[7]);
        assert!((found.step[6] - 0.25).abs() < 1e-15);
        let covariance = found.root * found.root.transpose();
        assert!((covariance[(7, 7)] - 0.25).abs() < 1e-15 && (covariance[(6, 6)] - 1.0).abs() < 1e-15);
    }

    #[test]
    fn states_that_are_measured_together_are_the_least_squares() {
        let (prior, linear) = (prior(1e6), Vector::zeros());
        let target = Vector::from_fn(|i, _| 1.0 + i as f64);
        let mut equations = NormalEquations::new(&prior, &linear);
        for k in 0..3 * ANY {
            let gradient = Vector::<ANY>::from_fn(|i, _| (1.0 + 0.7 * k as f64 * (i + 1) as f64).sin());
            equations.add(gradient.dot(&target), &gradient, 1.0);
        }
        let found = equations.solve().unwrap();
        assert!((found.step - target).amax() < 1e-6, "{}", (found.step - target).amax());
    }

    #[test]
    fn a_solution_is_what_measurements_taken_one_by_one_give() {
        let lower = |i: usize, j: usize| if i == j { 1.0 } else { 0.1 * ((3 * i + j) as f64).sin() };
        let root = Matrix::from_fn(|i, j| if i < j { 0.0 } else { lower(i, j) });
        let mut one_by_one = Gaussian { mean: Vector::from_fn(|i, _| (i as f64).cos()), root };
        let (prior, linear) = (Prior::of(&one_by_one), Vector::from_element(0.3));
        let mut equations = NormalEquations::new(&prior, &linear);
        for k in 0..60 {
            let gradient = Vector::<ANY>::from_fn(|i, _| (0.3 + 0.9 * f64::from(k) * (i + 1) as f64).sin());
            let y = (2.0 * f64::from(k)).cos();
            equations.add(y - gradient.dot(&linear), &gradient, 4.0);
            one_by_one.update(y - gradient.dot(&one_by_one.mean), &gradient, 0.25);
        }
        let found = equations.solve().unwrap();
        assert!((linear + found.step - one_by_one.mean).amax() < 1e-12);
        let covariance = |root: &Matrix<ANY>| root * root.transpose();
        assert!((covariance(&found.root) - covariance(&one_by_one.root)).amax() < 1e-12);
    }

    #[test]
    fn what_rounding_leaves_nothing_of_is_no_solution() {
        let nothing = Gaussian { mean: Vector::zeros(), root: Matrix::identity() * f64::INFINITY };
        let equations = NormalEquations::new(&Prior::of(&nothing), &Vector::zeros());
        assert!(equations.solve().is_none());
    }
}

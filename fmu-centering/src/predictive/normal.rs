//! Normal equations of weighted least squares with a prior, in deviations from the point of linearisation.

use nalgebra::SMatrix;
use serde::{Deserialize, Serialize};

use crate::predictive::ring_line::{STATES, Vector};

/// Of all states against all.
pub type Matrix = SMatrix<f64, STATES, STATES>;

/// What is known before the measurements: a mean, and the inverse of its covariance.
#[derive(Clone, Debug, Serialize, Deserialize)]
pub struct Prior {
    /// Most likely state.
    pub mean: Vector,
    /// Inverse of its covariance.
    pub information: Matrix,
}

/// Sums of the normal equations, the lower triangle of what is symmetric.
#[derive(Clone, Debug)]
pub struct NormalEquations {
    information: Matrix,
    product: Vector,
}

/// A solution.
#[derive(Clone, Debug)]
pub struct Solution {
    /// Deviation from the point of linearisation.
    pub step: Vector,
    /// A square root of the covariance.
    pub root: Matrix,
    /// How many measurements the model takes for itself: less than its states, for the prior holds them, too.
    pub free: f64,
}

impl NormalEquations {
    /// The prior alone, at a point of linearisation.
    pub fn new(prior: &Prior, linear: &Vector) -> Self {
        Self { information: prior.information, product: prior.information * (prior.mean - linear) }
    }

    /// Takes a measurement that is `innovation` more than at the point of linearisation; its `weight` is the inverse of its
    /// variance.
    pub fn add(&mut self, innovation: f64, gradient: &Vector, weight: f64) {
        self.product.axpy(weight * innovation, gradient, 1.0);
        let (gradient, sums) = (gradient.as_slice(), self.information.as_mut_slice());
        for (i, column) in sums.chunks_exact_mut(STATES).enumerate() {
            let share = weight * gradient[i];
            for (sum, term) in column[i..].iter_mut().zip(&gradient[i..]) {
                *sum += share * term;
            }
        }
    }

    /// The minimum; none where rounding leaves none.
    pub fn solve(&self, prior: &Prior) -> Option<Solution> {
        // only the lower triangle is read
        let inverse = inverse(&self.information.cholesky()?.l());
        let root = inverse.transpose();
        let step = root * (inverse * self.product);
        let free = STATES as f64 - held(&inverse, &prior.information);
        step.iter().all(|x| x.is_finite()).then_some(Solution { step, root, free })
    }
}

/// Inverse of a lower triangle, column by column and without what is zero.
fn inverse(lower: &Matrix) -> Matrix {
    let mut inverse = Matrix::identity();
    for (j, column) in inverse.as_mut_slice().chunks_exact_mut(STATES).enumerate() {
        for (k, pivots) in lower.as_slice().chunks_exact(STATES).enumerate().skip(j) {
            column[k] /= pivots[k];
            let solved = column[k];
            column[k + 1..].iter_mut().zip(&pivots[k + 1..]).for_each(|(rest, factor)| *rest -= factor * solved);
        }
    }
    inverse
}

/// Trace of a covariance times the information of the prior; the covariance by the inverse of its factor, a lower triangle.
fn held(inverse: &Matrix, information: &Matrix) -> f64 {
    let below = |column: usize, from: usize| &inverse.as_slice()[STATES * column + from..STATES * (column + 1)];
    let covariance = |i: usize, j: usize| below(i, i).iter().zip(below(j, i)).map(|(a, b)| a * b).sum::<f64>();
    let twice = |i: usize| (0..i).map(|j| covariance(i, j) * information[(i, j)]).sum::<f64>();
    (0..STATES).map(|i| covariance(i, i) * information[(i, i)] + 2.0 * twice(i)).sum()
}

#[cfg(test)]
mod tests {
    use super::*;

    fn prior(sigma: f64) -> Prior {
        Prior { mean: Vector::from_element(0.5), information: Matrix::identity() / sigma.powi(2) }
    }

    #[test]
    fn a_state_that_is_measured_once_is_the_mean_by_information() {
        let (prior, linear) = (prior(1.0), Vector::from_element(0.25));
        let mut equations = NormalEquations::new(&prior, &linear);
        let mut gradient = Vector::zeros();
        gradient[7] = 2.0;
        // told 0.5 with variance 1, measured 1 with variance 1/3 of its double
        equations.add(1.5, &gradient, 3.0 / 4.0);
        let found = equations.solve(&prior).unwrap();
        assert!((found.step[7] - (0.25 * 1.0 + 0.75 * 3.0) / 4.0).abs() < 1e-15, "{}", found.step[7]);
        assert!((found.step[6] - 0.25).abs() < 1e-15);
        let covariance = found.root * found.root.transpose();
        assert!((covariance[(7, 7)] - 0.25).abs() < 1e-15 && (covariance[(6, 6)] - 1.0).abs() < 1e-15);
        // three of four parts of what is known of it are the measurement's
        assert!((found.free - 0.75).abs() < 1e-12);
    }

    #[test]
    fn states_that_are_measured_together_are_the_least_squares() {
        let (prior, linear) = (prior(1e6), Vector::zeros());
        let wanted = Vector::from_fn(|i, _| 1.0 + i as f64);
        let mut equations = NormalEquations::new(&prior, &linear);
        for k in 0..3 * STATES {
            let gradient = Vector::from_fn(|i, _| (1.0 + 0.7 * k as f64 * (i + 1) as f64).sin());
            equations.add(gradient.dot(&wanted), &gradient, 1.0);
        }
        let found = equations.solve(&prior).unwrap();
        assert!((found.step - wanted).amax() < 1e-6, "{}", (found.step - wanted).amax());
        assert!((found.free - STATES as f64).abs() < 1e-6);
    }

    #[test]
    fn what_rounding_leaves_nothing_of_is_no_solution() {
        let prior = Prior { mean: Vector::zeros(), information: Matrix::zeros() };
        assert!(NormalEquations::new(&prior, &Vector::zeros()).solve(&prior).is_none());
    }
}

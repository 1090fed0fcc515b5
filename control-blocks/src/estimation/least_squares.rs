//! Weighted non-linear least squares (Levenberg-Marquardt) with the covariance of the estimate.

use nalgebra::{SMatrix, SVector};

/// Maximum number of steps of an estimate.
const STEPS_MAX: usize = 100;
/// An estimate is final when a step is shorter than this fraction of its standard deviations.
const STEP_MIN: f64 = 1e-6;
/// Minimum remaining information of a parameter when the others are free, relative.
const INFORMATION_MIN: f64 = 1e-13;

/// One observation: its residual in standard deviations, and the derivatives of it.
pub struct Observation<const N: usize> {
    /// Model minus measurement, divided by the standard deviation.
    pub residual: f64,
    /// Derivatives of the residual by the parameters.
    pub gradient: SVector<f64, N>,
}

/// An estimate and its covariance.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Estimate<const N: usize> {
    /// Parameters.
    pub value: SVector<f64, N>,
    /// Their covariance; larger than the standard deviations of the observations imply if the residuals are larger.
    pub covariance: SMatrix<f64, N, N>,
}

/// Why there is no estimate.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum NoEstimate {
    /// Fewer observations than parameters and one.
    TooFew,
    /// The observations do not determine the parameters.
    NotObservable,
    /// The steps did not converge.
    NotConverged,
}

/// Sums over all observations at one value of the parameters.
#[derive(Clone, Copy)]
struct Normal<const N: usize> {
    information: SMatrix<f64, N, N>,
    slope: SVector<f64, N>,
    cost: f64,
}

/// Minimizes the sum of the squared residuals from `start` on; `observe(i, value)` is observation `i` of `count`.
///
/// # Errors
/// The reason why there is no estimate.
pub fn least_squares<const N: usize>(
    start: SVector<f64, N>,
    count: usize,
    observe: impl Fn(usize, &SVector<f64, N>) -> Observation<N>,
) -> Result<Estimate<N>, NoEstimate> {
    if count <= N {
        return Err(NoEstimate::TooFew);
    }
    let normal = |value: &SVector<f64, N>| Normal::sum((0..count).map(|i| observe(i, value)));
    let (mut value, mut now, mut damping) = (start, normal(&start), 1e-3);
    for _ in 0..STEPS_MAX {
        let step = now.step(damping).ok_or(NoEstimate::NotObservable)?;
        let next = normal(&(value - step));
        // a step of the size of rounding is an end, too
        let length = (step.dot(&(now.information * step))).sqrt();
        if next.cost <= now.cost {
            (value, now, damping) = (value - step, next, f64::max(damping * 0.1, 1e-12));
        } else {
            damping *= 10.0;
        }
        if length < STEP_MIN {
            return now.conclude(value, count);
        }
    }
    Err(NoEstimate::NotConverged)
}

impl<const N: usize> Normal<N> {
    fn sum(observations: impl Iterator<Item = Observation<N>>) -> Self {
        let zero = Self { information: SMatrix::zeros(), slope: SVector::zeros(), cost: 0.0 };
        observations.fold(zero, |mut sum, Observation { residual, gradient }| {
            sum.information += gradient * gradient.transpose();
            sum.slope += gradient * residual;
            sum.cost += residual * residual;
            sum
        })
    }

    /// Step to subtract, with the diagonal of the information raised by the part `damping`.
    fn step(&self, damping: f64) -> Option<SVector<f64, N>> {
        let mut damped = self.information;
        for i in 0..N {
            damped[(i, i)] *= 1.0 + damping;
        }
        let step = damped.cholesky()?.solve(&self.slope);
        step.iter().all(|s| s.is_finite()).then_some(step)
    }

    fn conclude(&self, value: SVector<f64, N>, count: usize) -> Result<Estimate<N>, NoEstimate> {
        // parameters in units in which each alone has the information 1
        let unit = self.information.diagonal().map(f64::sqrt);
        let scaled = self.information.component_div(&(unit * unit.transpose()));
        let factor = scaled.cholesky().ok_or(NoEstimate::NotObservable)?;
        let inverse = factor.inverse();
        let observable = inverse.diagonal().iter().all(|i| *i < INFORMATION_MIN.recip());
        if !observable || !self.cost.is_finite() {
            return Err(NoEstimate::NotObservable);
        }
        // residuals larger than the standard deviations mean that those were too small
        let excess = f64::max(1.0, self.cost / (count - N) as f64);
        Ok(Estimate { value, covariance: inverse.component_div(&(unit * unit.transpose())) * excess })
    }
}

impl<const N: usize> Estimate<N> {
    /// Standard deviation of parameter `i`.
    pub fn sigma(&self, i: usize) -> f64 {
        self.covariance[(i, i)].sqrt()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// y = a exp(-b t), with the residual in standard deviations of `sigma`.
    fn decay(t: f64, y: f64, sigma: f64, value: &SVector<f64, 2>) -> Observation<2> {
        let shape = (-value[1] * t).exp();
        let gradient = SVector::from([shape, -value[0] * t * shape]) / sigma;
        Observation { residual: (value[0] * shape - y) / sigma, gradient }
    }

    fn line(x: &[f64], y: &[f64], sigma: f64) -> Result<Estimate<2>, NoEstimate> {
        least_squares(SVector::from([0.0, 0.0]), x.len(), |i, value| Observation {
            residual: (value[0] + value[1] * x[i] - y[i]) / sigma,
            gradient: SVector::from([1.0, x[i]]) / sigma,
        })
    }

    #[test]
    fn finds_the_parameters_of_a_decay_without_noise() {
        let y = |t: f64| 3.0 * (-0.7 * t).exp();
        let observe = |i: usize, value: &SVector<f64, 2>| decay(i as f64 * 0.1, y(i as f64 * 0.1), 0.01, value);
        let found = least_squares(SVector::from([1.0, 0.1]), 50, observe).unwrap();
        assert!((found.value - SVector::from([3.0, 0.7])).norm() < 1e-7, "{}", found.value);
    }

    #[test]
    fn a_start_near_the_solution_needs_few_steps_and_one_at_it_one() {
        let y = |t: f64| 3.0 * (-0.7 * t).exp();
        let sums = |start: [f64; 2]| {
            let count = std::cell::Cell::new(0);
            let observe = |i: usize, value: &SVector<f64, 2>| {
                count.set(count.get() + 1);
                decay(i as f64 * 0.1, y(i as f64 * 0.1), 0.01, value)
            };
            least_squares(SVector::from(start), 50, observe).unwrap();
            count.get() / 50
        };
        // the sums at the start, and those of each step
        assert_eq!(sums([3.0, 0.7]), 2);
        assert!(sums([3.1, 0.72]) <= 6 && sums([1.0, 0.1]) <= 10, "{} {}", sums([3.1, 0.72]), sums([1.0, 0.1]));
    }

    #[test]
    fn a_line_has_the_textbook_covariance() {
        let x = [0.0, 1.0, 2.0, 3.0];
        let found = line(&x, &[1.0, 3.0, 5.0, 7.0], 0.2).unwrap();
        assert!((found.value - SVector::from([1.0, 2.0])).norm() < 1e-9);
        // sigma / sqrt(sum (x - mean)^2), and of the offset sigma sqrt(1/n + mean^2 / sum)
        assert!((found.sigma(1) - 0.2 / 5.0f64.sqrt()).abs() < 1e-12);
        assert!((found.sigma(0) - 0.2 * (0.25f64 + 2.25 / 5.0).sqrt()).abs() < 1e-12);
    }

    #[test]
    fn residuals_beyond_their_sigma_widen_the_covariance() {
        let (x, y) = ([0.0, 1.0, 2.0, 3.0], [1.0, -1.0, 1.0, -1.0]);
        let (narrow, wide) = (line(&x, &y, 0.001).unwrap(), line(&x, &y, 10.0).unwrap());
        // sum of squares 3.2 with two parameters: variance 1.6
        assert!((narrow.sigma(1) - (1.6f64 / 5.0).sqrt()).abs() < 1e-9);
        assert!((wide.sigma(1) - 10.0 / 5.0f64.sqrt()).abs() < 1e-9);
    }

    #[test]
    fn what_cannot_be_distinguished_is_rejected() {
        assert_eq!(line(&[0.0, 1.0], &[0.0, 1.0], 0.1), Err(NoEstimate::TooFew));
        assert_eq!(line(&[2.0; 5], &[1.0; 5], 0.1), Err(NoEstimate::NotObservable));
        assert_eq!(line(&[f64::NAN; 5], &[1.0; 5], 0.1), Err(NoEstimate::NotObservable));
    }
}

//! An estimate of a ring with N states, updated by one measurement at a time.

use nalgebra::{Matrix2, SMatrix, Vector2};
use serde::{Deserialize, Serialize};

use crate::predictive::assumptions::Assumptions;
use crate::predictive::ring_line::{Vector, form, line};

/// Relative change of b0 and form by a motion of the ring (derived: a lateral ratio of 0.1 turns it, lobes of 2 um).
const ROTATION: f64 = 1e-4;
/// Relative uncertainty of the radius.
const RADIUS: f64 = 0.02;
/// Largest misfit of a ring that is only rough (default: 2 um with the default noise); beyond it the ring was moved.
pub const MISFIT_MAX: f64 = 10.0;

/// Covariance of all states.
pub type Matrix<const N: usize> = SMatrix<f64, N, N>;

/// Mean of the state and a square root of its covariance, which cannot become indefinite.
#[derive(Clone, Debug, Serialize, Deserialize)]
pub struct Gaussian<const N: usize> {
    /// Most likely state.
    pub mean: Vector<N>,
    /// A square root of its covariance.
    pub root: Matrix<N>,
}

impl<const N: usize> Gaussian<N> {
    /// Variance of the expected measurement with this gradient.
    pub fn spread(&self, gradient: &Vector<N>) -> f64 {
        self.root.tr_mul(gradient).norm_squared()
    }

    /// Adds a measurement that was `innovation` larger than expected (Potter's form of eq. 21 to 23).
    pub fn update(&mut self, innovation: f64, gradient: &Vector<N>, noise: f64) {
        let seen = self.root.tr_mul(gradient);
        let spread = seen.norm_squared() + noise;
        let cross = self.root * seen;
        self.mean += cross * (innovation / spread);
        let factor = 1.0 / (spread + (noise * spread).sqrt());
        self.root.ger(-factor, &cross, &seen, 1.0);
    }
}

/// Estimate of a ring, and the point of linearization.
#[derive(Clone, Debug, Serialize, Deserialize)]
pub struct RingEstimate<const N: usize> {
    /// The prior.
    pub assumed: Assumptions,
    /// Present estimate.
    pub now: Gaussian<N>,
    /// Point of linearization of the geometry.
    pub linear: Vector<N>,
    /// Standard deviation of the measurements from their model, in that of the noise, at least 1.
    pub misfit: f64,
}

/// Interface of an estimate, for any number of states.
pub trait Known {
    /// b0: position of the line of a round and centered ring, m.
    fn mean_line(&self) -> f64;
    /// Center of the ring in the table frame, m.
    fn center(&self) -> Vector2<f64>;
    /// Covariance of the center, m2.
    fn center_covariance(&self) -> Matrix2<f64>;
    /// Value of y = s - q at `angle` (rad) with the center of the ring on the spindle axis, m.
    fn centered_line(&self, angle: f64) -> f64;
    /// Expected value of y = s - q at `angle` (rad), m.
    fn line(&self, angle: f64) -> f64;
    /// Standard deviation of the measurements from the model, in that of the noise, at least 1.
    fn misfit(&self) -> f64;
    /// Whether the center is so near to the point of linearization that the curvature of the circle does not matter.
    fn settled(&self) -> bool;
    /// Adds y = s - q (m) at the spindle angle (rad); false if it was rejected as dirt.
    fn observe(&mut self, angle: f64, y: f64) -> bool;
    /// Linearizes at the present estimate.
    fn linearise(&mut self);
}

impl<const N: usize> RingEstimate<N> {
    /// Of a ring whose center is near `center` (table frame, m), within `sigma` (m) in each coordinate; only the prior
    /// is known otherwise.
    pub fn new(assumed: Assumptions, center: Vector2<f64>, sigma: f64) -> Self {
        let mut mean = Vector::<N>::zeros();
        mean.fixed_rows_mut::<2>(1).copy_from(&center);
        let root = Matrix::from_diagonal(&assumed.sigmas(sigma));
        Self { assumed, now: Gaussian { mean, root }, linear: mean, misfit: 1.0 }
    }

    /// Value of y at `angle` (rad) for a state near the point of linearization, m, and its gradient.
    pub fn expect(&self, angle: f64, state: &Vector<N>) -> (f64, Vector<N>) {
        line(self.assumed.radius, &self.linear, angle, state)
    }

    /// Uses the misfit of a fit of `count` measurements, whose weighted squares are `squares` in those of the noise,
    /// for `free` of them.
    pub fn note_misfit(&mut self, squares: f64, free: f64, count: usize) {
        let misfit = (squares / free).sqrt().clamp(1.0, MISFIT_MAX);
        // a few measurements fit any model
        self.misfit = if count > 2 * N { misfit } else { self.misfit.max(misfit) };
    }

    /// The ring was moved: its center is now near `center` (table frame, m), within `sigma` (m) in each coordinate;
    /// false where rounding has left no covariance.
    ///
    /// b0 and form are less certain at the new position: the ring has turned a little, and the radius is
    /// not known exactly.
    pub fn displaced(&mut self, center: Vector2<f64>, sigma: f64) -> bool {
        let distance = (self.center() - center).norm();
        let uncertainty = ROTATION * distance + RADIUS * distance * distance / (4.0 * self.assumed.radius);
        let mut covariance = self.now.root * self.now.root.transpose() * self.misfit.powi(2);
        for i in 0..N {
            covariance[(i, i)] += uncertainty.powi(2);
        }
        for i in [1, 2] {
            covariance.row_mut(i).fill(0.0);
            covariance.column_mut(i).fill(0.0);
            covariance[(i, i)] = sigma.powi(2);
        }
        self.now.mean.fixed_rows_mut::<2>(1).copy_from(&center);
        self.linear = self.now.mean;
        let root = covariance.cholesky();
        root.is_some_and(|root| {
            self.now.root = root.l();
            true
        })
    }

    /// From the point of linearization to the center, m.
    pub fn step(&self) -> Vector2<f64> {
        Vector2::new(self.now.mean[1] - self.linear[1], self.now.mean[2] - self.linear[2])
    }

    /// Distance of the circle from its tangent, m.
    pub fn bend(&self, step: &Vector2<f64>) -> f64 {
        step.norm_squared() / (2.0 * self.assumed.radius)
    }

    /// Residual of the measurement beyond its gradient: the curvature of the circle over the uncertainty of c_y, m.
    pub fn blur(&self, gradient: &Vector<N>) -> f64 {
        // c_y varies with the derivative of the gradient by the angle
        let side = Vector2::new(gradient[2], -gradient[1]);
        0.5 * side.dot(&(self.center_covariance() * side)) / self.assumed.radius + self.bend(&self.step())
    }
}

impl<const N: usize> Known for RingEstimate<N> {
    fn mean_line(&self) -> f64 {
        self.now.mean[0]
    }

    fn center(&self) -> Vector2<f64> {
        self.now.mean.fixed_rows::<2>(1).into_owned()
    }

    fn center_covariance(&self) -> Matrix2<f64> {
        let rows = self.now.root.fixed_rows::<2>(1);
        rows * rows.transpose() * self.misfit.powi(2)
    }

    fn centered_line(&self, angle: f64) -> f64 {
        self.now.mean[0] - form(&self.now.mean, -angle)
    }

    fn line(&self, angle: f64) -> f64 {
        self.expect(angle, &self.now.mean).0
    }

    fn misfit(&self) -> f64 {
        self.misfit
    }

    fn settled(&self) -> bool {
        self.bend(&self.step()) < self.assumed.noise
    }

    fn observe(&mut self, angle: f64, y: f64) -> bool {
        let (expected, gradient) = self.expect(angle, &self.now.mean);
        let (innovation, noise) = (y - expected, self.assumed.noise.powi(2));
        let spread = self.now.spread(&gradient) + self.misfit.powi(2) * noise + self.blur(&gradient).powi(2);
        let clean = innovation.powi(2) <= self.assumed.gate.powi(2) * spread;
        if clean {
            self.now.update(innovation, &gradient, noise);
        }
        clean
    }

    fn linearise(&mut self) {
        self.linear = self.now.mean;
    }
}

//! Recursive model of the ring: where its centre is, how far the line of measurement, and what form it has.
//!
//! One scalar measurement y = s - q at a time, through the exact geometry (`ring_line`), so that a part of a revolution is
//! enough once b0 and the form are known, and all angles count at once. The covariance says how much is known.
//!
//! The geometry is linearised at the present estimate, which is poor at first. So the measurements since the ring was
//! last moved are kept, and all of them are taken in again at the better estimate now and then (Gauss-Newton).

use arrayvec::ArrayVec;
use nalgebra::{Matrix2, SMatrix, Vector2};
use serde::{Deserialize, Serialize};

use crate::predictive::ring_line::{STATES, Vector, form, line};

/// Standard deviation of b0 before the first measurement, m: anywhere on the slide.
const LINE_SIGMA: f64 = 0.1;
/// Change of b0 and form on the way of the ring, relative (derived: a lateral ratio of 0.1 turns it, lobes of 2 um).
const TURN: f64 = 1e-4;
/// Relative uncertainty of the radius.
const RADIUS: f64 = 0.02;
/// Measurements kept: more than a revolution at 20 rpm and 66 Hz; later ones are taken in only once.
const HISTORY: usize = 256;
/// Largest misfit of a ring that is only rough (our choice: 2 um with the noise of the default); beyond it was moved.
const MISFIT_MAX: f64 = 10.0;
/// Least share of the measurements that a rough ring explains; else some of them belong to another place of the ring.
const EXPLAINED: f64 = 0.9;
/// Passes over the history at a time, at most.
const PASSES: usize = 4;

type Matrix = SMatrix<f64, STATES, STATES>;

/// What is assumed before and between the measurements.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct Assumptions {
    /// Radius of the ring, m.
    pub radius: f64,
    /// Standard deviation of one measurement: probe, roughness, error motion, m.
    pub noise: f64,
    /// Standard deviation of each coordinate of the centre before the first measurement, m.
    pub centre: f64,
    /// Standard deviation of each form coefficient before the first measurement, m.
    pub form: f64,
    /// Innovations beyond this many standard deviations are dirt.
    pub gate: f64,
    /// So many rejected measurements in a row mean that the model is wrong, not the measurements.
    pub rejections_max: u32,
}

/// Mean of the state and a square root of its covariance, which cannot become indefinite.
#[derive(Clone, Debug, Serialize, Deserialize)]
struct Gaussian {
    mean: Vector,
    root: Matrix,
}

impl Gaussian {
    /// Variance of what a measurement with this gradient is expected to be.
    fn spread(&self, gradient: &Vector) -> f64 {
        self.root.tr_mul(gradient).norm_squared()
    }

    /// Takes in a measurement that was `innovation` larger than expected (Potter's form of eq. 21 to 23).
    fn update(&mut self, innovation: f64, gradient: &Vector, noise: f64) {
        let seen = self.root.tr_mul(gradient);
        let spread = seen.norm_squared() + noise;
        let cross = self.root * seen;
        self.mean += cross * (innovation / spread);
        let share = 1.0 / (spread + (noise * spread).sqrt());
        self.root.ger(-share, &cross, &seen, 1.0);
    }
}

/// What is known of the ring.
#[derive(Clone, Debug, Serialize, Deserialize)]
pub struct RingModel {
    assumed: Assumptions,
    now: Gaussian,
    /// where the geometry is linearised
    linear: Vector,
    /// before the measurements of the history
    before: Gaussian,
    /// angles (rad) and measurements (m) since the ring was moved
    history: ArrayVec<(f64, f64), HISTORY>,
    /// standard deviation of the history from its model, in that of the noise, at least 1
    misfit: f64,
    rejections: u32,
}

impl RingModel {
    /// Nothing known but the assumptions.
    pub fn new(assumed: Assumptions) -> Self {
        let mut sigmas = Vector::from_element(assumed.form);
        sigmas[0] = LINE_SIGMA;
        (sigmas[1], sigmas[2]) = (assumed.centre, assumed.centre);
        let now = Gaussian { mean: Vector::zeros(), root: Matrix::from_diagonal(&sigmas) };
        let (linear, before) = (now.mean, now.clone());
        Self { assumed, linear, before, now, history: ArrayVec::new_const(), misfit: 1.0, rejections: 0 }
    }

    /// Takes in y = s - q (m) at the spindle angle (rad); false if it was taken for dirt.
    pub fn observe(&mut self, angle: f64, y: f64) -> bool {
        let (expected, gradient) = self.expect(angle, &self.now.mean);
        let (innovation, noise) = (y - expected, self.assumed.noise.powi(2));
        if !self.history.is_full() {
            self.history.push((angle, y));
        }
        let spread = self.now.spread(&gradient) + self.misfit.powi(2) * noise + self.blur(&gradient).powi(2);
        if innovation.powi(2) > self.assumed.gate.powi(2) * spread {
            self.rejections += 1;
            return false;
        }
        self.rejections = 0;
        self.now.update(innovation, &gradient, noise);
        if self.history.is_full() {
            self.linear = self.now.mean;
        }
        true
    }

    /// Takes in the history again, linearised at what is known by now, then with less weight for what does not fit;
    /// does nothing if later measurements are not kept, or if there are none yet.
    pub fn refine(&mut self) {
        self.fit(1.0);
    }

    /// The same with misfits of `rough` times the noise that are no dirt.
    fn fit(&mut self, rough: f64) {
        if self.history.is_empty() || self.history.is_full() {
            return;
        }
        for pass in 0..PASSES {
            self.linear = self.now.mean;
            let mut refined = self.before.clone();
            let mut squares = 0.0;
            for &(angle, y) in &self.history {
                let misfit =
                    if pass > 0 { (y - self.expect(angle, &self.now.mean).0) / self.assumed.noise } else { 0.0 };
                // cauchy's weight: dirt has hardly any influence
                let weight = 1.0 / (1.0 + (misfit / (self.assumed.gate * rough)).powi(2));
                squares += weight * misfit * misfit;
                let (expected, gradient) = self.expect(angle, &refined.mean);
                refined.update(y - expected, &gradient, self.assumed.noise.powi(2) / weight);
            }
            self.now = refined;
            let misfit = (squares / self.history.len() as f64).sqrt().clamp(1.0, MISFIT_MAX);
            // a few measurements fit any model
            self.misfit = if self.history.len() > 2 * STATES { misfit } else { self.misfit.max(misfit) };
        }
    }

    /// Whether a ring that is rougher than assumed explains what was rejected; it is taken for such a one then.
    pub fn reconsider(&mut self) -> bool {
        self.fit(MISFIT_MAX);
        let (noise, rejected) = (self.misfit * self.assumed.noise, self.rejections as usize);
        let fits =
            |&(angle, y): &(f64, f64)| (y - self.expect(angle, &self.now.mean).0).abs() <= self.assumed.gate * noise;
        let known = self.history.iter().filter(|seen| fits(seen)).count() as f64;
        let explained = !self.history.is_full()
            && known >= EXPLAINED * self.history.len() as f64
            && self.history.iter().rev().take(rejected).all(fits);
        if explained {
            self.rejections = 0;
        }
        explained
    }

    /// Standard deviation of what is measured from the model, in that of the noise, at least 1.
    pub fn misfit(&self) -> f64 {
        self.misfit
    }

    /// Whether the centre is so near to the point of linearisation that the curvature of the circle does not matter.
    pub fn settled(&self) -> bool {
        self.bend(&self.step()) < self.assumed.noise
    }

    fn step(&self) -> Vector2<f64> {
        Vector2::new(self.now.mean[1] - self.linear[1], self.now.mean[2] - self.linear[2])
    }

    /// How far the circle leaves its tangent, m.
    fn bend(&self, step: &Vector2<f64>) -> f64 {
        step.norm_squared() / (2.0 * self.assumed.radius)
    }

    /// The ring was moved: its centre is now near `centre` (table frame, m), within `sigma` (m) in each coordinate.
    ///
    /// What was taken for b0 and form where the ring was is less sure here: it has turned a little, and the radius is
    /// not known exactly.
    pub fn displaced(&mut self, centre: Vector2<f64>, sigma: f64) {
        let way = (self.centre() - centre).norm();
        let doubt = TURN * way + RADIUS * way * way / (4.0 * self.assumed.radius);
        let mut covariance = self.now.root * self.now.root.transpose() * self.misfit.powi(2);
        for i in 0..STATES {
            covariance[(i, i)] += doubt.powi(2);
        }
        for i in [1, 2] {
            covariance.row_mut(i).fill(0.0);
            covariance.column_mut(i).fill(0.0);
            covariance[(i, i)] = sigma.powi(2);
        }
        self.now.mean.fixed_rows_mut::<2>(1).copy_from(&centre);
        if let Some(root) = covariance.cholesky() {
            self.now.root = root.l();
        }
        (self.linear, self.before) = (self.now.mean, self.now.clone());
        self.history.clear();
    }

    /// Whether so many measurements in a row were rejected that the model must be wrong.
    pub fn lost(&self) -> bool {
        self.rejections > self.assumed.rejections_max
    }

    /// b0: where the line of a round and centred ring is, m.
    pub fn mean_line(&self) -> f64 {
        self.now.mean[0]
    }

    /// Centre of the ring in the table frame, m.
    pub fn centre(&self) -> Vector2<f64> {
        self.now.mean.fixed_rows::<2>(1).into_owned()
    }

    /// Covariance of the centre, m2.
    pub fn centre_covariance(&self) -> Matrix2<f64> {
        let rows = self.now.root.fixed_rows::<2>(1);
        rows * rows.transpose() * self.misfit.powi(2)
    }

    /// Eccentricity B, m.
    pub fn eccentricity(&self) -> f64 {
        self.centre().norm()
    }

    /// Standard deviation of the centre in the direction in which it is known least, m.
    pub fn centre_sigma(&self) -> f64 {
        self.centre_covariance().symmetric_eigenvalues().max().max(0.0).sqrt()
    }

    /// What y = s - q would be at `angle` (rad) with the centre of the ring on the axis of the spindle, m.
    pub fn centred_line(&self, angle: f64) -> f64 {
        self.now.mean[0] - form(&self.now.mean, -angle)
    }

    /// What y = s - q is expected to be at `angle` (rad), m.
    pub fn line(&self, angle: f64) -> f64 {
        self.expect(angle, &self.now.mean).0
    }

    /// What y is at `angle` (rad) for a state near the point of linearisation, m, and its gradient.
    fn expect(&self, angle: f64, state: &Vector) -> (f64, Vector) {
        line(self.assumed.radius, &self.linear, angle, state)
    }

    /// What is left of the measurement beyond its gradient: the curvature of the circle over the doubt about c_y, m.
    fn blur(&self, gradient: &Vector) -> f64 {
        // c_y varies with the derivative of the gradient by the angle
        let side = Vector2::new(gradient[2], -gradient[1]);
        0.5 * side.dot(&(self.centre_covariance() * side)) / self.assumed.radius + self.bend(&self.step())
    }
}

#[cfg(test)]
mod tests;

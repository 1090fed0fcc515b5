//! The model of a ring of any form: all orders that a revolution determines, fitted one pass per sample.

use nalgebra::Vector2;
use serde::{Deserialize, Serialize};

use crate::predictive::assumptions::Assumptions;
use crate::predictive::normal::Prior;
use crate::predictive::refit::{Purpose, Refit};
use crate::predictive::ring_estimate::{Gaussian, RingEstimate};
use crate::predictive::ring_line::{ANY, GROUND, Vector};

/// Minimum fraction of free measurements: the prior also constrains the states.
const FREE: f64 = 0.5;

/// Estimate of a ring of any form, and its prior before the stored measurements.
#[derive(Clone, Debug, Serialize, Deserialize)]
pub struct AnyForm {
    /// Present estimate; the prior until the first fit.
    pub estimate: RingEstimate<ANY>,
    before: Prior,
    /// the active fit
    refit: Option<Refit>,
}

impl AnyForm {
    /// Of a ring whose center was near `center` (table frame, m), within `sigma` (m) in each coordinate, before the
    /// measurements that gave a ground ring of the state `ground`; starts its first fit.
    pub fn new(assumed: Assumptions, center: Vector2<f64>, sigma: f64, ground: &Vector<GROUND>) -> Self {
        let mut any = Self::assumed(assumed, center, sigma);
        let mut linear = Vector::<ANY>::zeros();
        linear.fixed_rows_mut::<GROUND>(0).copy_from(ground);
        any.refit = Some(Refit::new(Purpose::Widen, linear));
        any
    }

    /// Only the prior and the approximate center are known.
    fn assumed(assumed: Assumptions, center: Vector2<f64>, sigma: f64) -> Self {
        let estimate = RingEstimate::new(assumed, center, sigma);
        Self { before: Prior::of(&estimate.now), estimate, refit: None }
    }

    /// The active fit.
    pub fn fitting(&self) -> Option<Purpose> {
        self.refit.as_ref().map(|refit| refit.purpose)
    }

    /// Starts to evaluate the stored measurements again, from the present estimate.
    pub fn begin(&mut self, purpose: Purpose) {
        self.refit = Some(Refit::new(purpose, self.estimate.now.mean));
    }

    /// Later measurements are not stored: no fit uses all of them.
    pub fn give_up(&mut self) {
        self.refit = None;
    }

    /// Makes the next pass of the fit over angles (rad) and measurements (m); the estimate changes with the last pass.
    pub fn advance(&mut self, history: &[(f64, f64)]) {
        let Some(mut refit) = self.refit.take() else { return };
        let last = refit.last();
        let Some(found) = refit.pass(&self.estimate.assumed, &self.before, history) else { return };
        let mean = refit.linear + found.solution.step;
        if !last {
            refit.linear = mean;
            self.refit = Some(refit);
            return;
        }
        self.estimate.linear = refit.linear;
        self.estimate.now = Gaussian { mean, root: found.solution.root };
        let count = history.len() as f64;
        self.estimate.note_misfit(found.squares, (count - ANY as f64).max(FREE * count), history.len());
    }

    /// The ring was moved: its center is now near `center` (table frame, m), within `sigma` (m) in each coordinate.
    pub fn displaced(&mut self, center: Vector2<f64>, sigma: f64) {
        if self.estimate.displaced(center, sigma) {
            (self.before, self.refit) = (Prior::of(&self.estimate.now), None);
        } else {
            *self = Self::assumed(self.estimate.assumed, center, sigma);
        }
    }
}

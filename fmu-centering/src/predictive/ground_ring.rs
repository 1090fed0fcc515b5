//! The model of a ground ring, whose form has only low orders: all measurements are evaluated again within a sample.

use nalgebra::Vector2;
use serde::{Deserialize, Serialize};

use crate::predictive::assumptions::Assumptions;
use crate::predictive::ring_estimate::{Gaussian, Known, RingEstimate};
use crate::predictive::ring_line::{GROUND, Tangent};

/// Passes over the stored measurements at a time.
const PASSES: usize = 4;

/// Estimate of a ground ring, and its prior before the stored measurements.
#[derive(Clone, Debug, Serialize, Deserialize)]
pub struct GroundRing {
    /// Present estimate.
    pub estimate: RingEstimate<GROUND>,
    before: Gaussian<GROUND>,
}

impl GroundRing {
    /// Only the prior is known.
    pub fn new(assumed: Assumptions) -> Self {
        let estimate = RingEstimate::new(assumed, Vector2::zeros(), assumed.center);
        Self { before: estimate.now.clone(), estimate }
    }

    /// Evaluates the stored measurements again, linearized at the present estimate, then with less weight for misfits;
    /// misfits of `rough` times the noise are no dirt.
    pub fn fit(&mut self, rough: f64, history: &[(f64, f64)]) {
        let Self { estimate, before } = self;
        let (noise, gate) = (estimate.assumed.noise, estimate.assumed.gate);
        for pass in 0..PASSES {
            estimate.linearise();
            let mut refined = before.clone();
            let mut squares = 0.0;
            for &(angle, y) in history {
                let tangent = Tangent::new(estimate.assumed.radius, &estimate.linear, angle);
                let expected = |state| tangent.at(&estimate.linear, state);
                let misfit = if pass > 0 { (y - expected(&estimate.now.mean)) / noise } else { 0.0 };
                // cauchy's weight: dirt has hardly any influence
                let weight = 1.0 / (1.0 + (misfit / (gate * rough)).powi(2));
                squares += weight * misfit * misfit;
                refined.update(y - expected(&refined.mean), &tangent.gradient, noise.powi(2) / weight);
            }
            estimate.now = refined;
            estimate.note_misfit(squares, history.len() as f64, history.len());
        }
    }

    /// Center before the measurements (table frame, m), and its standard deviation, m.
    pub fn center_and_sigma(&self) -> (Vector2<f64>, f64) {
        (self.before.mean.fixed_rows::<2>(1).into_owned(), self.before.root.row(1).norm())
    }

    /// The ring was moved: its center is now near `center` (table frame, m), within `sigma` (m) in each coordinate.
    pub fn displaced(&mut self, center: Vector2<f64>, sigma: f64) {
        self.estimate.displaced(center, sigma);
        self.before = self.estimate.now.clone();
    }
}

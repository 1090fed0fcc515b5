//! What is assumed of a ring before it is measured.

use serde::{Deserialize, Serialize};

use crate::predictive::normal::{Matrix, Prior};
use crate::predictive::ring_line::{Vector, place};

/// Standard deviation of b0 before the first measurement, m: anywhere on the slide.
const LINE_SIGMA: f64 = 0.1;
/// The first harmonic that a ground ring has less of (our choice).
pub const FINE: usize = 7;
/// The share of the form that it has (our choice).
pub const FINE_SHARE: f64 = 0.025;
/// What is taken for none, m.
pub const ROUND: f64 = 1e-12;

/// What is assumed before and between the measurements.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct Assumptions {
    /// Radius of the ring, m.
    pub radius: f64,
    /// Standard deviation of one measurement before the first: probe, roughness, error motion, m.
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

impl Assumptions {
    /// Standard deviation of each state before the first measurement, m.
    pub fn sigmas(&self) -> Vector {
        let mut sigmas = Vector::from_element(self.form);
        sigmas.rows_range_mut(place(FINE)..).scale_mut(FINE_SHARE);
        sigmas[0] = LINE_SIGMA;
        sigmas.fixed_rows_mut::<2>(1).fill(self.centre);
        sigmas
    }

    /// The same with the inverse of its covariance.
    pub fn prior(&self) -> Prior {
        let least = self.sigmas().map(|sigma| sigma.max(ROUND).powi(-2));
        Prior { mean: Vector::zeros(), information: Matrix::from_diagonal(&least) }
    }
}

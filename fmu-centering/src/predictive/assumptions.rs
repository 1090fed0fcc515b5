//! Prior of a ring before it is measured.

use serde::{Deserialize, Serialize};

use crate::predictive::ring_line::Vector;

/// Standard deviation of b0 before the first measurement, m: anywhere on the slide.
const LINE_SIGMA: f64 = 0.1;

/// Prior before and between the measurements.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct Assumptions {
    /// Radius of the ring, m.
    pub radius: f64,
    /// Standard deviation of one measurement: probe, roughness, error motion, m.
    pub noise: f64,
    /// Standard deviation of each coordinate of the center before the first measurement, m.
    pub center: f64,
    /// Standard deviation of each form coefficient before the first measurement, m.
    pub form: f64,
    /// Innovations beyond this many standard deviations are dirt.
    pub gate: f64,
    /// Number of consecutive rejected measurements after which the model is wrong, not the measurements.
    pub rejections_max: u32,
}

impl Assumptions {
    /// Standard deviation of each state (m) of a ring whose center is known to `center` m.
    pub fn sigmas<const N: usize>(&self, center: f64) -> Vector<N> {
        let mut sigmas = Vector::<N>::from_element(self.form);
        sigmas[0] = LINE_SIGMA;
        (sigmas[1], sigmas[2]) = (center, center);
        sigmas
    }
}

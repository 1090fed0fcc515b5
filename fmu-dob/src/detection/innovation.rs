//! Innovation of the Kalman filter, with its learned noise.

use control_blocks::Welford;
use serde::{Deserialize, Serialize};

use crate::detection::kalman::KalmanFilter;
use crate::interface::Parameters;

/// An innovation is limited to this many standard deviations: one bad sample alone is no contact.
const INNOVATION_MAX: f64 = 4.0;

/// Kalman innovation, normalized by its learned standard deviation.
#[derive(Clone, Debug, Serialize, Deserialize)]
pub struct Innovation {
    filter: KalmanFilter,
    noise: Welford,
    value: f64,
    /// limit of the innovation, m
    maximum: f64,
}

impl Innovation {
    /// Nothing learned so far.
    pub fn new(p: &Parameters) -> Self {
        Self { filter: KalmanFilter::new(p), noise: Welford::default(), value: 0.0, maximum: 0.0 }
    }

    /// Takes a position (m; none if it is lost), the current that acted since the last one (A) and the spindle speed
    /// (rad/s).
    pub fn update(&mut self, position: Option<f64>, acted: f64, spindle_speed: f64) {
        self.value = self.filter.update(position, acted, spindle_speed);
    }

    /// The limited innovation (m).
    pub fn limited(&self) -> f64 {
        self.value.clamp(-self.maximum, self.maximum)
    }

    /// Starts again at rest at `position` m, with nothing learned.
    pub fn reset(&mut self, position: f64) {
        self.filter.reset(position);
        (self.noise, self.maximum) = (Welford::default(), 0.0);
    }

    /// Learns from the newest innovation.
    pub fn learn(&mut self) {
        self.noise.push(self.value);
        self.maximum = INNOVATION_MAX * self.noise.sigma();
    }

    /// Learned standard deviation, m.
    pub fn sigma(&self) -> f64 {
        self.noise.sigma()
    }

    /// The filter itself.
    pub fn filter(&self) -> &KalmanFilter {
        &self.filter
    }
}

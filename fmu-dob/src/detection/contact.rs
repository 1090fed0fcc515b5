//! Contact position: the encoder at the detection (paper), and its correction by the calibrated bias.

use serde::{Deserialize, Serialize};

use crate::interface::ContactSource;

/// A detected contact.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct DetectedContact {
    /// Detector or force guard that detected the contact.
    pub source: ContactSource,
    /// Encoder position at the detection, m, towards the workpiece.
    pub position: f64,
    /// Travel from the first touch to the detection, m, as calibrated; late but repeatable.
    pub bias: f64,
    /// Standard deviation of the estimated first touch, m; 0 without calibration.
    pub deviation: f64,
    /// Time of the detection since initialization, s.
    pub time: f64,
}

impl DetectedContact {
    /// Position of the first touch, m, towards the workpiece.
    pub fn estimate(&self) -> f64 {
        self.position - self.bias
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_first_touch_was_the_bias_before() {
        let contact =
            DetectedContact { source: ContactSource::Slope, position: 5e-6, bias: 3e-7, deviation: 0.0, time: 1.0 };
        assert!((contact.estimate() - 4.7e-6).abs() < 1e-18);
    }
}

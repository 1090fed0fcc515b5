//! Contact position: the encoder at the detection (paper), and what a calibration touch makes of it.

use serde::{Deserialize, Serialize};

use crate::interface::ContactSource;

/// A detected contact.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct DetectedContact {
    /// What detected it.
    pub source: ContactSource,
    /// Encoder position at the detection, m, towards the workpiece.
    pub position: f64,
    /// Travel from the first touch to the detection, m, as calibrated; late but repeatable.
    pub bias: f64,
    /// Time of the detection since the initialisation, s.
    pub time: f64,
}

impl DetectedContact {
    /// Position of the first touch, m, towards the workpiece.
    pub fn estimate(&self) -> f64 {
        self.position - self.bias
    }
}

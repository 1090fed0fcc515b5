//! Contact position: the encoder at the detection (paper), and what a calibration touch makes of it.

use serde::{Deserialize, Serialize};

use crate::machine::ContactSource;

/// A detected contact.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct Touch {
    /// What detected it.
    pub source: ContactSource,
    /// Encoder position at the detection, m, towards the workpiece.
    pub position: f64,
    /// Travel from the first touch to the detection, m, as calibrated; late but repeatable.
    pub bias: f64,
    /// Time of the detection, s.
    pub time: f64,
}

impl Touch {
    /// Position of the first touch, m, towards the workpiece.
    pub fn estimate(&self) -> f64 {
        self.position - self.bias
    }
}

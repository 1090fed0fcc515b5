//! Values for the fault messages.

use serde::{Deserialize, Serialize};

/// Values of the monitors in a sample, from which the message of a fault is written.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct Numbers {
    /// Ratio of the samples of 0.1 s with the torque at its limit.
    pub saturated: f64,
    /// Consecutive revolutions with a rising error.
    pub revolutions: u32,
    /// Error of a revolution at the start of the rise, root mean square, m.
    pub begin: f64,
    /// Acceleration of the arm over that of the torque, as evaluated for a fault of the drive.
    pub drive_ratio: f64,
    /// Time of a task that takes too long, and its limit, s.
    pub late: Option<[f64; 2]>,
    /// Travel of the slide in a revolution without its feed, m.
    pub fed: Option<f64>,
    /// Slide positions between which the path has a table, m.
    pub table: [f64; 2],
}

impl Numbers {
    /// Before the first sample.
    pub const START: Self =
        Self { saturated: 0.0, revolutions: 0, begin: 0.0, drive_ratio: 1.0, late: None, fed: None, table: [0.0; 2] };
}

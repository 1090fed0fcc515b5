//! Numbers that are told with a fault.

use serde::{Deserialize, Serialize};

/// What the monitors know of a sample, for the log.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct Numbers {
    /// Share of the samples of 0.1 s with the torque at its limit.
    pub saturated: f64,
    /// Turns in a row in which the error has risen.
    pub turns: u32,
    /// Error over a turn where it began to rise, root mean square, m.
    pub begin: f64,
    /// Acceleration of the arm over that of the torque, as a fault of the drive is judged by it.
    pub share: f64,
    /// Time of a job that takes too long, and its limit, s.
    pub late: Option<[f64; 2]>,
    /// Way of the slide in a turn in which it did not go on with its feed, m.
    pub fed: Option<f64>,
    /// Slide positions between which the path has a table, m.
    pub table: [f64; 2],
}

impl Numbers {
    /// Before the first sample.
    pub const START: Self =
        Self { saturated: 0.0, turns: 0, begin: 0.0, share: 1.0, late: None, fed: None, table: [0.0; 2] };
}

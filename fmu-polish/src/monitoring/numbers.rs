//! Numbers that are told with a fault.

use serde::{Deserialize, Serialize};

/// What the monitors know of a sample, for the log.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct Numbers {
    /// Share of the told motion that the axis with a fault does, where there is one.
    pub share: Option<f64>,
    /// Time of the job, s.
    pub time: f64,
    /// Longest time of the job, s.
    pub time_limit: f64,
}

impl Numbers {
    /// Before the first job.
    pub const START: Self = Self { share: None, time: 0.0, time_limit: 0.0 };
}

//! Details of a fault.

use serde::{Deserialize, Serialize};

/// Details of a fault, for its message.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct Numbers {
    /// Number of the axis, from 1; 0 if the fault is not of one axis.
    pub axis: i32,
    /// The value found, in the unit of its limit.
    pub value: f64,
    /// The limit that it exceeds.
    pub limit: f64,
    /// Ratio of the measured to the commanded motion, where something was commanded.
    pub ratio: Option<f64>,
}

impl Numbers {
    /// No fault.
    pub const START: Self = Self { axis: 0, value: 0.0, limit: 0.0, ratio: None };
}

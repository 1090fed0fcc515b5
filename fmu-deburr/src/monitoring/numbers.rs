//! Numbers that are told with a fault.

use serde::{Deserialize, Serialize};

/// Numbers behind a fault, for the log.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct Numbers {
    /// Number of the axis, from 1; 0 where it is none.
    pub axis: i32,
    /// What was found, in the unit of its limit.
    pub value: f64,
    /// Where the fault begins.
    pub limit: f64,
    /// Share of the commanded motion that was measured, where something was commanded.
    pub share: Option<f64>,
}

impl Numbers {
    /// Nothing was found.
    pub const START: Self = Self { axis: 0, value: 0.0, limit: 0.0, share: None };
}

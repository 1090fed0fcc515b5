//! What was found wrong, with its numbers.

use serde::{Deserialize, Serialize};

use crate::interface::Fault;

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

/// A fault and its numbers.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct Finding {
    /// What is wrong.
    pub fault: Fault,
    /// By how much.
    pub numbers: Numbers,
}

impl Finding {
    /// Nothing is wrong.
    pub const NONE: Self = Self::plain(Fault::None);

    /// A fault that needs no numbers.
    pub const fn plain(fault: Fault) -> Self {
        Self { fault, numbers: Numbers::START }
    }

    /// A value beyond its limit.
    pub const fn beyond(fault: Fault, value: f64, limit: f64) -> Self {
        Self { fault, numbers: Numbers { value, limit, ..Numbers::START } }
    }

    /// Whether something is wrong.
    pub fn is_fault(&self) -> bool {
        self.fault != Fault::None
    }
}

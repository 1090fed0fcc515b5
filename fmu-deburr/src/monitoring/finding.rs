//! A fault that was found, with its numbers.

use serde::{Deserialize, Serialize};

use crate::interface::Fault;
pub use crate::monitoring::numbers::Numbers;

/// A fault and its numbers.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct Finding {
    /// Fault that was found.
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

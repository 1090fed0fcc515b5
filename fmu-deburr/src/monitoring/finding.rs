//! Result of a monitor: a fault with its numbers, or none.

use serde::{Deserialize, Serialize};

use crate::interface::Fault;
pub use crate::monitoring::numbers::Numbers;

/// A fault with the numbers of its message; [`Self::NONE`] without a fault.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct Finding {
    /// Detected fault, or `Fault::None`.
    pub fault: Fault,
    /// Axis, value, limit and ratio for the message.
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

//! Values that are logged with a fault.

use serde::{Deserialize, Serialize};

/// Values of the monitors in a sample, for the log.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct Numbers {
    /// Largest following error, m.
    pub following_limit: f64,
    /// Ratio of forward rotation to all rotation in the present state.
    pub forward: f64,
    /// Revolutions without a result and their limit, where that is the fault.
    pub endless: Option<[f64; 2]>,
    /// Motion of the line of a centered ring and its limit (m), where that is the fault.
    pub line: Option<[f64; 2]>,
    /// Eccentricity of the first model, m.
    pub first: f64,
    /// Delay of the probe relative to the slide, s; negative if the slide is delayed.
    pub probe_delay: f64,
    /// Probe position at an early contact of the pusher, m.
    pub met: f64,
}

impl Numbers {
    /// Before the first cycle.
    pub const START: Self =
        Self { following_limit: 0.0, forward: 1.0, endless: None, line: None, first: 0.0, probe_delay: 0.0, met: 0.0 };
}

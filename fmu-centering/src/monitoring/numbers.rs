//! Numbers that are told with a fault.

use serde::{Deserialize, Serialize};

/// What the monitors know of a sample, for the log.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct Numbers {
    /// Largest following error, m.
    pub following_limit: f64,
    /// Share of its turning that the spindle has gone forward in the present state.
    pub forward: f64,
    /// Revolutions without result and how many there may be, where that is the fault.
    pub endless: Option<[f64; 2]>,
    /// Way of the line of a centered ring and its limit (m), where that is the fault.
    pub line: Option<[f64; 2]>,
    /// Eccentricity of the first model, m.
    pub first: f64,
    /// Time by which the probe is later than the slide, s; negative if it is the slide.
    pub probe_delay: f64,
    /// Where the probe was when the pusher met the ring too early, m.
    pub met: f64,
}

impl Numbers {
    /// Before the first centering.
    pub const START: Self =
        Self { following_limit: 0.0, forward: 1.0, endless: None, line: None, first: 0.0, probe_delay: 0.0, met: 0.0 };
}

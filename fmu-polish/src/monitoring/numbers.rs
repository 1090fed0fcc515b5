//! Numbers for the log message of a fault.

use serde::{Deserialize, Serialize};

/// Values of the monitors in one sample.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct Numbers {
    /// Measured over commanded motion of the axis with a fault, where there is one.
    pub ratio: Option<f64>,
    /// Time of the cycle, s.
    pub time: f64,
    /// Maximum time of the cycle, s.
    pub time_limit: f64,
    /// Norm of the force, N.
    pub norm: f64,
    /// Norm of the zero of the sensor, N.
    pub zero: f64,
    /// Angle between the mean force and the normal, rad.
    pub angle: f64,
    /// Distance of the surface from the path along the normal, m.
    pub surface: f64,
    /// Standard deviation of the noise of the force, N.
    pub noise: f64,
    /// Force error, root mean square over 0.2 s, and its limit, N.
    pub force_error: [f64; 2],
}

impl Numbers {
    /// Before the first cycle.
    pub const START: Self = Self {
        ratio: None,
        time: 0.0,
        time_limit: 0.0,
        norm: 0.0,
        zero: 0.0,
        angle: 0.0,
        surface: 0.0,
        noise: 0.0,
        force_error: [0.0; 2],
    };
}

//! Parameters of the machine: tool, drives, sensor.

use serde::{Deserialize, Serialize};

/// Polishing tool: a stick with a ball end.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Tool {
    /// Radius of the ball end, m; 5e-5 to 0.02, default 0.5 mm (paper: tip diameter 1 mm).
    pub radius: f64,
}

impl Tool {
    /// Documented defaults.
    pub const DEFAULT: Self = Self { radius: 0.5e-3 };
}

/// Linear model of an axis from its pulses to its position: position loop, velocity feedforward, velocity loop.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Drive {
    /// Gain of the position loop, 1/s; 1 to 1e4, default 80 (our choice: usual AC servo).
    pub position_gain: f64,
    /// Part of the velocity that is fed forward, 1; 0 to 1, default 0.8 (our choice).
    pub feedforward: f64,
    /// Bandwidth of the velocity feedforward, rad/s; 1 to 1e5, default 628 (our choice).
    pub feedforward_bandwidth: f64,
    /// Bandwidth of the velocity loop, rad/s; 10 to 1e5, default 500 (our choice).
    pub velocity_bandwidth: f64,
    /// Integral action of the velocity loop, 1/s; 0 to 1e4, default 60 (our choice).
    pub velocity_integral: f64,
    /// Samples between a command and its action; 0 to 8, default 1 (a standard FMI master).
    pub io_delay: i32,
}

impl Drive {
    /// Documented defaults.
    pub const DEFAULT: Self = Self {
        position_gain: 80.0,
        feedforward: 0.8,
        feedforward_bandwidth: 628.3,
        velocity_bandwidth: 500.0,
        velocity_integral: 60.0,
        io_delay: 1,
    };
}

/// Model of the force sensor.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Sensor {
    /// Bandwidth of its filter, rad/s; 10 to 1e6, default 1257 = 200 Hz (our choice).
    pub bandwidth: f64,
}

impl Sensor {
    /// Documented defaults.
    pub const DEFAULT: Self = Self { bandwidth: 1256.6 };
}

/// Pulses of the drives.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Pulses {
    /// Way of one pulse, m; 1e-9 to 1e-4, default 1 um (paper).
    pub size: f64,
}

impl Pulses {
    /// Documented defaults.
    pub const DEFAULT: Self = Self { size: 1e-6 };
}

//! Parameters of the cutting.

use serde::{Deserialize, Serialize};

/// rad/s of one turn per minute.
const RPM: f64 = std::f64::consts::TAU / 60.0;

/// Cutting-load control, eq. 5.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Load {
    /// Regulate the feed; false keeps the taught speed; default true.
    pub enable: bool,
    /// Target tool speed `N_nom`, rad/s; 10 to 1e5, default 1811.7 = 17,300 rpm (paper).
    pub spindle_speed: f64,
    /// Gain K1, m/s per sample; 0 to 10, default 0.092 (derived: calm, and no stall up to 1.8 times the cutting force).
    pub k1: f64,
    /// Gain K2, m; -1 to 1, default 0.0138 (derived: K2 = tau K1 cancels the pole of the tool, tau = 0.15 s); negative is
    /// the sign as printed, which destabilises.
    pub k2: f64,
    /// Slowest feed, m/s; 0 to 1, default 0.004 (our choice).
    pub speed_min: f64,
    /// Time at the slowest feed that is an overload, s; 0 to 60, default 0.2 (our choice).
    pub overload_time: f64,
}

impl Load {
    /// Documented defaults.
    pub const DEFAULT: Self = Self {
        enable: true,
        spindle_speed: 17_300.0 * RPM,
        k1: 0.092,
        k2: 0.0138,
        speed_min: 0.004,
        overload_time: 0.2,
    };
}

/// Spindle of the tool.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Spindle {
    /// Tool speed below which deburring is a fault, rad/s; 0 to 1e5, default 1047 = 10,000 rpm (our choice: beyond the
    /// breakdown torque of the motor).
    pub speed_min: f64,
}

impl Spindle {
    /// Documented defaults.
    pub const DEFAULT: Self = Self { speed_min: 10_000.0 * RPM };
}

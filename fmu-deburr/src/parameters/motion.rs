//! Parameters of the axes, the position loop and the feed.

use serde::{Deserialize, Serialize};

use crate::kinematics::AXES;

/// One axis; its unit is rad (axes 1, 4, 5, 6) or m (axes 2, 3).
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Axis {
    /// Encoder pulse, rad or m; 1e-9 to 1e-2; defaults 2 pi/640000 rad, 2.5 um, 5 um, 2 pi/400000 rad (our choice: 5 um on
    /// axis 3 gives the 4 pulses of the paper's Fig. 2).
    pub pulse: f64,
    /// Largest velocity that is commanded, per second; 1e-3 to 100; defaults 3 rad/s, 1 m/s, 1.5 m/s, 6 rad/s (our choice).
    pub velocity_max: f64,
    /// Lower end of the travel, -100 to 100; defaults -3.2 rad, -1 m, 0.1 m, -6.3 rad (our choice).
    pub minimum: f64,
    /// Upper end of the travel, -100 to 100; defaults 3.2 rad, 1 m, 2 m, 6.3 rad (our choice).
    pub maximum: f64,
    /// Control error that is a fault, 1e-6 to 10; defaults 0.2 rad, 0.1 m, 0.1 m, 0.5 rad (our choice: twice the error that
    /// the servo has without compensation at 0.5 m/s).
    pub error_max: f64,
}

impl Axis {
    /// Defaults of axis 1.
    pub const COLUMN: Self = Self {
        pulse: std::f64::consts::TAU / 640_000.0,
        velocity_max: 3.0,
        minimum: -3.2,
        maximum: 3.2,
        error_max: 0.2,
    };
    /// Defaults of axis 2.
    pub const HEIGHT: Self = Self { pulse: 2.5e-6, velocity_max: 1.0, minimum: -1.0, maximum: 1.0, error_max: 0.1 };
    /// Defaults of axis 3.
    pub const ARM: Self = Self { pulse: 5e-6, velocity_max: 1.5, minimum: 0.1, maximum: 2.0, error_max: 0.1 };
    /// Defaults of the axes 4 to 6.
    pub const WRIST: Self = Self {
        pulse: std::f64::consts::TAU / 400_000.0,
        velocity_max: 6.0,
        minimum: -6.3,
        maximum: 6.3,
        error_max: 0.5,
    };
}

/// Position loop.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Servo {
    /// Gain Kp of each axis, 1/s; 0.1 to 100, default 13 (paper: axes 1 and 3; the others our choice).
    pub gain: [f64; AXES],
    /// Samples between a command and its action; 0 to 6, default 1 (our choice: what a standard master does).
    pub io_delay: i32,
}

impl Servo {
    /// Documented defaults.
    pub const DEFAULT: Self = Self { gain: [13.0; AXES], io_delay: 1 };
}

/// Motion to the start of the path, and the rest there.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Transfer {
    /// Shortest time of the motion, s; 0.1 to 60, default 1.5 (derived: no count of error is left after the rest).
    pub time: f64,
    /// Rest before a run, s; 0 to 60, default 0.8 (derived: ten time constants 1/Kp).
    pub settle_time: f64,
    /// Part of `axisN.velocity_max` that the motion may use, 1; 0.01 to 1, default 0.3 (our choice).
    pub velocity_share: f64,
}

impl Transfer {
    /// Documented defaults.
    pub const DEFAULT: Self = Self { time: 1.5, settle_time: 0.8, velocity_share: 0.3 };
}

/// The taught path.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Path {
    /// Taught speed, m/s; 0 (that of the file) to 2, default 0.
    pub taught_speed: f64,
    /// Turn of the tangent at which the feed stops, rad; 0.001 to 3.2, default 0.2 (our choice).
    pub corner: f64,
}

impl Path {
    /// Documented defaults.
    pub const DEFAULT: Self = Self { taught_speed: 0.0, corner: 0.2 };
}

/// Feed along the path.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Feed {
    /// Acceleration and deceleration, m/s2; 0.01 to 50, default 0.5 (our choice).
    pub acceleration: f64,
    /// Samples of the moving average over the speed, 1 for none; 1 to 32, default 1 (our choice).
    pub smoothing: i32,
}

impl Feed {
    /// Documented defaults.
    pub const DEFAULT: Self = Self { acceleration: 0.5, smoothing: 1 };
}

//! Parameters of identification and calibration.

use serde::{Deserialize, Serialize};

use crate::frequencies::Frequencies;

/// Measurement of the frequency response in place.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Identify {
    /// Frequencies, each 0.1 Hz to 10 kHz; default 32 from 10 Hz to 1 kHz (our choice: dense where the harmonics are).
    pub frequencies: Frequencies,
    /// Amplitude of the tool, m; 1e-6 to 0.05, default 1.75 mm (derived: the paper's 0x4 at a radius of 30 mm).
    pub amplitude: f64,
    /// Part of the largest torque that the swing may need, 1; 0.01 to 0.9, default 0.5 (our choice).
    pub torque_share: f64,
    /// Largest acceleration of the tool, m/s2; 0.1 to 1e5, default 500 (paper).
    pub acceleration_max: f64,
    /// Time from one frequency to the next, s; 1e-3 to 10, default 0.05 (our choice).
    pub glide_time: f64,
    /// Time at a frequency before it is measured, s; 0 to 10, default 0.1 (our choice: five times the slowest pole).
    pub settle_time: f64,
    /// Least time that is averaged, whole periods, s; 1e-3 to 100, default 0.2 (our choice).
    pub average_time: f64,
}

impl Identify {
    /// Documented defaults.
    pub const DEFAULT: Self = Self {
        frequencies: Frequencies::DEFAULT,
        amplitude: 1.75e-3,
        torque_share: 0.5,
        acceleration_max: 500.0,
        glide_time: 0.05,
        settle_time: 0.1,
        average_time: 0.2,
    };
}

/// Depth probe on the slide.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Probe {
    /// Radius R_p of its ball, m; 0 to 0.02, default 1.5 mm (our choice).
    pub radius: f64,
    /// Standard deviation of the radius, m; 0 to 1e-3, default 0.1 um (our choice).
    pub radius_sigma: f64,
    /// Standard deviation of a depth reading on a cut surface, m; 1e-9 to 1e-3, default 65 nm (derived: step 0.1 um of the
    /// paper, 50 nm of noise, 30 nm of roughness).
    pub depth_sigma: f64,
    /// Standard deviation of the lateral position, m; 1e-9 to 1e-3, default 30 nm (derived: step 0.1 um).
    pub lateral_sigma: f64,
    /// Standard deviation of its zero on the spindle axis, m; 1e-9 to 0.1, default 0.1 mm (our choice: set by eye).
    pub cusp_sigma: f64,
    /// Way between two samples of one capture, m; 1e-6 to 0.1, default 0.1 mm (our choice).
    pub pitch: f64,
}

impl Probe {
    /// Documented defaults.
    pub const DEFAULT: Self = Self {
        radius: 1.5e-3,
        radius_sigma: 1e-7,
        depth_sigma: 65e-9,
        lateral_sigma: 30e-9,
        cusp_sigma: 1e-4,
        pitch: 1e-4,
    };
}

/// Calibration.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Calibration {
    /// Standard deviation of the arm angle of a flat, rad; 1e-9 to 1e-2, default 0.25 urad (derived: encoder step).
    pub arm_angle_sigma: f64,
    /// Speed of the arm while a calibration part is cut, rad/s; 1e-4 to 1, default 0.03 (our choice: 50 um a turn at
    /// 3000 rpm).
    pub sweep_speed: f64,
}

impl Calibration {
    /// Documented defaults.
    pub const DEFAULT: Self = Self { arm_angle_sigma: 0.25e-6, sweep_speed: 0.03 };
}

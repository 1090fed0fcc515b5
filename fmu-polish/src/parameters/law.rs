//! Parameters of the control law.

use serde::{Deserialize, Serialize};

use crate::axes::Axes;
use crate::force::ForceMode;
use crate::stick_slip::{Mode, Wave};

/// Polishing force.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Force {
    /// Desired polishing force F_d, N; 0.1 to 100, default 5 (our choice: 28 steps of the sensor). Tunable.
    pub target: f64,
    /// What of the measured force is controlled; default `Projected` (our choice), `Norm` is eq. 5.
    pub mode: ForceMode,
    /// Low-pass of the measured force, rad/s; 0 to 1e5, 0 for none, default 0.
    pub filter_bandwidth: f64,
    /// Time T_i of the force integral, s; 0 to 100, 0 for none, default 0.15 (measured). Tunable.
    pub integral_time: f64,
}

impl Force {
    /// Documented defaults.
    pub const DEFAULT: Self =
        Self { target: 5.0, mode: ForceMode::Projected, filter_bandwidth: 0.0, integral_time: 0.15 };
}

/// Impedance model M_d dv/dt + B_d v = - K_f E_f of eq. 4.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Impedance {
    /// Desired mass M_d, kg; 0.01 to 1e4, default 10 (our choice).
    pub mass: f64,
    /// Desired damping B_d, N s/m; 10 to 1e7, default 10e3 (derived: loop gain 17.7 1/s at 178 N/mm). Tunable.
    pub damping: f64,
    /// Gain K_f, 1; 0 to 100, default 1. Tunable.
    pub gain: f64,
    /// After settling take the damping that the estimated stiffness needs for `bandwidth`; default true (our choice).
    pub adaptive: bool,
    /// Wanted loop gain g = K_f k / B_d, 1/s; 1 to 100, default 35 (measured: 80 swings).
    pub bandwidth: f64,
}

impl Impedance {
    /// Documented defaults.
    pub const DEFAULT: Self = Self { mass: 10.0, damping: 10e3, gain: 1.0, adaptive: true, bandwidth: 35.0 };
}

/// Stiffness of tool and contact along the normal.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Stiffness {
    /// Value before it is estimated, N/m; 1e3 to 1e8, default 178e3 (paper).
    pub nominal: f64,
}

impl Stiffness {
    /// Documented defaults.
    pub const DEFAULT: Self = Self { nominal: 178e3 };
}

/// Position feedback, eq. 6.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Position {
    /// Gain K_p, 1/s; 0 to 200, default 5 (our choice). Tunable.
    pub gain: Axes,
    /// Integral gain K_i, 1/s2, the paper's divided by the sample period; 0 to 1e4, default 0. Tunable.
    pub integral: Axes,
    /// Limit of the integral of the error, m s; 0 to 1, default 0.2e-3 (our choice).
    pub integral_max: f64,
    /// Switch matrix S_p; default all (our choice), the paper's is z alone.
    pub select: Axes<bool>,
    /// Take the part along the normal out, so that force and position do not fight; default true (our choice).
    pub projected: bool,
}

impl Position {
    /// Documented defaults.
    pub const DEFAULT: Self = Self {
        gain: Axes::all(5.0),
        integral: Axes::ZERO,
        integral_max: 0.2e-3,
        select: Axes::all(true),
        projected: true,
    };
}

/// Stick-slip motion, eqs. 7 to 17.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct StickSlip {
    /// Where the vector points; default `Cross` (our choice), `Paper` is eqs. 12 to 15.
    pub mode: Mode,
    /// Velocity K_v, m/s; 0 to 0.1, default 10e-3 (measured). Tunable.
    pub velocity: f64,
    /// Samples of one sign; 1 to 1000, default 10 (measured), the paper's 1 does nothing.
    pub half_period: i32,
    /// Wave form; default `Square` (paper).
    pub wave: Wave,
    /// K_v over the feed, 1; 0 to 100, 0 for `velocity`, default 0; keeps the removal per length. Tunable.
    pub ratio: f64,
}

impl StickSlip {
    /// Documented defaults.
    pub const DEFAULT: Self =
        Self { mode: Mode::Cross, velocity: 10e-3, half_period: 10, wave: Wave::Square, ratio: 0.0 };
}

/// Cancellation of the force ripple at the frequency of the stick-slip and twice that.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Ripple {
    /// Rate at which a ripple is learned, 1/s; 0 to 20, 0 for none, default 3 (measured: 8 is unsafe with other drives).
    pub gain: f64,
    /// Growth of a ripple that ends the cancellation, N; 0.01 to 10, default 0.3 (our choice).
    pub growth_max: f64,
}

impl Ripple {
    /// Documented defaults.
    pub const DEFAULT: Self = Self { gain: 3.0, growth_max: 0.3 };
}

/// Estimate of a rigid misalignment of the mold and its feedforward.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Misalignment {
    /// Estimate it and feed it forward; default true (our choice).
    pub enable: bool,
    /// Forgetting factor of the least squares, 1; 0.99 to 1, default 0.99995 = 20 s (measured: shorter memories are noisy).
    pub forgetting: f64,
    /// Time by which the feedforward is ahead, s; 0 to 0.1, default 6 ms (our choice: delay of drive and loop).
    pub lead_time: f64,
    /// Path before the feedforward begins, m; 0 to 1, default 1 mm (our choice).
    pub distance_min: f64,
}

impl Misalignment {
    /// Documented defaults.
    pub const DEFAULT: Self = Self { enable: true, forgetting: 0.99995, lead_time: 6e-3, distance_min: 1e-3 };
}

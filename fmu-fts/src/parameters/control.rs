//! Parameters of the control: position loop, flexure, feedforward, cancellation, motions, limits.

use serde::{Deserialize, Serialize};

use crate::harmonics::Harmonics;

/// Nominal arm and drive, and the lead-lag position loop designed for them.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Servo {
    /// Wanted -3 dB bandwidth of the closed loop, rad/s; 62.8 to 3142, default 1445 = 230 Hz (paper).
    pub bandwidth: f64,
    /// Lead: crossover over zero, and pole over crossover, 1; 1.5 to 10, default 4 (our choice: 44 degrees left).
    pub lead: f64,
    /// Lag: crossover over the zero of the integrator, 1; 3 to 1000, default 10 (our choice).
    pub lag: f64,
    /// Roll-off, rad/s; 1000 to 31400, default 15708 = 2.5 kHz (our choice).
    pub roll_off: f64,
    /// Inertia J of the whole moving arm, kg.m2; 1e-7 to 10, default 8e-4 (our choice: 500 m/s2 needs 5 N.m).
    pub inertia: f64,
    /// Viscous friction, N.m.s/rad; 0 to 10, default 2e-3 (our choice).
    pub viscous_friction: f64,
    /// Dry friction that is fed forward, N.m; 0 to 10, default 0 = off (our choice: it must be measured first).
    pub dry_friction: f64,
    /// Largest torque, N.m; 1e-3 to 1e4, default 7 (our choice).
    pub torque_max: f64,
    /// Bandwidth of the current loop, rad/s; 600 to 1e6, default 12566 = 2 kHz (our choice).
    pub current_bandwidth: f64,
    /// Samples between a command and its action; 0 to 8, default 1 (our choice: what a standard master does).
    pub io_delay: i32,
}

impl Servo {
    /// Documented defaults.
    pub const DEFAULT: Self = Self {
        bandwidth: std::f64::consts::TAU * 230.0,
        lead: 4.0,
        lag: 10.0,
        roll_off: std::f64::consts::TAU * 2500.0,
        inertia: 8e-4,
        viscous_friction: 2e-3,
        dry_friction: 0.0,
        torque_max: 7.0,
        current_bandwidth: std::f64::consts::TAU * 2000.0,
        io_delay: 1,
    };
}

/// Flexure of the arm between encoder and tool.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Tip {
    /// Natural frequency of the arm on the locked hub, rad/s; 0 (rigid) to 1e5, default 7540 = 1.2 kHz (our choice).
    pub frequency: f64,
    /// Part of the inertia that is beyond the flexure, 1; 0 to 0.95, default 0.4375 (our choice).
    pub inertia: f64,
    /// Damping ratio of the arm on the locked hub, 1; 0 to 0.5, default 0.02 (our choice: metal).
    pub damping: f64,
    /// Move the hub so that the tool, not the hub, is on the path; default true (our choice).
    pub compensation: bool,
}

impl Tip {
    /// Documented defaults.
    pub const DEFAULT: Self =
        Self { frequency: std::f64::consts::TAU * 1200.0, inertia: 0.4375, damping: 0.02, compensation: true };
}

/// Feedforward that pre-shifts the path.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Feedforward {
    /// Harmonics that are pre-shifted, 0 for none, else at least those of the path; 0 to 64, default 24 (derived: what the
    /// arc of the arm makes of 12).
    pub harmonics: i32,
}

impl Feedforward {
    /// Documented defaults.
    pub const DEFAULT: Self = Self { harmonics: 24 };
}

/// Adaptive feedforward cancellation, eq. 3.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Afc {
    /// Cancelled harmonics of the spindle; default 1 to 24 (our choice), paper 2, 4, 6, 8, 10.
    pub harmonics: Harmonics,
    /// Of these, cancel only what repeats from turn to turn; default false (our choice: it takes eight turns longer).
    pub automatic: bool,
    /// Time constant tau of each harmonic, s; 0.01 to 100, default 0.3 (derived: 24 harmonics), paper mode 0.2.
    pub tau: f64,
    /// Advance each resonator by the phase of the closed loop; default true, eq. 3 as printed has none.
    pub phase_advance: bool,
    /// Below this spindle speed nothing is learned, rad/s; 0 to 1e3, default 6.28 = 60 rpm (our choice).
    pub speed_min: f64,
    /// Harmonics above this are neither learned nor put out, rad/s; 62.8 to 31400, default 4398 = 700 Hz (our choice:
    /// three times the bandwidth).
    pub frequency_max: f64,
}

impl Afc {
    /// Documented defaults.
    pub const DEFAULT: Self = Self {
        harmonics: Harmonics::DEFAULT,
        automatic: false,
        tau: 0.3,
        phase_advance: true,
        speed_min: std::f64::consts::TAU,
        frequency_max: std::f64::consts::TAU * 700.0,
    };
}

/// Phase-locked loop that estimates the spindle speed.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Pll {
    /// Natural frequency, rad/s; 1 to 1000, default 126 = 20 Hz (our choice).
    pub bandwidth: f64,
}

impl Pll {
    /// Documented defaults.
    pub const DEFAULT: Self = Self { bandwidth: std::f64::consts::TAU * 20.0 };
}

/// Motion onto the path.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Approach {
    /// Time of the quintic, s; 0.01 to 60, default 0.3 (our choice).
    pub time: f64,
}

impl Approach {
    /// Documented defaults.
    pub const DEFAULT: Self = Self { time: 0.3 };
}

/// Motion to the held angle.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Hold {
    /// Largest speed on the way to `hold_angle`, rad/s; 1e-4 to 100, default 2 (our choice). Never faster than the approach.
    pub speed: f64,
}

impl Hold {
    /// Documented defaults.
    pub const DEFAULT: Self = Self { speed: 2.0 };
}

/// What is a fault.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Limit {
    /// Following error at the tool, m; 1e-6 to 0.1, default 1 mm (our choice).
    pub following_error: f64,
    /// Part of the largest torque that a path may need, 1; 0.1 to 1, default 0.9 (our choice: the rest is for control).
    pub torque_share: f64,
}

impl Limit {
    /// Documented defaults.
    pub const DEFAULT: Self = Self { following_error: 1e-3, torque_share: 0.9 };
}

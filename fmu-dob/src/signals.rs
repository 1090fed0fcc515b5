//! What goes in and out of the law in one sample, grouped as in the FMU.

use serde::{Deserialize, Serialize};

use crate::machine::{ContactSource, Fault, State};
use crate::threshold::Threshold;

/// Inputs, sampled at the start of the tick.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Input {
    /// Encoder position, m.
    pub position: f64,
    /// Whether the encoder and its link are good.
    pub position_valid: bool,
    /// Spindle speed, rad/s; 0 switches the notches off.
    pub spindle_speed: f64,
    /// Rising edge starts an approach.
    pub start: bool,
    /// Ends an approach: decelerate, retract, done.
    pub abort: bool,
}

impl Input {
    /// At rest at 0 with a good encoder.
    pub const START: Self =
        Self { position: 0.0, position_valid: true, spindle_speed: 0.0, start: false, abort: false };
}

/// Outputs; always finite.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Output {
    /// Quantised current command, A.
    pub current: f64,
    /// What the controller is doing.
    pub state: State,
    /// Why it is in the fault state.
    pub fault: Fault,
    /// Whether the approach was aborted.
    pub aborted: bool,
    /// Whether contact was detected; latched until the next start.
    pub contact: bool,
    /// What detected it.
    pub contact_source: ContactSource,
    /// Encoder position at the detection, m.
    pub contact_position: f64,
    /// The same without the known bias, m.
    pub contact_position_estimate: f64,
    /// Time of the detection, s.
    pub contact_time: f64,
    /// The chain of force estimates.
    pub force: Force,
    /// Learned statistics and threshold of the slope.
    pub threshold: Threshold,
    /// Reference of the servo.
    pub reference: Reference,
    /// Reference minus position, m.
    pub tracking_error: f64,
}

impl Output {
    /// All zero, idle.
    pub const START: Self = Self {
        current: 0.0,
        state: State::Idle,
        fault: Fault::None,
        aborted: false,
        contact: false,
        contact_source: ContactSource::None,
        contact_position: 0.0,
        contact_position_estimate: 0.0,
        contact_time: 0.0,
        force: Force::ZERO,
        threshold: Threshold::ZERO,
        reference: Reference { position: 0.0, velocity: 0.0 },
        tracking_error: 0.0,
    };
}

/// The chain of force estimates; positive when something pushes the stage back.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct Force {
    /// Estimated disturbance, N, eq. 1.
    pub disturbance: f64,
    /// Disturbance without spindle harmonics, N.
    pub notched: f64,
    /// Deviation from the moving average, N, eq. 2.
    pub deviation: f64,
    /// Slope of the deviation, N/s, eq. 3.
    pub slope: f64,
}

impl Force {
    /// No force.
    pub const ZERO: Self = Self { disturbance: 0.0, notched: 0.0, deviation: 0.0, slope: 0.0 };
}

/// Reference of the servo.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct Reference {
    /// Position, m.
    pub position: f64,
    /// Velocity, m/s.
    pub velocity: f64,
}

//! What goes in and out of the law in one sample, grouped as in the FMU.

use serde::{Deserialize, Serialize};

use crate::machine::{Fault, State};

/// Inputs, sampled at the start of the tick.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Input {
    /// Angle of the spindle, wrapped or not, rad.
    pub spindle_angle: f64,
    /// Slide encoder, positive towards the spindle axis, m.
    pub slide_position: f64,
    /// Probe encoder, its collapse, 0 when free, m.
    pub probe_position: f64,
    /// Rising edge begins a centring, `false` ends it.
    pub enable: bool,
    /// Rising edge ends the fault state.
    pub reset_fault: bool,
}

impl Input {
    /// All zero, not enabled.
    pub const START: Self =
        Self { spindle_angle: 0.0, slide_position: 0.0, probe_position: 0.0, enable: false, reset_fault: false };
}

/// Outputs; always finite.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Output {
    /// Command to the servo of the slide.
    pub slide: Setpoint,
    /// What the controller is doing.
    pub state: State,
    /// Why it is in the fault state.
    pub fault: Fault,
    /// Whether the ring is centred; latched until the next start.
    pub centred: bool,
    /// From `enable` to `centred`, s.
    pub time_to_centre: f64,
    /// Distance B of the ring's centre from the spindle axis in the last model, m.
    pub eccentricity: f64,
    /// Spindle angle at which the ring is nearest to the pusher, rad.
    pub eccentricity_angle: f64,
    /// Standard deviation of the eccentricity, m.
    pub eccentricity_sigma: f64,
    /// Estimated spindle speed, rad/s.
    pub spindle_speed: f64,
    /// Measured gap between pusher and ring, m.
    pub pusher_gap: f64,
    /// The last push.
    pub push: PushReport,
}

impl Output {
    /// All zero, idle.
    pub const START: Self = Self {
        slide: Setpoint { position_setpoint: 0.0, velocity_setpoint: 0.0 },
        state: State::Idle,
        fault: Fault::None,
        centred: false,
        time_to_centre: 0.0,
        eccentricity: 0.0,
        eccentricity_angle: 0.0,
        eccentricity_sigma: 0.0,
        spindle_speed: 0.0,
        pusher_gap: 0.0,
        push: PushReport::NONE,
    };
}

/// Command to the servo of the slide.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct Setpoint {
    /// Position, positive towards the spindle axis, m.
    pub position_setpoint: f64,
    /// Velocity, m/s.
    pub velocity_setpoint: f64,
}

/// What is told about the last push.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct PushReport {
    /// Pushes since `enable`.
    pub count: i32,
    /// Commanded travel d of the slide, m.
    pub distance: f64,
    /// Velocity of the push, m/s.
    pub velocity: f64,
    /// Lead angle L, rad.
    pub lead_angle: f64,
    /// Learned offset P, m.
    pub offset: f64,
    /// How far the ring went through the centre, m.
    pub overshoot: f64,
    /// Largest of these since `enable`, m.
    pub overshoot_max: f64,
}

impl PushReport {
    /// No push yet.
    pub const NONE: Self = Self {
        count: 0,
        distance: 0.0,
        velocity: 0.0,
        lead_angle: 0.0,
        offset: 0.0,
        overshoot: 0.0,
        overshoot_max: 0.0,
    };
}

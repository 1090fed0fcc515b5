//! What goes in and out of the law in one sample, grouped as in the FMU.

use nalgebra::Vector3;
use serde::{Deserialize, Serialize};

use crate::axes::Axes;
use crate::machine::{Fault, State};
use crate::path::Frame;

/// Inputs, sampled at the start of the tick.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Input {
    /// Rising edge starts a job, false ends it.
    pub enable: bool,
    /// Stops at once.
    pub estop: bool,
    /// Rising edge ends a fault.
    pub reset_fault: bool,
    /// Ball centre by the encoders in the work frame, m.
    pub position: Axes,
    /// Raw force on the tool in the work frame, N.
    pub force: Axes,
    /// Factor of the feed, 0 to 2.
    pub feed_override: f64,
    /// Factor of the wanted force, 0 to 2.
    pub force_override: f64,
}

impl Input {
    /// At rest at the origin.
    pub const START: Self = Self {
        enable: false,
        estop: false,
        reset_fault: false,
        position: Axes::ZERO,
        force: Axes::ZERO,
        feed_override: 1.0,
        force_override: 1.0,
    };
}

/// Outputs; always finite.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Output {
    /// Commanded velocity and its parts.
    pub velocity: Velocity,
    /// Pulses of this sample.
    pub pulses: Axes<i32>,
    /// Force of the law.
    pub force: Force,
    /// Desired ball centre, m.
    pub desired: Axes,
    /// Unit normal out of the material.
    pub normal: Axes,
    /// Unit tangent.
    pub tangent: Axes,
    /// Position error.
    pub error: Error,
    /// Part of the path that is done, 0 to 1.
    pub progress: f64,
    /// What the controller is doing.
    pub state: State,
    /// Why it is in the fault state.
    pub fault: Fault,
    /// The tool presses on the mold.
    pub in_contact: bool,
    /// The whole path is polished.
    pub done: bool,
    /// Stiffness of tool and contact.
    pub stiffness: Stiffness,
    /// Estimated misalignment of the mold.
    pub misalignment: Misalignment,
    /// Cancellation of the ripple.
    pub ripple: Ripple,
    /// The path.
    pub path: Path,
}

impl Output {
    /// All zero, idle.
    pub const START: Self = Self {
        velocity: Velocity { x: 0.0, y: 0.0, z: 0.0, normal: 0.0, tangential: 0.0, position: 0.0, stick_slip: 0.0 },
        pulses: Axes::all(0),
        force: Force { measured: 0.0, setpoint: 0.0, error: 0.0 },
        desired: Axes::ZERO,
        normal: Axes { x: 0.0, y: 0.0, z: 1.0 },
        tangent: Axes { x: 1.0, y: 0.0, z: 0.0 },
        error: Error { tangential: 0.0, lateral: 0.0, normal: 0.0 },
        progress: 0.0,
        state: State::Idle,
        fault: Fault::None,
        in_contact: false,
        done: false,
        stiffness: Stiffness { estimate: 0.0 },
        misalignment: Misalignment { x: 0.0, y: 0.0, z: 0.0, rx: 0.0, ry: 0.0, rz: 0.0 },
        ripple: Ripple { frozen: false },
        path: Path { length: 0.0 },
    };
}

/// Commanded velocity, m/s.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct Velocity {
    /// Along x.
    pub x: f64,
    /// Along y.
    pub y: f64,
    /// Along z.
    pub z: f64,
    /// Of the force law, positive out of the material.
    pub normal: f64,
    /// Of the feed, of the ball centre.
    pub tangential: f64,
    /// Size of that of the position feedback.
    pub position: f64,
    /// Of the stick-slip, with its sign.
    pub stick_slip: f64,
}

/// Force of the law, N.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct Force {
    /// The controlled force.
    pub measured: f64,
    /// The wanted one.
    pub setpoint: f64,
    /// Wanted less measured.
    pub error: f64,
}

/// Position error x_d - x, m.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct Error {
    /// Along the path.
    pub tangential: f64,
    /// Along normal cross tangent.
    pub lateral: f64,
    /// Along the normal.
    pub normal: f64,
}

impl Error {
    /// The parts of the error `offset` (m) at `frame`.
    pub fn along(offset: &Vector3<f64>, frame: &Frame) -> Self {
        Self {
            tangential: offset.dot(&frame.tangent),
            lateral: offset.dot(&frame.normal.cross(&frame.tangent)),
            normal: offset.dot(&frame.normal),
        }
    }
}

/// Stiffness of tool and contact, N/m.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct Stiffness {
    /// Estimated while the force builds up.
    pub estimate: f64,
}

/// Estimated misalignment of the mold.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct Misalignment {
    /// Shift along x, m.
    pub x: f64,
    /// Shift along y, m.
    pub y: f64,
    /// Shift along z, m.
    pub z: f64,
    /// Rotation about x, rad.
    pub rx: f64,
    /// Rotation about y, rad.
    pub ry: f64,
    /// Rotation about z, rad.
    pub rz: f64,
}

/// Cancellation of the ripple.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct Ripple {
    /// It made the ripple worse and has ended.
    pub frozen: bool,
}

/// The path.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct Path {
    /// Its length along the contact points, m.
    pub length: f64,
}

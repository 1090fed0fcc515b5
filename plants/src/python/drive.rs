//! Constructors of drives.

use pyo3::prelude::*;

use super::cells::PyElement;
use crate::elements::drive::{
    CurrentLoop, DriveGains, InductionSpindle, MotionBoard, PulseDrive, RatingPlate, Rotation, Thrust,
};

/// First-order current loop of `bandwidth` rad/s: command, noise -> current, all A.
#[pyfunction]
pub fn current_loop(bandwidth: f64) -> PyElement {
    PyElement::new(CurrentLoop::new(bandwidth))
}

/// Spindle with an induction motor: load -> speed, measured speed, torque of the motor, N.m and rad/s.
///
/// The rating plate is synchronous and rated speed rad/s, rated power W, breakdown over rated torque, time constant s.
#[pyfunction]
pub fn induction_spindle(plate: (f64, f64, f64, f64, f64), friction: f64, lag: f64) -> PyElement {
    let (synchronous, rated_speed, rated_power, overload, time) = plate;
    let plate = RatingPlate { synchronous, rated_speed, rated_power, overload, time };
    PyElement::new(InductionSpindle::new(plate, friction, lag))
}

/// Servo of one axis (N/m, N.s/m, N, s, integral time s or 0):
/// position_setpoint, velocity_setpoint, position, velocity -> force.
#[pyfunction]
pub fn motion_board(stiffness: f64, damping: f64, force_limit: f64, period: f64, integral_time: f64) -> PyElement {
    PyElement::new(MotionBoard::new(stiffness, damping, force_limit, period, integral_time))
}

/// Positioner with pulses of `pulse` m that arrive in `tick` s: pulses, position, velocity, enable -> force, reference.
///
/// The loops are position gain in 1/s, velocity gain in rad/s and its integral in 1/s; feedforward is fraction and
/// bandwidth in rad/s; inertia in kg, the maximum force in N.
#[pyfunction]
pub fn pulse_drive(
    loops: (f64, f64, f64),
    feedforward: (f64, f64),
    inertia: f64,
    force: f64,
    pulse: f64,
    tick: f64,
) -> PyElement {
    let (position, velocity, integral) = loops;
    let (feedforward, smoothing) = feedforward;
    let gains = DriveGains { position, velocity, integral, feedforward, smoothing, inertia, force };
    PyElement::new(PulseDrive::new(gains, pulse, tick))
}

/// Shaft that starts at `start` rad: speed -> angle at the start of the step, angle at its end.
#[pyfunction]
pub fn rotation(start: f64) -> PyElement {
    PyElement::new(Rotation { angle: start })
}

/// Linear motor (N/A, relative ripple, ripple period m, phase rad): current, position -> force.
#[pyfunction]
pub fn thrust(force_constant: f64, ripple: f64, pitch: f64, phase: f64) -> PyElement {
    PyElement::new(Thrust::new(force_constant, ripple, pitch, phase))
}

//! Bounds on the motion of each axis between two samples.

use crate::interface::Parameters;
use crate::monitoring::drive::disturbance;
use crate::reading::axis::Axis;

/// No encoder counts more turns, rad.
pub const ANGLE_MAX: f64 = 1e9;
/// No machine has a longer axis, m.
const POSITION_MAX: f64 = 1e3;
/// Spread of slide positions, m: a hundred steps of 0.1 um.
const SLIDE_SPREAD: f64 = 1e-5;

/// The hub alone, the flexure takes the arm with it later, under disturbances and the torque of the last milliseconds.
pub fn arm(p: &Parameters, torque: f64) -> Axis {
    let (limits, dt) = (&p.limits, p.sample_period);
    let acceleration = (torque + disturbance(p)) / (p.servo.inertia * (1.0 - p.tip.inertia));
    Axis {
        maximum: ANGLE_MAX,
        spread: limits.arm_spread,
        motion: 0.0,
        change: acceleration * dt * dt,
        runs: false,
        lost: limits.lost_samples as u32,
    }
}

/// The spindle, with the accelerations of its drive.
pub fn spindle(p: &Parameters) -> Axis {
    let (limits, dt) = (&p.limits, p.sample_period);
    Axis {
        maximum: ANGLE_MAX,
        spread: limits.spindle_spread,
        motion: 0.0,
        change: limits.spindle_acceleration * dt * dt,
        runs: true,
        lost: limits.lost_samples as u32,
    }
}

/// An external drive moves the slide: its full speed may occur immediately.
pub fn slide(p: &Parameters) -> Axis {
    Axis {
        maximum: POSITION_MAX,
        spread: SLIDE_SPREAD,
        motion: p.limits.slide_speed * p.sample_period,
        change: 0.0,
        runs: false,
        lost: p.limits.lost_samples as u32,
    }
}

//! Constructors of friction.

use pyo3::prelude::*;

use super::cells::PyElement;
use crate::elements::friction::{Bristle, Foot, RollingFriction, Stribeck};

/// Elasto-plastic friction of a part on a table (N, friction law, m, N/m, N.s/m, break-away ratio).
///
/// vx, vy, yaw_rate -> fx, fy, torque, all in the frame of the table. The friction law has static coefficient, kinetic
/// coefficient and Stribeck speed in m/s.
#[pyfunction]
pub fn bristle(
    load: f64,
    law: (f64, f64, f64),
    radius: f64,
    stiffness: f64,
    damping: f64,
    break_away: f64,
) -> PyElement {
    PyElement::new(Bristle::new(load, stribeck(law), radius, stiffness, damping, break_away))
}

/// Foot at `place` m on a part that slides, with a friction law: yaw, vx, vy, yaw_rate -> mu_1, mu_2.
///
/// The friction law has static coefficient, kinetic coefficient and Stribeck speed in m/s.
#[pyfunction]
pub fn foot(place: (f64, f64), law: (f64, f64, f64)) -> PyElement {
    PyElement::new(Foot::new(place, stribeck(law)))
}

/// Friction of balls that roll, at most `friction` N, that changes over `distance` m after a reversal: velocity -> force.
#[pyfunction]
pub fn rolling_friction(friction: f64, distance: f64) -> PyElement {
    PyElement::new(RollingFriction::new(friction, distance))
}

fn stribeck((at_rest, kinetic, speed): (f64, f64, f64)) -> Stribeck {
    Stribeck { at_rest, kinetic, speed }
}

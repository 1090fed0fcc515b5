//! Constructors of parts on a turning table.

use pyo3::prelude::*;

use super::cells::PyElement;
use super::signal::table;
use crate::elements::table::{Outline, Tip, Turntable, Wrench};

/// Round part with a table of its radius over one revolution, m, met by the line y = 0.
///
/// cx, cy, vcx, vcy, orientation, turn_rate -> surface, normal_x, normal_y, vx, vy, phase.
///
/// Raises
/// ------
/// ValueError
///     There is no sample.
#[pyfunction]
pub fn outline(radius: Vec<f64>) -> PyResult<PyElement> {
    Ok(PyElement::new(Outline::new(table(radius)?)))
}

/// One-sided spring with friction (N, m, N/m, N.s/m, 1) that presses on a surface along the line y = 0.
///
/// tip, tip_speed, surface, normal_x, normal_y, vx, vy -> collapse, force, fx, fy.
#[pyfunction]
pub fn tip(preload: f64, ramp: f64, stiffness: f64, damping: f64, friction: f64) -> PyElement {
    PyElement::new(Tip { preload, ramp, stiffness, damping, friction })
}

/// Part on a turning table, in the world frame.
///
/// angle, rate, x, y, yaw, vx, vy, yaw_rate, error_x, error_y -> cx, cy, vcx, vcy, orientation, turn_rate,
/// eccentricity, slip_speed.
#[pyfunction]
pub fn turntable() -> PyElement {
    PyElement::new(Turntable)
}

/// Force on a part on a turning table: fx, fy, place, cx, cy, angle -> table, x, y, torque.
#[pyfunction]
pub fn wrench() -> PyElement {
    PyElement::new(Wrench)
}

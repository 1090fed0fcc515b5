//! Constructors of cutting elements.

use pyo3::exceptions::PyValueError;
use pyo3::prelude::*;

use super::cells::PyElement;
use crate::elements::cutting::{
    Burr, Chip, Deburring, Edge, Flute, Milling, Plunge, Reaction, Shapes, TouchProbe, TurnedPart,
};

/// Chip of a round nose on a face (all m; whether the part turns backward): angle, lateral, depth, cutting -> area m2.
#[pyfunction]
pub fn chip(nose: f64, depth_of_cut: f64, part_radius: f64, backward: bool) -> PyElement {
    PyElement::new(Chip::new(nose, depth_of_cut, part_radius, backward))
}

/// End mill on a burr of bins from a distance m on: heights and thicknesses m.
///
/// The mill is teeth, radius m, Pa per chip cross-section, N/m of engaged edge, largest chip m. The reaction is
/// the fractions of the tangential force against the travel and outward, and the reach of the tool m.
/// distance, normal, across, tx, ty, tz, nx, ny, nz, spindle_speed, part -> torque, force, fx, fy, fz, feed,
/// engagement, finish_low, finish_high, removed, left.
///
/// Raises
/// ------
/// ValueError
///     Heights and thicknesses differ in number, or the pitch is not positive.
#[pyfunction]
pub fn deburring(
    bins: (f64, f64),
    heights: Vec<f64>,
    thicknesses: Vec<f64>,
    mill: (f64, f64, f64, f64, f64),
    reaction: (f64, f64, f64),
) -> PyResult<PyElement> {
    let (from, pitch) = bins;
    let refused = || PyValueError::new_err("a burr needs as many heights as thicknesses, and a positive pitch");
    let burr = Burr::new(from, pitch, heights, thicknesses).ok_or_else(refused)?;
    let (teeth, radius, pressure, edge_force, chip_most) = mill;
    let mill = Milling { teeth, radius, pressure, edge_force, chip_most };
    let (along, outward, reach) = reaction;
    Ok(PyElement::new(Deburring::new(burr, mill, Reaction { along, outward, reach })))
}

/// Edge of line, arc, line over a corner of `radius` m: x, y, z -> distance, normal, across, tx, ty, tz, nx, ny, nz.
///
/// Raises
/// ------
/// ValueError
///     The lines are too short for the radius.
#[pyfunction]
pub fn edge(start: [f64; 3], corner: [f64; 3], end: [f64; 3], radius: f64) -> PyResult<PyElement> {
    Ok(PyElement::new(corner_edge(start, corner, end, radius)?))
}

/// Length of an edge, m.
///
/// Raises
/// ------
/// ValueError
///     The lines are too short for the radius.
#[pyfunction]
pub fn edge_length(start: [f64; 3], corner: [f64; 3], end: [f64; 3], radius: f64) -> PyResult<f64> {
    Ok(corner_edge(start, corner, end, radius)?.length())
}

/// Cutting edge on a tilted tool (m, m, rad): angle -> axial distance from the longest point.
#[pyfunction]
pub fn flute(shortfall: f64, tilt: f64, offset: f64) -> PyElement {
    PyElement::new(Flute::new(shortfall, tilt, offset))
}

/// End mill of two teeth that sinks into a face (springs N/m, force per thickness of the chip N/m):
/// depth, retreat_1, retreat_2, angle, angle_next -> force, floor.
#[pyfunction]
pub fn plunge(stiffness: f64, chip: f64) -> PyElement {
    PyElement::new(Plunge::new(stiffness, chip))
}

/// Touch probe at a wall above an edge, all m: distances along the edge of its start and end, and its height; pretravel,
/// travel and stiffnesses (N/m) of the spring and at its stop: distance, normal, across, nx, ny, nz, part, probe ->
/// contact, deflection, fx, fy, fz.
#[pyfunction]
pub fn touch_probe(wall: (f64, f64, f64), probe: (f64, f64, f64, f64)) -> PyElement {
    let ((from, to, height), (pretravel, travel, spring, end)) = (wall, probe);
    PyElement::new(TouchProbe { wall: (from, to), height, pretravel, travel, stiffness: (spring, end) })
}

/// Turned part that a probe measures along some diameters, tool (radius, roughness) and part (radius, face), all m:
/// angle, lateral, depth, cutting, normal, probing, probe, turned, blank -> reading, angle.
#[pyfunction]
pub fn turned_part(tool: (f64, f64), probe_radius: f64, part: (f64, f64), diameters: usize) -> PyElement {
    let ((tool_radius, roughness), (part_radius, face)) = (tool, part);
    PyElement::new(TurnedPart::new(Shapes { tool_radius, probe_radius, part_radius, face, roughness, diameters }))
}

fn corner_edge(start: [f64; 3], corner: [f64; 3], end: [f64; 3], radius: f64) -> PyResult<Edge> {
    let refused = || {
        let hint = "hint: start, corner and end of the edge are too near for it";
        PyValueError::new_err(format!("radius of the corner: `{radius}` m\n{hint}"))
    };
    Edge::new(start, corner, end, radius).ok_or_else(refused)
}

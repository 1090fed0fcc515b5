//! Constructors of polishing, and the wear of a surface.

use pyo3::exceptions::PyValueError;
use pyo3::prelude::*;

use super::cells::PyElement;
use crate::elements::polishing::{Abrasion, Dimple, HeightMap, Mold, Pose, Rubbing, Step, Stroke, TangentPlane};

/// Contact that rubs: fx, fy, fz, normal_x, normal_y, normal_z, vx, vy, vz -> load, friction_x, friction_y,
/// friction_z, speed, slid, rubbed, work.
#[pyfunction]
pub fn rubbing() -> PyElement {
    PyElement::new(Rubbing::default())
}

/// Plane that touches a mold where it is nearest to a ball: x, y, z, lift -> position, quaternion, normal, contact
/// point in the frame of the mold, distance.
///
/// The base is curvature of cap and saddle in 1/m; dimples are x, y, depth, sigma and the step position, height, width,
/// all m; beyond `rim` m there is no mold. Its pose is `shift` m and the rotation vector `tilt` rad.
#[pyfunction]
pub fn tangent_plane(
    base: (f64, f64),
    dimples: Vec<(f64, f64, f64, f64)>,
    step: (f64, f64, f64),
    rim: f64,
    shift: [f64; 3],
    tilt: [f64; 3],
) -> PyElement {
    let (place, height, width) = step;
    let dimples = dimples.into_iter().map(|(x, y, depth, sigma)| Dimple { x, y, depth, sigma }).collect();
    let mold = Mold::new(base, dimples, Step { place, height, width }, rim);
    PyElement::new(TangentPlane::new(mold, Pose::new(shift, tilt)))
}

/// Height map of a surface after some strokes of a ball, row by row.
///
/// The grid is the position of its first row and column and their distance in m, points are lists of nominal height, true
/// area and height. Strokes are x, y, z of the contact in m, load in N, distance in m. The abrasion is
/// depth per pressure and distance in m2/N, modulus in Pa, radius in m, pressure per height in Pa/m.
///
/// Raises
/// ------
/// ValueError
///     The lists of the map differ in length, or their length is not a square number.
#[pyfunction]
pub fn wear(
    grid: (f64, f64),
    points: (Vec<f64>, Vec<f64>, Vec<f64>),
    strokes: Vec<(f64, f64, f64, f64, f64)>,
    abrasion: (f64, f64, f64, f64),
) -> PyResult<Vec<f64>> {
    let ((start, pitch), (nominal, area, height)) = (grid, points);
    let count = height.len().isqrt();
    if count * count != height.len() || nominal.len() != height.len() || area.len() != height.len() {
        return Err(PyValueError::new_err("a height map is three lists of the same square length"));
    }
    let (preston, modulus, radius, selectivity) = abrasion;
    let abrasion = Abrasion { preston, modulus, radius, selectivity };
    let mut map = HeightMap { start, pitch, count, nominal, area, height };
    let mut patch = Vec::new();
    for (x, y, z, load, distance) in strokes {
        map.rub(&abrasion, &Stroke { centre: [x, y, z], load, distance }, &mut patch);
    }
    Ok(map.height)
}

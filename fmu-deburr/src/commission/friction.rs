//! The way by which friction holds a drive back, from its strokes.
//!
//! What the weights leave of the error, summed up, is how far the drive was sent beyond where the axis is: h sgn x', in lags 1/(g Kp T), with
//! h = F/(m wn^2). It is looked at where the axis slides, a sample that tells nothing of how it broke away, and to and fro. Weights
//! that are a little wrong leave shares of place, velocity and acceleration in it, an offset of the drive a slope in time, and the first sum a
//! constant; they are found with h, so that h does not depend on them.

use nalgebra::{SMatrix, SVector};

use crate::learning::drive::TAPS;
use crate::learning::identification::{BareRun, Identification};

/// Share of the fastest rate from which on an axis slides.
const SLIDES: f64 = 0.3;
/// Unknowns: h, constant, slope, place, velocity, acceleration.
const UNKNOWNS: usize = 6;
/// Least variance of the noise of a reading: that of a whole count.
const ROUNDING: f64 = 1.0 / 12.0;

/// The way and its standard deviation, counts.
pub fn held_back<R: BareRun>(run: &Identification<R>) -> [f64; 2] {
    let (lag, count, fastest) = (run.bare_lag(), run.samples(), run.fastest());
    let (mut normal, mut target) = (SMatrix::<f64, UNKNOWNS, UNKNOWNS>::zeros(), SVector::<f64, UNKNOWNS>::zeros());
    let (mut squares, mut used) = (0.0, 0.0);
    let (mut beyond, mut places) = (0.0, [0.0; TAPS]);
    for k in 0..count {
        let rates = run.modelled_rates(k);
        if rates[1].abs() > SLIDES * fastest {
            let [late, place, early] = places.map(|place| place / fastest);
            let time = k as f64 / count as f64 - 0.5;
            let shape = [rates[1].signum(), 1.0, time, place / count as f64, early - late, early - 2.0 * place + late];
            let shape = SVector::from(shape);
            normal += shape * shape.transpose();
            target += shape * beyond;
            squares += beyond * beyond;
            used += 1.0;
        }
        beyond += run.left(k) / lag;
        (0..TAPS).for_each(|tap| places[tap] += rates[tap]);
    }
    let Some(inverse) = normal.cholesky().map(|normal| normal.inverse()) else { return [0.0; 2] };
    let found = inverse * target;
    let left = (squares - found.dot(&target)) / (used - UNKNOWNS as f64).max(1.0);
    [found[0], (left.max(ROUNDING) * run.shared() * inverse[(0, 0)]).sqrt()]
}

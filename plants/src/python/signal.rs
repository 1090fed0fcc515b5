//! Constructors of signals.

use pyo3::exceptions::PyValueError;
use pyo3::prelude::*;

use super::cells::PyElement;
use crate::elements::signal::{
    ColouredNoise, Harmonics, Integrator, Latch, Limit, Lookup, LowPass, Peak, Product, Slew, Sum,
};

/// Noise of standard deviation `rms` and correlation time `time` s: normal -> value.
#[pyfunction]
pub fn coloured_noise(rms: f64, time: f64) -> PyElement {
    PyElement::new(ColouredNoise::new(rms, time))
}

/// Harmonics 1, 2, ... as (amplitude, phase in rad): angle -> value.
#[pyfunction]
pub fn harmonics(orders: Vec<(f64, f64)>) -> PyElement {
    PyElement::new(Harmonics::new(orders))
}

/// Integral that starts at `start`: value -> integral at the start of the step.
#[pyfunction]
pub fn integrator(start: f64) -> PyElement {
    PyElement::new(Integrator { integral: start })
}

/// Memory of an event: value -> 1 from the first positive value on, 0 before.
#[pyfunction]
pub fn latch() -> PyElement {
    PyElement::new(Latch::default())
}

/// Valid range of the plant: value -> nothing; the step fails outside.
#[pyfunction]
pub fn limit(quantity: String, unit: String, low: f64, high: f64, hint: String) -> PyElement {
    PyElement::new(Limit::new(quantity, unit, low, high, hint))
}

/// Periodic table of one revolution, linear between its samples: angle -> value.
///
/// Raises
/// ------
/// ValueError
///     There is no sample.
#[pyfunction]
pub fn lookup(samples: Vec<f64>) -> PyResult<PyElement> {
    Ok(PyElement::new(table(samples)?))
}

/// First-order filter of `bandwidth` rad/s: value -> filtered.
#[pyfunction]
pub fn low_pass(bandwidth: f64) -> PyElement {
    PyElement::new(LowPass { bandwidth, filtered: 0.0 })
}

/// Largest value so far: value -> maximum.
#[pyfunction]
pub fn peak() -> PyElement {
    PyElement::new(Peak::new())
}

/// Product of two values: a, b -> a b.
#[pyfunction]
pub fn product() -> PyElement {
    PyElement::new(Product)
}

/// Setpoint that starts at `start` and changes by `rate` per second as a maximum: target -> value.
#[pyfunction]
pub fn slew(start: f64, rate: f64) -> PyElement {
    PyElement::new(Slew { rate, value: start })
}

/// Sum of `terms` inputs: a, b, ... -> sum.
///
/// Raises
/// ------
/// ValueError
///     Too many terms.
#[pyfunction]
pub fn summing_junction(terms: usize) -> PyResult<PyElement> {
    let limit = Sum::TERMS_MAX;
    let refused = || PyValueError::new_err(format!("`terms` of a sum: `{terms}`, limit `{limit}`"));
    Ok(PyElement::new(Sum::new(terms).ok_or_else(refused)?))
}

/// Periodic table of at least one sample.
pub fn table(samples: Vec<f64>) -> PyResult<Lookup> {
    Lookup::new(samples).ok_or_else(|| PyValueError::new_err("a table needs at least one sample"))
}

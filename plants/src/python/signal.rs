//! Constructors of signals.

use pyo3::exceptions::PyValueError;
use pyo3::prelude::*;

use super::cells::PyElement;
use crate::elements::signal::{
    ColouredNoise, Harmonics, Integrator, Latch, Limit, Lookup, LowPass, Peak, Product, Slew, Sum,
};

/// Adds them to a module.
pub fn register(module: &Bound<'_, PyModule>) -> PyResult<()> {
    module.add_function(wrap_pyfunction!(coloured_noise, module)?)?;
    module.add_function(wrap_pyfunction!(harmonics, module)?)?;
    module.add_function(wrap_pyfunction!(integrator, module)?)?;
    module.add_function(wrap_pyfunction!(latch, module)?)?;
    module.add_function(wrap_pyfunction!(limit, module)?)?;
    module.add_function(wrap_pyfunction!(lookup, module)?)?;
    module.add_function(wrap_pyfunction!(low_pass, module)?)?;
    module.add_function(wrap_pyfunction!(peak, module)?)?;
    module.add_function(wrap_pyfunction!(product, module)?)?;
    module.add_function(wrap_pyfunction!(slew, module)?)?;
    module.add_function(wrap_pyfunction!(summing_junction, module)?)?;
    Ok(())
}

/// Noise of standard deviation `rms` and correlation time `time` s: normal -> value.
#[pyfunction]
fn coloured_noise(rms: f64, time: f64) -> PyElement {
    PyElement::new(ColouredNoise::new(rms, time))
}

/// Harmonics 1, 2, ... as (amplitude, phase in rad): angle -> value.
#[pyfunction]
fn harmonics(orders: Vec<(f64, f64)>) -> PyElement {
    PyElement::new(Harmonics::new(orders))
}

/// Integral that starts at `start`: value -> integral at the start of the step.
#[pyfunction]
fn integrator(start: f64) -> PyElement {
    PyElement::new(Integrator::new(start))
}

/// Memory of an event: value -> 1 from the first positive value on, 0 before.
#[pyfunction]
fn latch() -> PyElement {
    PyElement::new(Latch::new())
}

/// Range in which the plant means something: value -> nothing; the step fails outside.
#[pyfunction]
fn limit(quantity: String, unit: String, low: f64, high: f64, hint: String) -> PyElement {
    PyElement::new(Limit::new(quantity, unit, low, high, hint))
}

/// Periodic table of one turn, linear between its samples: angle -> value.
///
/// Raises
/// ------
/// ValueError
///     There is no sample.
#[pyfunction]
fn lookup(samples: Vec<f64>) -> PyResult<PyElement> {
    Ok(PyElement::new(table(samples)?))
}

/// First-order filter of `bandwidth` rad/s: value -> filtered.
#[pyfunction]
fn low_pass(bandwidth: f64) -> PyElement {
    PyElement::new(LowPass::new(bandwidth))
}

/// Largest value so far: value -> maximum.
#[pyfunction]
fn peak() -> PyElement {
    PyElement::new(Peak::new())
}

/// Product of two values: a, b -> a b.
#[pyfunction]
fn product() -> PyElement {
    PyElement::new(Product::new())
}

/// Set-point that starts at `start` and changes by `rate` per second at most: target -> value.
#[pyfunction]
fn slew(start: f64, rate: f64) -> PyElement {
    PyElement::new(Slew::new(start, rate))
}

/// Sum of `terms` inputs: a, b, ... -> sum.
///
/// Raises
/// ------
/// ValueError
///     More terms than a sum can have.
#[pyfunction]
fn summing_junction(terms: usize) -> PyResult<PyElement> {
    let limit = Sum::TERMS_MAX;
    let refused = || PyValueError::new_err(format!("`terms` of a sum: `{terms}`, limit `{limit}`"));
    Ok(PyElement::new(Sum::new(terms).ok_or_else(refused)?))
}

/// Periodic table of at least one sample.
pub fn table(samples: Vec<f64>) -> PyResult<Lookup> {
    Lookup::new(samples).ok_or_else(|| PyValueError::new_err("a table needs at least one sample"))
}

//! Python module `machining_native`: what the plants and the engine of the harness have in native code.
//!
//! Both hand circuits to each other, so both must come out of one library.

#![forbid(unsafe_code)]
#![cfg(feature = "extension-module")]

use pyo3::prelude::*;

/// Elements of the MuJoCo plants, circuits of them, and the stepper of closed loops.
#[pymodule]
fn machining_native(module: &Bound<'_, PyModule>) -> PyResult<()> {
    plants::python::register(module)?;
    cosim_engine::python::register(module)
}

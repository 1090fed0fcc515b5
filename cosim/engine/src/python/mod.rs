//! The stepper for Python: addresses come out of numpy arrays, ctypes and MuJoCo's bindings.

mod build;
pub(crate) mod rows;
mod stepper;

use pyo3::prelude::*;

/// Adds the stepper to a module.
///
/// # Errors
/// When Python refuses.
pub fn register(module: &Bound<'_, PyModule>) -> PyResult<()> {
    module.add_class::<stepper::PyStepper>()
}

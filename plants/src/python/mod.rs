//! The crate for Python: cells in numpy arrays, circuits, and one constructor per element.

#[allow(unsafe_code)]
mod cells;
mod cutting;
mod drive;
mod friction;
mod polishing;
mod signal;
mod table;

use pyo3::prelude::*;

pub use cells::{Cell, PyCircuit};

/// Adds everything to a module.
///
/// # Errors
/// When Python refuses.
pub fn register(module: &Bound<'_, PyModule>) -> PyResult<()> {
    module.add_class::<Cell>()?;
    module.add_class::<PyCircuit>()?;
    module.add_class::<cells::PyElement>()?;
    [cutting::register, drive::register, friction::register, polishing::register, signal::register, table::register]
        .iter()
        .try_for_each(|register| register(module))
}

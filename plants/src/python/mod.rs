//! The crate for Python: cells in numpy arrays, circuits, and one constructor per element.

#[allow(unsafe_code)]
mod cells;
pub mod cutting;
pub mod drive;
pub mod friction;
pub mod polishing;
pub mod signal;
pub mod table;

pub use cells::{Cell, PyCircuit, PyElement};

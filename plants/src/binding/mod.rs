//! The crate for Python: cells in numpy arrays, circuits, and the module `plants._native`.

pub(crate) mod cells;
mod module;

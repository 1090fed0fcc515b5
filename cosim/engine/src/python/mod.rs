//! The stepper for Python: addresses come from numpy arrays, ctypes and MuJoCo's bindings.

mod build;
pub(crate) mod rows;
mod stepper;

pub use stepper::PyStepper;

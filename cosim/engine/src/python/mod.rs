//! The stepper for Python: addresses come out of numpy arrays, ctypes and MuJoCo's bindings.

mod build;
pub(crate) mod rows;
mod stepper;

pub use stepper::PyStepper;

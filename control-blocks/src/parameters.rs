//! Reading and checking parameters at initialisation.

pub mod check;
pub mod error;
pub mod file;
pub mod numbers;
pub mod parameter;

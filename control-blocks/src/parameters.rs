//! Reading, checking and writing parameters.

pub mod check;
pub mod error;
pub mod file;
pub mod numbers;
pub mod parameter;

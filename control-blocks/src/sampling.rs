//! Samples, switches and delays.

pub mod edge;
pub mod input;

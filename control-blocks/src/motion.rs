//! References that a machine can follow.

pub mod quintic;
pub mod ramp;
pub mod trajectory;

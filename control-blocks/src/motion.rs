//! References that a machine can follow.

pub mod multisine;
pub mod quintic;
pub mod ramp;
pub mod trajectory;

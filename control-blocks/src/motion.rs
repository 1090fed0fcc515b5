//! References that a machine can follow.

pub mod ramp;
pub mod trajectory;

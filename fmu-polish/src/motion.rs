//! The other parts of the velocity, their sum and the pulses made of it.

pub mod feigned;
pub mod felt_motion;
pub mod position;
pub mod pulses;
pub mod sliding;
pub mod stick_slip;
pub mod sweep_limits;
pub mod velocity;

//! The other parts of the velocity, their sum and the pulses made of it.

pub mod apparent_sliding;
pub mod position;
pub mod pulses;
pub mod sensed_motion;
pub mod sliding;
pub mod stick_slip;
pub mod sweep_limits;
pub mod velocity;

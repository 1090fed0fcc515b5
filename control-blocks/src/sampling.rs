//! Samples, switches and delays.

pub mod consecutive;
pub mod edge;
pub mod input;
pub mod sent_commands;
pub mod ticks;

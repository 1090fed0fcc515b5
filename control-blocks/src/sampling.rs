//! Samples, switches and delays.

pub mod consecutive;
pub mod edge;
pub mod input;
pub mod last_good;
pub mod request;
pub mod sent_commands;
pub mod ticks;

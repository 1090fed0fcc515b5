//! The controller in closed loop with a native robot: learning, playback, cutting, faults, state bytes.

mod learning;
mod robot;
mod setup;

//! The controller in closed loop with a native robot: learning, playback, modes, faults, laws, state bytes.

mod commission;
mod errors;
mod faults;
mod identification;
mod interpolation;
mod laws;
mod learning;
mod modes;
mod nominal;
mod norm_optimal;
mod restart;
mod robot;
mod robustness;
mod round_trip;
mod setup;
mod state;

//! The controller in closed loop with a native robot: learning, playback, modes, faults, state bytes.

mod adaptation;
mod errors;
mod faults;
mod interpolation;
mod learning;
mod modes;
mod norm_optimal;
mod robot;
mod round_trip;
mod setup;
mod state;
mod wild;

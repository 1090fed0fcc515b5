//! The controller in closed loop with a ring: centering, laws, faults, enable and reset, hostile inputs, state bytes.

mod centering;
mod commission;
mod enable;
mod faults;
mod hostile;
mod law;
mod monitors;
mod nominal;
mod ring;
mod run;
mod state;

//! The controller in closed loop with a native machine: tracking, faults, stability, state bytes.

mod faults;
mod identify;
mod machine;
mod modes;
mod robustness;
mod run;
mod stability;
mod state;
mod tracking;
mod wild;

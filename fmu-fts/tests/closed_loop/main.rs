//! The controller in closed loop with a native machine: tracking, faults, stability, state bytes, cost.

mod cost;
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

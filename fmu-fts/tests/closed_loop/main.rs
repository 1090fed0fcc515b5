//! The controller in closed loop with a native machine: tracking, faults, stability, state bytes; and the calibration
//! on ideal parts.

mod calibration;
mod commission;
mod faults;
mod form;
mod identify;
mod law;
mod leaving;
mod lens;
mod machine;
mod modes;
mod robustness;
mod run;
mod stability;
mod state;
mod tracking;
mod wild;

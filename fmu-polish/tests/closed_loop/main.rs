//! The controller in closed loop with a robot.

mod commission;
#[path = "../common/mod.rs"]
mod common;
mod cycle;
mod faults;
mod hostile;
mod monitors;
mod outputs;
mod robot;
mod run;
mod sliding;
mod state;

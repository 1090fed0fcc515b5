//! Native engine: a closed loop of controller and plant by addresses and C functions, without Python.
//!
//! One step has the same order and the same arithmetic as the reference engine of the harness, so that the results are
//! bit-identical. Time is `k * step`, never accumulated. Nothing here knows the layout of MuJoCo's structs.
//! All unsafe code is in [`ffi`].

#![deny(unsafe_code)]

mod condition;
mod failure;
mod fault;
#[allow(unsafe_code)]
pub mod ffi;
mod links;
mod log;
mod machine;
#[cfg(feature = "python")]
pub mod python;
mod stepper;
mod wire;

pub use condition::{Condition, Operation};
pub use failure::Failure;
pub use fault::FaultEffect;
pub use links::{Injection, Link, Links, Stimulus};
pub use log::{Log, Trigger};
pub use machine::Machine;
pub use stepper::{End, Stepper};
pub use wire::{Delay, Shape};

//! Fast stepper: a closed loop of controller and plant by addresses and C functions, without Python.
//!
//! One step does what the reference loop of the harness does, in the same order and with the same arithmetic, so that
//! both give the same bits. Time is `k * step`, never accumulated. Nothing here knows the layout of MuJoCo's structs.

#[cfg(feature = "extension-module")]
pub(crate) mod binding;
mod condition;
mod controller;
mod engine;
#[cfg(feature = "extension-module")]
mod exports;
mod failure;
mod links;
mod log;
mod machine;
#[cfg(feature = "extension-module")]
mod rows;
mod slot;
mod trap;
mod wire;

pub use condition::{Condition, Operation};
pub use controller::{Call, Controller, DoStep, Move};
pub use engine::Stepper;
pub use failure::Failure;
pub use links::{Drive, Injection, Link, Links, Series};
pub use log::{Bank, Log};
pub use machine::{Half, Machine};
pub use slot::Slot;
pub use trap::{Apply, Body, DeleteBatch, ErrorText, Functions, MakeBatch, Trap};
pub use wire::{Delay, Shape};

#[cfg(test)]
mod tests;

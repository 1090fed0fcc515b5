//! Foreign memory and foreign C functions.
//!
//! The creator of one of these types guarantees valid addresses while any copy is in use, and use by one thread at a time;
//! everything else is safe.

mod controller;
#[cfg(feature = "python")]
mod exports;
mod physics;
mod trap;
mod values;

pub use controller::{Call, Controller, DoStep, GetBooleanStatus, Move};
#[cfg(feature = "python")]
pub use exports::{Exports, trap};
pub use physics::{Half, Physics};
pub use trap::{Apply, Body, DeleteBatch, ErrorText, Functions, MakeBatch, Trap};
pub use values::{Bank, Series, Slot, Table};

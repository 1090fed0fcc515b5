//! The C API of FMI 2.0.5: all 44 functions.
//!
//! Every function turns C arguments into Rust ones, passes a barrier for panics and re-entrance,
//! and calls the safe instance. Names and types are those of the standard's headers.
//!
//! # Safety
//! Callers keep the promises of the standard: an instance pointer comes from fmi2Instantiate
//! and was not freed, arrays hold as many elements as the call says, strings end with NUL. NULL is
//! answered with an error everywhere.
#![allow(unsafe_code, non_camel_case_types, non_snake_case, missing_docs, clippy::missing_safety_doc)]

mod call;
mod exchange;
mod instances;
mod phases;
mod states;
mod steps;
mod types;
mod values;

pub use instances::{file, instantiate};
pub use steps::do_step;
pub use types::*;
pub use values::{get_real, set_real};

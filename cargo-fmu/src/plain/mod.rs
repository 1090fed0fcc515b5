//! A controller without FMI: a C library of its own, and its header.
//!
//! The header cannot come from cbindgen, which sees neither what a macro makes nor units, ranges and start values: it is
//! written from the model description, and so is the C code between it and the functions of FMI inside the
//! library. What the library computes is what the FMU computes. Blocks of Modelica call the same library.

mod header;
mod library;
mod members;
mod modelica;
mod source;
mod template;

pub use library::{Library, modelica_package, write};

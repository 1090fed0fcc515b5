//! Packs a crate that uses `fmi2-export` as an FMU: the library of `cargo fmu`.
//!
//! [`build`] makes the C library, [`inspect`] says what keeps it from loading everywhere, [`binary`] asks it for the files it
//! describes itself with, [`contents`] makes of them and of the README what people and tools are shown, and [`fmu`] packs it all.
//! [`plain`] makes a library for programs that know nothing of FMI instead.

pub mod archive;
pub mod binary;
pub mod build;
pub mod choice;
pub mod contents;
pub mod facts;
pub mod fmu;
pub mod functions;
pub mod inspect;
mod interface;
pub mod linker;
pub mod pack;
pub mod plain;
pub mod platform;
pub mod process;
mod profile;
pub mod project;

//! Packs a crate that uses `fmi2-export` as an FMU: the library behind `cargo fmu`.
//!
//! [`build`] makes the C library, [`inspect`] says what keeps it from loading everywhere, [`binary`] asks it for the
//! files it describes itself with, [`guide`], [`picture`] and [`terminals`] make of them and of the
//! README what people and tools show, [`reference`] records a short run, [`licences`] adds those of its dependencies, and [`fmu`] packs it all.

pub mod archive;
pub mod binary;
pub mod build;
pub mod choice;
pub mod facts;
pub mod fmu;
pub mod functions;
pub mod guide;
pub mod inspect;
pub mod licences;
pub mod linker;
mod markup;
pub mod pack;
pub mod picture;
pub mod platform;
pub mod process;
mod profile;
pub mod project;
pub mod reference;
pub mod terminals;

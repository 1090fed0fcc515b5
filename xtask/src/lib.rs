//! The project's commands as a library: `cargo xtask setup | new | fmu | demo | test | bench | wheel`.
//!
//! `main.rs` is only the command line. Each command is one module; [`workspace`], [`process`], [`fingerprint`] and
//! [`python`] are what they share. FMUs are packed by the library of `cargo-fmu`.

pub mod bench;
pub mod clients;
pub mod demo;
pub mod fingerprint;
pub mod fmu;
pub mod new;
pub mod plain_c;
pub mod platforms;
pub mod python;
pub mod release_set;
pub mod setup;
pub mod test;
pub mod wheel;
pub mod workspace;

pub use cargo_fmu::process;

//! Reading and checking parameters at initialisation.

pub mod error;

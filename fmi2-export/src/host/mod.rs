//! Layer between an instance and the program that has loaded it: rules of the calls, messages, panics, folders.

pub mod hook;
pub mod logger;
pub mod phase;
pub mod resources;
pub mod text;

//! What builds and runs FMUs of other platforms, all of it below `target/platforms/`: nothing is installed on the machine.

pub mod debian;
pub mod emulators;
pub mod toolchain;

/// Folder for all of it.
pub const FOLDER: &str = "target/platforms";

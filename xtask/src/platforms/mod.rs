//! Tools that build and run FMUs of other platforms. They are unpacked below `target/platforms/`: nothing is installed
//! on the machine.

pub mod debian;
pub mod emulators;
pub mod toolchain;

/// Folder for all of it.
pub const FOLDER: &str = "target/platforms";

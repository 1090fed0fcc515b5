//! Linker of the library, and the oldest C library with which the linked library works.

use std::process::Command;

use crate::process;

/// Newest version of the GNU C library whose symbols a Linux FMU may need when [`Linker::Zig`] links it.
pub const GLIBC: (u32, u32) = (2, 17);

/// Linker of the library of an FMU.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Linker {
    /// The system's linker: the library needs the C library of this machine or a newer one.
    System,
    /// `cargo-zigbuild`, on Linux: the library needs [`GLIBC`] or newer.
    Zig,
}

impl Linker {
    /// `Zig` on Linux where `cargo-zigbuild` and its compiler are on `PATH`, otherwise `System`.
    pub fn find() -> Self {
        let runs = |program: &str, words: &[&str]| {
            process::output(Command::new(program).args(words)).is_ok_and(|output| output.status.success())
        };
        let zig = || runs("python3", &["-m", "ziglang", "version"]) || runs("zig", &["version"]);
        let old = cfg!(target_os = "linux") && runs("cargo-zigbuild", &["--version"]) && zig();
        if old { Self::Zig } else { Self::System }
    }
}

//! Wine, QEMU, and the C library and Python of ARM Linux, with which the tests run FMUs and wheels of other platforms.

use std::fs;
use std::path::Path;

use anyhow::{Context, Result};

use super::debian;
use super::toolchain::libraries;
use crate::workspace::Workspace;

/// Unpacks them below `target/platforms`: `wine`, `qemu` and `aarch64`.
///
/// # Errors
/// When a package cannot be had.
pub fn install(workspace: &Workspace) -> Result<()> {
    let wine = debian::unpack(workspace, "wine", None, &["wine64"])?;
    make_movable(&wine).context("cannot prepare Wine")?;
    debian::unpack(workspace, "qemu", None, &["qemu-user"])?;
    debian::unpack(workspace, "aarch64", Some("arm64"), &["libc6", "python3-minimal"])?;
    Ok(())
}

/// Debian's Wine looks for two of its files below `/usr`.
fn make_movable(root: &Path) -> Result<()> {
    let programs = root.join("usr/lib/wine");
    fs::copy(programs.join("wineserver64"), programs.join("wineserver"))?;
    let library = libraries(root).join("wine/x86_64-windows/zlib1.dll");
    let packed = root.join("usr/x86_64-w64-mingw32/lib/zlib1.dll");
    if packed.exists() && !library.exists() {
        // perhaps a link to where the package would be installed
        let _ = fs::remove_file(&library);
        fs::copy(packed, library)?;
    }
    Ok(())
}

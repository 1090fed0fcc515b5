//! `cargo xtask fmu --release-set`: FMUs for several platforms; `cargo xtask test --platforms`: the proof that they run.

use anyhow::{Result, ensure};
use cargo_fmu::linker::Linker;
use cargo_fmu::platform::{AARCH64_LINUX, LINUX64, Platform, WIN64};

use crate::fmu;
use crate::platforms::{emulators, toolchain};
use crate::process;
use crate::setup;
use crate::workspace::Workspace;

/// What every FMU of the set holds a library for.
const PLATFORMS: [&Platform; 3] = [LINUX64, AARCH64_LINUX, WIN64];

/// Folder of the set.
const FOLDER: &str = "target/release-set";

/// Builds the named controllers for all platforms of the set, all controllers when none is named.
///
/// # Errors
/// When this is no Linux machine, when the toolchain cannot be fetched, or when a build fails.
pub fn run(workspace: &Workspace, names: &[String]) -> Result<()> {
    ensure!(
        workspace.linker == Linker::Zig,
        "the release set is built on Linux: only there one toolchain has all of it"
    );
    let controllers = fmu::controllers(workspace);
    let packages = fmu::select(&workspace.root, &controllers, names)?;
    setup::environment(workspace)?;
    let mut platforms = PLATFORMS.to_vec();
    let host = Platform::host()?;
    // the library that is asked for the texts comes first
    platforms.sort_by_key(|platform| *platform != host);
    let mut cross = Workspace::load()?;
    toolchain::install(&mut cross, &platforms)?;
    fmu::pack_for(&cross, &packages, &platforms, &workspace.path(FOLDER))
}

/// Builds the set, fetches what runs it here, and runs it.
///
/// # Errors
/// When something cannot be built or fetched, or when a test fails.
pub fn test(workspace: &Workspace) -> Result<()> {
    run(workspace, &[])?;
    setup::native(workspace)?;
    emulators::install(workspace)?;
    let mut pytest = workspace.venv_command("pytest");
    pytest.args(["-m", "platforms", "-rs", "tests/conformance/test_platforms.py"]);
    process::run("platforms", &mut pytest)
}

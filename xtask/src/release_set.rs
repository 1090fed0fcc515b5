//! `cargo xtask fmu --release-set`: FMUs for several platforms; `cargo xtask test --platforms`: the proof that they run.

use std::fs;
use std::path::Path;

use anyhow::{Result, ensure};
use cargo_fmu::linker::Linker;
use cargo_fmu::pack::DESCRIPTION;
use cargo_fmu::platform::{AARCH64_LINUX, LINUX64, Platform, WIN64};
use cargo_fmu::{binary, build};

use crate::fmu;
use crate::platforms::{self, emulators, toolchain};
use crate::process;
use crate::setup;
use crate::workspace::Workspace;

/// Platforms of the libraries in every FMU of the set.
pub const PLATFORMS: [&Platform; 3] = [LINUX64, AARCH64_LINUX, WIN64];

/// Folder of the set.
pub const FOLDER: &str = "target/release-set";

/// Builds the named controllers for all platforms of the set, all controllers when none is named.
///
/// # Errors
/// When this is no Linux machine, when the toolchain cannot be fetched, or when a build fails.
pub fn run(workspace: &Workspace, names: &[String]) -> Result<()> {
    build_set(workspace, names).map(|_| ())
}

/// Builds the set and a probe, fetches what runs them here, and runs them.
///
/// # Errors
/// When something cannot be built or fetched, or when a test fails.
pub fn test(workspace: &Workspace) -> Result<()> {
    let cross = build_set(workspace, &[])?;
    lay_out_probe(&cross, &workspace.path(platforms::FOLDER).join("probe"))?;
    setup::native(workspace)?;
    emulators::install(workspace)?;
    let mut pytest = workspace.venv_command("pytest");
    pytest.args(["-m", "platforms", "-rs", "tests/conformance"]);
    process::run("platforms", &mut pytest)
}

/// Builds the set; returns the workspace that builds for its platforms.
///
/// # Errors
/// As [`run`].
pub fn build_set(workspace: &Workspace, names: &[String]) -> Result<Workspace> {
    ensure!(
        workspace.linker == Linker::Zig,
        "the release set is built on Linux: only there one toolchain has all of it"
    );
    let controllers = fmu::controllers(workspace);
    let packages = fmu::select(&workspace.root, &controllers, names)?;
    setup::environment(workspace)?;
    let mut set = PLATFORMS.to_vec();
    let host = Platform::host()?;
    // the library that is asked for the texts comes first
    set.sort_by_key(|platform| *platform != host);
    let mut cross = Workspace::load()?;
    toolchain::install(&mut cross, &set)?;
    fmu::pack_for(&cross, &packages, &set, &workspace.path(FOLDER))?;
    Ok(cross)
}

/// Builds the FMU that fails on purpose, as it lies when it is unpacked.
fn lay_out_probe(cross: &Workspace, folder: &Path) -> Result<()> {
    for platform in PLATFORMS {
        let library = build::example(cross, "fmi2-export", "probe", platform)?;
        let place = folder.join("binaries").join(platform.folder);
        fs::create_dir_all(&place)?;
        fs::copy(&library, place.join(format!("probe.{}", platform.extension)))?;
        if platform == Platform::host()? {
            for (path, text) in binary::files(&library)?.into_iter().filter(|(path, _)| path == DESCRIPTION) {
                fs::write(folder.join(path), text)?;
            }
        }
    }
    Ok(())
}

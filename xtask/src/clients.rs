//! `cargo xtask test --clients`: importers of others that no package of `.venv` brings, built below `target/clients/`.

use std::process::Command;

use anyhow::{Context, Result};

use crate::fingerprint::{self, Stamp};
use crate::fmu;
use crate::process;
use crate::setup;
use crate::workspace::Workspace;

/// Folder for all of it.
const FOLDER: &str = "target/clients";
const FMI_SIM: &str = "0.7.0";
const LIBCLANG: &str = "18.1.1";

/// Builds the importers, and runs the tests that need them on the FMUs.
///
/// # Errors
/// When something cannot be built or fetched, or when a test fails.
pub fn test(workspace: &Workspace) -> Result<()> {
    setup::run(workspace)?;
    fmu::pack_all(workspace, &fmu::controllers(workspace))?;
    fmi_sim(workspace)?;
    let mut pytest = workspace.venv_command("pytest");
    pytest.args(["-m", "clients", "-rs", "tests/conformance/test_clients.py"]);
    process::run("clients", &mut pytest)
}

/// Builds fmi-sim, whose build reads the headers of FMI by libclang.
fn fmi_sim(workspace: &Workspace) -> Result<()> {
    let folder = workspace.path(FOLDER);
    let stamp = Stamp(folder.join("fmi-sim.stamp"));
    let wanted = fingerprint::of(&workspace.root, &[], &[FMI_SIM, LIBCLANG])?;
    if stamp.holds(&wanted) {
        process::up_to_date("fmi-sim");
        return Ok(());
    }
    let packages = folder.join("libclang");
    let mut pip = workspace.venv_command("python");
    pip.args(["-m", "pip", "install", "--quiet", "--disable-pip-version-check", "--upgrade", "--target"]);
    pip.arg(&packages).arg(format!("libclang=={LIBCLANG}"));
    process::run("fetch libclang", &mut pip).context("hint: this step needs a package index that `pip` reaches")?;
    // the package has no headers of the compiler
    let headers = process::text(Command::new("cc").arg("-print-file-name=include"))?;
    let mut cargo = workspace.command("cargo");
    cargo.args(["install", "fmi-sim", "--version", FMI_SIM, "--locked", "--debug", "--root"]).arg(&folder);
    cargo.arg("--target-dir").arg(folder.join("build"));
    cargo.env("LIBCLANG_PATH", packages.join("clang/native"));
    cargo.env("BINDGEN_EXTRA_CLANG_ARGS", format!("-I{}", headers.trim()));
    process::run(&format!("build fmi-sim {FMI_SIM}"), &mut cargo)?;
    stamp.set(&wanted)
}

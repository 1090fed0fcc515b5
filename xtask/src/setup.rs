//! `cargo xtask setup`: `.venv`, the pinned requirements, the native code of plants and engine.

use std::path::PathBuf;
use std::process::Command;

use anyhow::{Context, Result};
use cargo_fmu::linker::Linker;

use crate::fingerprint::{self, Stamp};
use crate::process;
use crate::python;
use crate::workspace::Workspace;

/// Files and folders from which the module `machining_native` is built; a change of one rebuilds the module.
pub const NATIVE: &[&str] = &[
    "Cargo.lock",
    "Cargo.toml",
    "cosim/engine",
    "machining_native.pyi",
    "native",
    "plants/Cargo.toml",
    "plants/src",
    "pyproject.toml",
];

/// Everything Python needs, each step only when it is not up to date.
///
/// # Errors
/// When Python is missing or too old, or when a step fails.
pub fn run(workspace: &Workspace) -> Result<()> {
    environment(workspace)?;
    native(workspace)
}

/// Makes `.venv` where the linker lies in it.
///
/// # Errors
/// As [`environment`].
pub fn linker(workspace: &Workspace) -> Result<()> {
    if workspace.linker == Linker::Zig { environment(workspace) } else { Ok(()) }
}

/// Makes `.venv` and installs the requirements with the hashes of `requirements.txt`.
///
/// # Errors
/// When Python is missing or too old, or when the packages cannot be installed.
pub fn environment(workspace: &Workspace) -> Result<()> {
    let interpreter = workspace.venv_program("python");
    if python::version(&interpreter).is_none_or(|version| version < python::OLDEST) {
        let mut command = Command::new(python::find()?);
        command.args(["-m", "venv", "--clear"]).arg(workspace.path(".venv"));
        process::run("make `.venv`", &mut command)?;
    }

    let version = process::text(Command::new(&interpreter).arg("--version"))?;
    let wanted = fingerprint::of(&workspace.root, &["requirements.txt"], &[&version])?;
    let stamp = Stamp(workspace.path(".venv/.requirements"));
    if stamp.holds(&wanted) {
        process::up_to_date("`.venv`");
        return Ok(());
    }
    let mut pip = workspace.venv_command("python");
    pip.args(["-m", "pip", "install", "--quiet", "--disable-pip-version-check", "--require-hashes"]);
    pip.args(["-r", "requirements.txt"]);
    process::run("install the pinned requirements into `.venv`", &mut pip)
        .context("cannot install the Python requirements\nhint: this step needs a package index that `pip` reaches")?;
    stamp.set(&wanted)
}

/// Builds `machining_native` into `.venv` and installs the packages `plants` and `cosim` in editable form.
///
/// # Errors
/// When the build fails.
pub fn native(workspace: &Workspace) -> Result<()> {
    let toolchain = process::text(Command::new("rustc").arg("--version"))?;
    let wanted = fingerprint::of(&workspace.root, NATIVE, &[&toolchain])?;
    let stamp = Stamp(workspace.path(".venv/.native"));
    if stamp.holds(&wanted) {
        process::up_to_date("native module");
        return Ok(());
    }
    let mut pip = workspace.venv_command("python");
    pip.args(["-m", "pip", "install", "--quiet", "--disable-pip-version-check"]);
    pip.args(["--no-deps", "--no-build-isolation", "--editable", "."]);
    process::run("build the native module", &mut pip)?;
    stamp.set(&wanted)
}

/// Folder of the installed FMPy: its FMI headers and schemas serve the tests and the bench.
///
/// # Errors
/// When FMPy is not installed in `.venv`.
pub fn fmpy_folder(workspace: &Workspace) -> Result<PathBuf> {
    let code = "import importlib.util, pathlib; print(pathlib.Path(importlib.util.find_spec('fmpy').origin).parent)";
    let folder = process::text(workspace.venv_command("python").args(["-c", code]))
        .context("FMPy is not installed in `.venv`\nhint: run `cargo xtask setup`")?;
    Ok(PathBuf::from(folder.trim()))
}

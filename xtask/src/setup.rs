//! `cargo xtask setup`: `.venv`, the pinned requirements, the native half of the plants.

use std::fs;
use std::path::PathBuf;
use std::process::Command;

use anyhow::{Context, Result, ensure};

use crate::fingerprint::{self, Stamp};
use crate::process;
use crate::python;
use crate::workspace::Workspace;

/// Everything Python needs, each step only when it is not up to date.
///
/// # Errors
/// When Python is missing or too old, or when a step fails.
pub fn run(workspace: &Workspace) -> Result<()> {
    environment(workspace)?;
    native(workspace)
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

/// Builds `plants._native` and installs the packages `plants` and `cosim` in editable form.
///
/// # Errors
/// When the build fails.
pub fn native(workspace: &Workspace) -> Result<()> {
    let sources = ["pyproject.toml", "Cargo.toml", "Cargo.lock", "plants/Cargo.toml", "plants/src"];
    let toolchain = process::text(Command::new("rustc").arg("--version"))?;
    let wanted = fingerprint::of(&workspace.root, &sources, &[&toolchain])?;
    let stamp = Stamp(workspace.path(".venv/.native"));
    if stamp.holds(&wanted) && built_module(workspace)?.is_some() {
        process::up_to_date("native module of the plants");
        return Ok(());
    }
    let mut pip = workspace.venv_command("python");
    pip.args(["-m", "pip", "install", "--quiet", "--disable-pip-version-check"]);
    pip.args(["--no-deps", "--no-build-isolation", "--editable", "."]);
    process::run("build the native module of the plants", &mut pip)?;
    ensure!(built_module(workspace)?.is_some(), "the build left no module `plants/_native`");
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

fn built_module(workspace: &Workspace) -> Result<Option<PathBuf>> {
    let folder = workspace.path("plants");
    for entry in fs::read_dir(&folder).with_context(|| format!("cannot list `{}`", folder.display()))? {
        let path = entry?.path();
        let name = path.file_name().unwrap_or_default().to_string_lossy().into_owned();
        if name.starts_with("_native.") && (name.ends_with(".so") || name.ends_with(".pyd")) {
            return Ok(Some(path));
        }
    }
    Ok(None)
}

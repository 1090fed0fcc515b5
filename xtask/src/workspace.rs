//! Where things are: the checkout, its packages, its virtual environment.

use std::ffi::OsString;
use std::fs;
use std::ops::Deref;
use std::path::PathBuf;
use std::process::Command;

use anyhow::{Context, Result};
use cargo_fmu::linker::Linker;
use cargo_fmu::project::Project;
use cargo_metadata::MetadataCommand;

/// The checkout this command works on: a cargo project, and its virtual environment.
pub struct Workspace(Project);

impl Workspace {
    /// Reads the workspace that the current folder lies in.
    ///
    /// # Errors
    /// When `cargo metadata` fails, for example because a `Cargo.toml` is broken.
    pub fn load() -> Result<Self> {
        let mut workspace = Self(Project::load(&MetadataCommand::new())?);
        let environment = vec![
            // the environment's programs come first
            ("PATH", workspace.search_path()),
            ("VIRTUAL_ENV", workspace.path(".venv").into()),
            // empty: otherwise every process would compile all modules again
            ("PYTHONDONTWRITEBYTECODE", OsString::new()),
        ];
        workspace.0.environment = environment;
        workspace.0.arguments = vec!["--locked".into()];
        if cfg!(target_os = "linux") {
            // it comes with the environment
            workspace.0.linker = Linker::Zig;
        }
        Ok(workspace)
    }

    /// From now on everything is built in a folder of its own, by the programs in these folders and with more variables.
    pub fn build_with(&mut self, folder: &str, programs: &[PathBuf], variables: Vec<(&'static str, OsString)>) {
        let before = self.search_path();
        let folders = programs.iter().cloned().chain(std::env::split_paths(&before));
        let path = std::env::join_paths(folders).unwrap_or(before);
        self.0.environment.push(("PATH", path));
        self.0.environment.extend(variables);
        let target = self.path(folder);
        self.0.arguments.extend(["--target-dir".into(), target.into()]);
    }

    /// A program of the virtual environment.
    pub fn venv_program(&self, name: &str) -> PathBuf {
        self.venv_programs().join(format!("{name}{}", std::env::consts::EXE_SUFFIX))
    }

    /// A program of the virtual environment as a command, in the root of the checkout.
    pub fn venv_command(&self, name: &str) -> Command {
        self.command(self.venv_program(name))
    }

    /// Names of the closed loops, without variants.
    ///
    /// # Errors
    /// When the scenarios cannot be listed.
    pub fn loops(&self) -> Result<Vec<String>> {
        let folder = self.path("scenarios");
        let mut stems = Vec::new();
        for entry in fs::read_dir(&folder).with_context(|| format!("cannot list `{}`", folder.display()))? {
            let path = entry?.path();
            if path.extension().is_some_and(|extension| extension == "toml") {
                stems.push(path.file_stem().unwrap_or_default().to_string_lossy().into_owned());
            }
        }
        stems.sort();
        Ok(stems)
    }

    fn venv_programs(&self) -> PathBuf {
        self.path(".venv").join(if cfg!(windows) { "Scripts" } else { "bin" })
    }

    fn search_path(&self) -> OsString {
        let inherited = std::env::var_os("PATH").unwrap_or_default();
        let folders = std::iter::once(self.venv_programs()).chain(std::env::split_paths(&inherited));
        std::env::join_paths(folders).unwrap_or(inherited)
    }
}

impl Deref for Workspace {
    type Target = Project;

    fn deref(&self) -> &Project {
        &self.0
    }
}

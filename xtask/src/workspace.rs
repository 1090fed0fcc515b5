//! Where things are: the checkout, its packages, its virtual environment.

use std::ffi::OsString;
use std::path::{Path, PathBuf};
use std::process::Command;

use anyhow::{Context, Result};
use cargo_metadata::{Metadata, MetadataCommand};

/// The checkout this command works on.
pub struct Workspace {
    /// Root folder of the checkout.
    pub root: PathBuf,
    /// Packages, targets and dependency graph, as cargo sees them.
    pub metadata: Metadata,
}

impl Workspace {
    /// Reads the workspace that the current folder lies in.
    ///
    /// # Errors
    /// When `cargo metadata` fails, for example because a `Cargo.toml` is broken.
    pub fn load() -> Result<Self> {
        let metadata = MetadataCommand::new().exec().context("cannot read the workspace with `cargo metadata`")?;
        Ok(Self { root: metadata.workspace_root.clone().into_std_path_buf(), metadata })
    }

    /// A path inside the checkout.
    pub fn path(&self, relative: impl AsRef<Path>) -> PathBuf {
        self.root.join(relative)
    }

    /// A program of the virtual environment.
    pub fn venv_program(&self, name: &str) -> PathBuf {
        self.venv_programs().join(format!("{name}{}", std::env::consts::EXE_SUFFIX))
    }

    /// `cargo` with this subcommand, in the root of the checkout, with the environment's programs first on `PATH`.
    pub fn cargo(&self, subcommand: &str) -> Command {
        let mut command = self.command(std::env::var_os("CARGO").unwrap_or_else(|| "cargo".into()));
        command.arg(subcommand);
        command
    }

    /// A program of the virtual environment as a command, in the root of the checkout.
    pub fn venv_command(&self, name: &str) -> Command {
        self.command(self.venv_program(name))
    }

    fn command(&self, program: impl Into<OsString>) -> Command {
        let mut command = Command::new(program.into());
        command.current_dir(&self.root).env("PATH", self.search_path()).env("VIRTUAL_ENV", self.path(".venv"));
        command
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

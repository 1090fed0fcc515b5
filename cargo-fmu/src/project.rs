//! A cargo workspace: where it is, what it holds, and how `cargo` is run on it.

use std::ffi::OsString;
use std::path::{Path, PathBuf};
use std::process::Command;

use anyhow::{Context, Result};
use cargo_metadata::{Metadata, MetadataCommand, Package};

use crate::linker::Linker;

/// A cargo workspace and the way its libraries are built.
pub struct Project {
    /// Root folder of the workspace.
    pub root: PathBuf,
    /// Packages, targets and dependency graph, as cargo sees them.
    pub metadata: Metadata,
    /// Linker of the libraries.
    pub linker: Linker,
    /// More words for every build, such as `--locked`.
    pub arguments: Vec<OsString>,
    /// Variables of the environment for every command.
    pub environment: Vec<(&'static str, OsString)>,
}

impl Project {
    /// Reads the workspace that `command` finds; it is built with the system's linker by default.
    ///
    /// # Errors
    /// When `cargo metadata` fails, for example because a `Cargo.toml` is missing or broken.
    pub fn load(command: &MetadataCommand) -> Result<Self> {
        let metadata = command.exec().context("cannot read the project with `cargo metadata`")?;
        let root = metadata.workspace_root.clone().into_std_path_buf();
        Ok(Self { root, metadata, linker: Linker::System, arguments: Vec::new(), environment: Vec::new() })
    }

    /// A path inside the workspace.
    pub fn path(&self, relative: impl AsRef<Path>) -> PathBuf {
        self.root.join(relative)
    }

    /// A program as a command, in the root of the workspace.
    pub fn command(&self, program: impl Into<OsString>) -> Command {
        let mut command = Command::new(program.into());
        command.current_dir(&self.root).envs(self.environment.iter().map(|(name, value)| (name, value)));
        command
    }

    /// `cargo` with this subcommand, in the root of the workspace.
    pub fn cargo(&self, subcommand: &str) -> Command {
        let mut command = self.command(std::env::var_os("CARGO").unwrap_or_else(|| "cargo".into()));
        command.arg(subcommand);
        command
    }

    /// True for packages of this workspace; all others are dependencies.
    pub fn owns(&self, package: &Package) -> bool {
        self.metadata.workspace_members.contains(&package.id)
    }
}

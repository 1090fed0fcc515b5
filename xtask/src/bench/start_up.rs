//! Processor time of the start of the command line.

use anyhow::{Context, Result};
use serde::Deserialize;

use super::effort::Effort;
use super::statistics::Samples;
use crate::process;
use crate::workspace::Workspace;

/// Processor times, s; the commands take turns.
#[derive(Deserialize)]
pub struct StartUpCosts {
    /// `python -c pass`.
    pub nothing: Samples,
    /// `cosim --help`.
    pub help: Samples,
    /// `cosim list`.
    pub list: Samples,
}

/// Starts the commands several times.
///
/// # Errors
/// When one of them fails.
pub fn measure(workspace: &Workspace, effort: &Effort) -> Result<StartUpCosts> {
    process::header("measure the start of the command line");
    let mut command = workspace.venv_command("python");
    command.args(["xtask/bench/start_up.py", &effort.runs.to_string()]);
    serde_json::from_str(&process::text(&mut command)?).context("the start of the command line printed no times")
}

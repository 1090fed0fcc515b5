//! Cost of the isolation of `cosim run`, which works in a supervised process of its own.

use anyhow::{Context, Result};
use serde::Deserialize;

use super::effort::Effort;
use super::statistics::Samples;
use crate::process;
use crate::workspace::Workspace;

/// Wall times of a command that simulates next to nothing, s; both kinds take turns.
#[derive(Deserialize)]
pub struct IsolationCosts {
    /// In a supervised process of its own.
    pub isolated: Samples,
    /// With `--in-process`.
    pub in_process: Samples,
}

/// Runs the command several times, isolated and not.
///
/// # Errors
/// When it does not run.
pub fn measure(workspace: &Workspace, effort: &Effort) -> Result<IsolationCosts> {
    process::header("measure the isolation of a run");
    let mut command = workspace.venv_command("python");
    command.args(["xtask/bench/isolation.py", &effort.runs.to_string()]);
    serde_json::from_str(&process::text(&mut command)?).context("the isolated runs printed no times")
}

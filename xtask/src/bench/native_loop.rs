//! How fast the native engine runs a scenario, against its plant alone.

use anyhow::{Context, Result};
use serde::Deserialize;

use super::effort::Effort;
use super::statistics::Samples;
use crate::process;
use crate::workspace::Workspace;

/// What the runs took; times are us of CPU per communication step, and the two take turns.
#[derive(Deserialize)]
pub struct NativeLoopCosts {
    /// The closed loop with its trace.
    pub native: Samples,
    /// The plant with its elements and the commands of that loop.
    pub plant: Samples,
    /// Simulated time over wall time, set-up of the run included.
    pub real_time_factor: Samples,
}

/// Runs a closed loop and its plant several times.
///
/// # Errors
/// When the loop does not run.
pub fn measure(workspace: &Workspace, scenario: &str, effort: &Effort) -> Result<NativeLoopCosts> {
    process::header(&format!("measure `{scenario}` with the native engine"));
    let mut command = workspace.venv_command("python");
    command.args(["xtask/bench/native_loop.py", scenario, &effort.runs.to_string(), &effort.steps.to_string()]);
    serde_json::from_str(&process::text(&mut command)?).context("the native loop printed no times")
}

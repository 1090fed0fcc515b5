//! How fast the reference loop runs a scenario, and where its time goes.

use anyhow::{Context, Result};
use serde::Deserialize;

use super::effort::Effort;
use super::statistics::Samples;
use crate::process;
use crate::workspace::Workspace;

/// What the runs took; times are us per communication step, the parts are of other runs than the real-time factor.
#[derive(Deserialize)]
pub struct ReferenceLoopCosts {
    /// Simulated time over wall time; the smallest run is the slowest one.
    pub real_time_factor: Samples,
    /// The whole step.
    pub step: Samples,
    /// Set, doStep and get through FMPy.
    pub fmu: Samples,
    /// Sensors, commands and MuJoCo's steps.
    pub plant: Samples,
    /// Wiring, noise, trace.
    pub rest: Samples,
}

/// Runs a controller against its plant several times.
///
/// # Errors
/// When the loop does not run.
pub fn measure(workspace: &Workspace, scenario: &str, effort: &Effort) -> Result<ReferenceLoopCosts> {
    process::header(&format!("measure `{scenario}`"));
    let mut command = workspace.venv_command("python");
    command.args(["xtask/bench/reference_loop.py", scenario, &effort.runs.to_string(), &effort.steps.to_string()]);
    serde_json::from_str(&process::text(&mut command)?).context("the reference loop printed no times")
}

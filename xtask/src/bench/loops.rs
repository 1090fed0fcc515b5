//! How fast the two engines run a scenario, and where the time goes.

use anyhow::{Context, Result};
use serde::Deserialize;
use serde::de::DeserializeOwned;

use super::effort::Effort;
use super::statistics::Samples;
use crate::process;
use crate::workspace::Workspace;

/// CPU times of the kinds of run, which alternate, us per communication step; and the real-time factor of other runs.
#[derive(Deserialize)]
pub struct NativeLoopCosts {
    /// The closed loop with its trace.
    pub native: Samples,
    /// The plant with its elements and the FMU's own calls, with the commands and inputs of that loop.
    pub served: Samples,
    /// The plant with its elements and the commands of that loop.
    pub plant: Samples,
    /// MuJoCo's steps of the same model from the states of that loop, and nothing else.
    pub bare: Samples,
    /// Simulated time over wall time, set-up of the run included.
    pub real_time_factor: Samples,
}

/// Wall times of a step and its parts, us per communication step; the real-time factor is that of other runs.
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

/// Runs a closed loop and its plant several times with the native engine.
///
/// # Errors
/// When the loop does not run.
pub fn native(workspace: &Workspace, scenario: &str, effort: &Effort) -> Result<NativeLoopCosts> {
    process::header(&format!("measure `{scenario}` with the native engine"));
    costs(workspace, "native", scenario, effort)
}

/// Runs a controller against its plant several times.
///
/// # Errors
/// When the loop does not run.
pub fn reference(workspace: &Workspace, scenario: &str, effort: &Effort) -> Result<ReferenceLoopCosts> {
    process::header(&format!("measure `{scenario}`"));
    costs(workspace, "reference", scenario, effort)
}

/// Runs the script of the `name` loop for a scenario and parses its output.
fn costs<T: DeserializeOwned>(workspace: &Workspace, name: &str, scenario: &str, effort: &Effort) -> Result<T> {
    let mut command = workspace.venv_command("python");
    let script = format!("xtask/bench/{name}_loop.py");
    command.args([&script, scenario, &effort.runs.to_string(), &effort.steps.to_string()]);
    serde_json::from_str(&process::text(&mut command)?).with_context(|| format!("the {name} loop printed no times"))
}

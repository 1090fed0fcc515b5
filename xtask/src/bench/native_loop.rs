//! How fast the native engine runs a scenario, against its plant alone.

use anyhow::{Context, Result};
use serde::Deserialize;

use super::statistics::Samples;
use crate::process;
use crate::workspace::Workspace;

const REPEATS: &str = "9";
/// Steps of one run; more would not change the cost of a step.
const LONGEST: &str = "10000";

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

impl NativeLoopCosts {
    /// Closed loop over plant alone, from each pair of runs.
    pub fn ratio(&self) -> Samples {
        Samples(self.native.0.iter().zip(&self.plant.0).map(|(native, plant)| native / plant).collect())
    }
}

/// Runs a closed loop and its plant several times.
///
/// # Errors
/// When the loop does not run.
pub fn measure(workspace: &Workspace, scenario: &str) -> Result<NativeLoopCosts> {
    process::header(&format!("measure `{scenario}` with the native engine"));
    let mut command = workspace.venv_command("python");
    command.args(["xtask/bench/native_loop.py", scenario, REPEATS, LONGEST]);
    serde_json::from_str(&process::text(&mut command)?).context("the native loop printed no times")
}

//! How fast the reference loop runs a scenario, where its time goes, and what the controller read meanwhile.

use anyhow::{Context, Result};
use serde::Deserialize;

use super::statistics::Samples;
use super::tick::Recording;
use crate::process;
use crate::workspace::Workspace;

const REPEATS: &str = "5";

/// What the runs took; times are us per communication step.
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
    /// The last run as the FMU saw it.
    pub recording: Recording,
}

impl ReferenceLoopCosts {
    /// What is left of a step: wiring, noise, trace.
    pub fn rest(&self) -> Samples {
        let parts = self.step.0.iter().zip(&self.fmu.0).zip(&self.plant.0);
        Samples(parts.map(|((step, fmu), plant)| step - fmu - plant).collect())
    }
}

/// Runs a controller against its plant several times.
///
/// # Errors
/// When the loop does not run.
pub fn measure(workspace: &Workspace, scenario: &str) -> Result<ReferenceLoopCosts> {
    process::header(&format!("measure `{scenario}`"));
    let mut command = workspace.venv_command("python");
    command.args(["xtask/bench/reference_loop.py", scenario, REPEATS]);
    serde_json::from_str(&process::text(&mut command)?).context("the reference loop printed no times")
}

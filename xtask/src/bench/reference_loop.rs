//! How fast the reference loop runs, and where its time goes.

use anyhow::{Context, Result};
use serde::Deserialize;

use super::statistics::Samples;
use crate::process;
use crate::workspace::Workspace;

const SCENARIO: &str = "dob";
const REPEATS: &str = "5";

/// What the runs took; times are us per communication step.
#[derive(Deserialize)]
pub struct Costs {
    /// Simulated time over wall time; the smallest run is the slowest one.
    pub real_time_factor: Samples,
    /// The whole step.
    pub step: Samples,
    /// Set, doStep and get through FMPy.
    pub fmu: Samples,
    /// Sensors, commands and MuJoCo's steps.
    pub plant: Samples,
}

impl Costs {
    /// What is left of a step: wiring, noise, trace.
    pub fn rest(&self) -> Samples {
        let parts = self.step.0.iter().zip(&self.fmu.0).zip(&self.plant.0);
        Samples(parts.map(|((step, fmu), plant)| step - fmu - plant).collect())
    }
}

/// Runs the contact detection against its plant several times.
///
/// # Errors
/// When the loop does not run.
pub fn measure(workspace: &Workspace) -> Result<Costs> {
    process::header(&format!("measure the reference loop `{SCENARIO}`"));
    let mut command = workspace.venv_command("python");
    command.args(["xtask/bench/reference_loop.py", SCENARIO, REPEATS]);
    serde_json::from_str(&process::text(&mut command)?).context("the reference loop printed no times")
}

//! Efficiency of a sweep on two cores, and growth of its memory with the number of runs.

use anyhow::{Context, Result};
use serde::Deserialize;

use super::effort::Effort;
use crate::process;
use crate::workspace::Workspace;

/// Rates, processor time and memory of a sweep on two workers.
#[derive(Deserialize)]
pub struct SweepCosts {
    /// Runs per second over twice those of one core that does only the runs.
    pub throughput: f64,
    /// Runs per second.
    pub rate: f64,
    /// Runs per second over those of two cores that do only the runs in parallel.
    pub beside: f64,
    /// Processor time of all processes for a run over that of such a core.
    pub processor: f64,
    /// Largest resident memory of all processes together, MB.
    pub memory: f64,
    /// The same over that of a sweep of a fifth of the runs.
    pub growth: f64,
}

/// Runs two sweeps, one of them five times as large.
///
/// # Errors
/// When a sweep does not run.
pub fn measure(workspace: &Workspace, effort: &Effort) -> Result<SweepCosts> {
    process::header(&format!("measure a sweep of {} runs", effort.sweep));
    let mut command = workspace.venv_command("python");
    command.args(["xtask/bench/sweep.py", "all", &effort.sweep.to_string()]);
    serde_json::from_str(&process::text(&mut command)?).context("the sweep printed no numbers")
}

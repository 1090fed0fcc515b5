//! Time and memory for planning a large study, before its first run.

use anyhow::{Context, Result};
use serde::Deserialize;

use super::effort::Effort;
use crate::process;
use crate::workspace::Workspace;

/// Time and memory for planning the study.
#[derive(Deserialize)]
pub struct PlanningCosts {
    /// Wall time, s.
    pub time: f64,
    /// Largest resident memory of the process, MB.
    pub memory: f64,
}

/// Plans a study.
///
/// # Errors
/// When it cannot be planned.
pub fn measure(workspace: &Workspace, effort: &Effort) -> Result<PlanningCosts> {
    process::header(&format!("plan a study of {} runs", effort.planned));
    let mut command = workspace.venv_command("python");
    command.args(["xtask/bench/planning.py", &effort.planned.to_string()]);
    serde_json::from_str(&process::text(&mut command)?).context("the plan printed no numbers")
}

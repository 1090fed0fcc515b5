//! Recorded inputs of an FMU in a run of its closed loop, and their replay without the loop.

use std::collections::BTreeMap;
use std::ops::Range;
use std::path::PathBuf;

use anyhow::{Context, Result};
use serde::Deserialize;

use super::effort::Effort;
use super::library::Fmu;
use super::slave::{Slave, Value, Variable};
use crate::process;
use crate::workspace::Workspace;

/// Minimum and maximum number of rows of one replay.
const ROWS: [usize; 2] = [10, 2_000];

/// A run as the FMU saw it, row by row.
#[derive(Deserialize)]
pub struct Recording {
    library: PathBuf,
    guid: String,
    /// URI of the folder of resources.
    resources: String,
    /// Communication step, s.
    pub step: f64,
    /// Start values of parameters.
    pub start: Vec<(Variable, Value)>,
    /// Real inputs, set in every step, with a value for each.
    inputs: Vec<u32>,
    rows: Vec<Vec<f64>>,
    /// Inputs of other types, set when they change, with a value for each.
    switches: Vec<Variable>,
    switched: Vec<Vec<f64>>,
    /// Real outputs that are wired to the plant.
    pub outputs: Vec<u32>,
    /// Value reference of the state of the controller.
    pub state: u32,
    states: BTreeMap<String, i32>,
    /// The state after every row.
    pub visited: Vec<i32>,
}

/// Runs a scenario and keeps what its FMU read.
///
/// # Errors
/// When the loop does not run.
pub fn record(workspace: &Workspace, scenario: &str, effort: &Effort) -> Result<Recording> {
    process::header(&format!("record `{scenario}`"));
    let mut command = workspace.venv_command("python");
    command.args(["xtask/bench/record.py", scenario, &effort.recorded.to_string()]);
    serde_json::from_str(&process::text(&mut command)?).context("the recording is not readable")
}

impl Recording {
    /// Loads the FMU.
    ///
    /// # Errors
    /// When its library does not load.
    pub fn load(&self) -> Result<Fmu> {
        Fmu::load(&self.library, &self.guid, Some(&self.resources))
    }

    /// Number of rows.
    pub fn count(&self) -> usize {
        self.rows.len()
    }

    /// For every state the longest stay in it in which nothing is switched, or the first part of that; none for states
    /// that are only passed through.
    pub fn windows(&self) -> Vec<(String, Range<usize>)> {
        let mut longest: BTreeMap<i32, Range<usize>> = BTreeMap::new();
        let mut start = 0;
        for row in 1..=self.visited.len() {
            let goes_on = row < self.visited.len()
                && self.visited[row] == self.visited[start]
                && self.switched[row] == self.switched[start];
            if !goes_on {
                let known = longest.entry(self.visited[start]).or_insert(start..start);
                if row - start > known.len() {
                    *known = start..row.min(start + ROWS[1]);
                }
                start = row;
            }
        }
        let name = |number| self.states.iter().find(|(_, item)| **item == number).map(|(name, _)| name.clone());
        longest
            .into_iter()
            .filter(|(_, rows)| rows.len() >= ROWS[0])
            .map(|(number, rows)| (name(number).unwrap_or_else(|| number.to_string()), rows))
            .collect()
    }

    /// Sets what is switched in this row.
    ///
    /// # Errors
    /// When the FMU rejects a call.
    pub fn switch(&self, slave: &Slave, row: usize) -> Result<()> {
        for (i, variable) in self.switches.iter().enumerate() {
            if row == 0 || self.switched[row][i] != self.switched[row - 1][i] {
                slave.set(*variable, self.switched[row][i])?;
            }
        }
        Ok(())
    }

    /// Steps through some rows; the worst status.
    pub fn replay(&self, slave: &Slave, rows: Range<usize>, outputs: &mut [f64]) -> i32 {
        self.rows[rows.clone()]
            .iter()
            .zip(rows)
            .map(|(row, k)| slave.step((&self.inputs, row), k as f64 * self.step, self.step, (&self.outputs, outputs)))
            .max()
            .unwrap_or(0)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::bench::slave::Base;

    fn recording(visited: &[i32], switched: &[f64]) -> Recording {
        Recording {
            library: PathBuf::new(),
            guid: String::new(),
            resources: String::new(),
            step: 1e-3,
            start: Vec::new(),
            inputs: Vec::new(),
            rows: vec![Vec::new(); visited.len()],
            switches: Vec::new(),
            switched: switched.iter().map(|value| vec![*value]).collect(),
            outputs: Vec::new(),
            state: 0,
            states: [("Idle".to_owned(), 1), ("Busy".to_owned(), 2)].into(),
            visited: visited.to_vec(),
        }
    }

    #[test]
    fn every_state_has_its_longest_stay_without_a_switch() {
        let states = [vec![1; 12], vec![2; 20], vec![1; 11], vec![2; 30]].concat();
        let switched: Vec<f64> = (0..states.len()).map(|row| if row < 48 { 0.0 } else { 1.0 }).collect();
        assert_eq!(recording(&states, &switched).windows(), [("Idle".to_owned(), 0..12), ("Busy".to_owned(), 48..73)]);
    }

    #[test]
    fn a_state_that_is_only_passed_through_has_none() {
        let states = [vec![1; 9], vec![2; 10]].concat();
        assert_eq!(recording(&states, &[0.0; 19]).windows(), [("Busy".to_owned(), 9..19)]);
    }

    #[test]
    fn a_long_stay_is_cut() {
        let recording = recording(&vec![2; 3 * ROWS[1]], &vec![0.0; 3 * ROWS[1]]);
        assert_eq!(recording.windows(), [("Busy".to_owned(), 0..ROWS[1])]);
    }

    #[test]
    fn start_values_are_numbers_or_texts() {
        let json = r#"[[{"reference": 1, "base": "Real"}, 0.5], [{"reference": 2, "base": "String"}, "bank.bin"]]"#;
        let start: Vec<(Variable, Value)> = serde_json::from_str(json).unwrap();
        assert!(matches!(start[0], (Variable { reference: 1, base: Base::Real }, Value::Number(0.5))));
        assert!(matches!(&start[1], (_, Value::Text(text)) if text == "bank.bin"));
    }
}

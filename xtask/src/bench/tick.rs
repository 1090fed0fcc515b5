//! What one sample of a controller costs in its busiest state.
//!
//! What the FMU read in a run of its closed loop is replayed from saved states, so that every repeat does the same
//! arithmetic and nothing but the FMU is timed.

use std::collections::BTreeMap;
use std::ops::Range;
use std::path::PathBuf;
use std::time::Instant;

use anyhow::{Context, Result, ensure};
use serde::Deserialize;

use super::slave::{Slave, Snapshot, Variable};
use super::statistics::Samples;

const MOST_ROWS: usize = 2_000;
const REPEATS: usize = 300;

/// What an FMU read in a run of its closed loop, row by row.
#[derive(Deserialize)]
pub struct Recording {
    library: PathBuf,
    guid: String,
    /// Communication step, s.
    step: f64,
    start: Vec<(Variable, f64)>,
    /// Real inputs, set in every step, with a value for each.
    inputs: Vec<u32>,
    rows: Vec<Vec<f64>>,
    /// Inputs of other types, set when they change, with a value for each.
    switches: Vec<Variable>,
    switched: Vec<Vec<f64>>,
    /// Real outputs that are wired to the plant.
    outputs: Vec<u32>,
    state: u32,
    states: BTreeMap<String, i32>,
    /// The state after every row.
    visited: Vec<i32>,
}

/// Cost of one set + doStep + get in the state where it is largest, in ns, and the name of that state.
///
/// # Errors
/// When the FMU refuses a call or does not go through the recorded states.
pub fn measure(recording: &Recording) -> Result<(String, Samples)> {
    let slave = Slave::start(&recording.library, &recording.guid, &recording.start)?;
    let mut windows: Vec<(String, Range<usize>, Option<Snapshot>)> =
        recording.windows().into_iter().map(|(state, rows)| (state, rows, None)).collect();
    let mut outputs = vec![0.0; recording.outputs.len()];
    for row in 0..recording.rows.len() {
        recording.switch(&slave, row)?;
        for (_, rows, snapshot) in &mut windows {
            if rows.start == row {
                *snapshot = Some(slave.snapshot()?);
            }
        }
        ensure!(recording.replay(&slave, row..row + 1, &mut outputs) == 0, "a call of the FMU failed");
        let (found, seen) = (slave.integer(recording.state)?, recording.visited[row]);
        ensure!(found == seen, "the FMU is in state {found} after row {row}, the recording in {seen}");
    }
    let mut busiest: Option<(String, Samples)> = None;
    for (state, rows, snapshot) in windows {
        let samples = recording.time(&slave, rows, &snapshot.context("a window outside the recording")?)?;
        if busiest.as_ref().is_none_or(|(_, most)| samples.minimum() > most.minimum()) {
            busiest = Some((state, samples));
        }
    }
    busiest.context("the recording has no rows")
}

impl Recording {
    /// For every state the longest stay in it in which nothing is switched, or the first part of that.
    fn windows(&self) -> Vec<(String, Range<usize>)> {
        let mut longest: BTreeMap<i32, Range<usize>> = BTreeMap::new();
        let mut start = 0;
        for row in 1..=self.visited.len() {
            let goes_on = row < self.visited.len()
                && self.visited[row] == self.visited[start]
                && self.switched[row] == self.switched[start];
            if !goes_on {
                let known = longest.entry(self.visited[start]).or_insert(start..start);
                if row - start > known.len() {
                    *known = start..row.min(start + MOST_ROWS);
                }
                start = row;
            }
        }
        let name = |number| self.states.iter().find(|(_, item)| **item == number).map(|(name, _)| name.clone());
        longest.into_iter().map(|(number, rows)| (name(number).unwrap_or_else(|| number.to_string()), rows)).collect()
    }

    fn switch(&self, slave: &Slave, row: usize) -> Result<()> {
        for (i, variable) in self.switches.iter().enumerate() {
            if row == 0 || self.switched[row][i] != self.switched[row - 1][i] {
                slave.set(*variable, self.switched[row][i])?;
            }
        }
        Ok(())
    }

    /// Sum of the statuses, 0 when all went well.
    fn replay(&self, slave: &Slave, rows: Range<usize>, outputs: &mut [f64]) -> i32 {
        self.rows[rows.clone()]
            .iter()
            .zip(rows)
            .map(|(row, k)| slave.step((&self.inputs, row), k as f64 * self.step, self.step, (&self.outputs, outputs)))
            .sum()
    }

    fn time(&self, slave: &Slave, rows: Range<usize>, snapshot: &Snapshot) -> Result<Samples> {
        let (mut samples, mut outputs) = (Vec::new(), vec![0.0; self.outputs.len()]);
        for _ in 0..REPEATS {
            snapshot.restore()?;
            // what looking at the clock costs does not count: some states last for one sample
            let clock = Instant::now();
            let start = Instant::now();
            let faults = self.replay(slave, rows.clone(), &mut outputs);
            let spent = start.elapsed().saturating_sub(start - clock);
            samples.push(spent.as_secs_f64() * 1e9 / rows.len() as f64);
            ensure!(faults == 0, "a call of the FMU failed");
        }
        let end = slave.integer(self.state)?;
        ensure!(end == self.visited[rows.end - 1], "the replay ends in state {end}");
        Ok(Samples(samples))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn recording(visited: &[i32], switched: &[f64]) -> Recording {
        Recording {
            library: PathBuf::new(),
            guid: String::new(),
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
        let recording = recording(&[1, 2, 2, 1, 2, 2, 2, 2], &[0.0, 0.0, 0.0, 0.0, 0.0, 1.0, 1.0, 1.0]);
        assert_eq!(recording.windows(), [("Idle".to_owned(), 0..1), ("Busy".to_owned(), 5..8)]);
    }

    #[test]
    fn a_long_stay_is_cut() {
        let recording = recording(&vec![2; 3 * MOST_ROWS], &vec![0.0; 3 * MOST_ROWS]);
        assert_eq!(recording.windows(), [("Busy".to_owned(), 0..MOST_ROWS)]);
    }
}

//! Cost of one sample of a controller in its busiest state, and of its slowest sample.
//!
//! The recorded inputs of the FMU are replayed from its saved states, so that every repeat does the same arithmetic.
//! Only the FMU is timed.

use std::ops::Range;
use std::time::Instant;

use anyhow::{Context, Result, ensure};

use super::effort::Effort;
use super::library::Fmu;
use super::recording::Recording;
use super::slave::{Slave, Snapshot, went_well};
use super::statistics::{Samples, Summary};
use super::yardstick::{PORTS, Runner};

/// The whole recording is replayed at most so often.
const MOST_REPLAYS: usize = 9;

/// Costs of one set + doStep + get, in ns.
pub struct TickCosts {
    /// Name of the state in which a sample costs most.
    pub state: String,
    /// Mean of a sample there.
    pub sample: Summary,
    /// The same calls of the checked C FMU, in turns.
    pub checked_c: Summary,
    /// The slowest sample of the run.
    pub slowest: Summary,
}

/// Measures an FMU in all states that it goes through.
///
/// # Errors
/// When the FMU rejects a call or does not reach the recorded states.
pub fn measure(recording: &Recording, checked: &Fmu, effort: &Effort) -> Result<TickCosts> {
    let fmu = recording.load()?;
    let slave = Slave::start(&fmu, &recording.start)?;
    let slowest = slowest(recording, &slave, effort)?;
    let mut yardstick = Runner::start(checked, PORTS)?;
    let mut busiest: Option<TickCosts> = None;
    for (state, rows, snapshot) in windows(recording, &slave)? {
        let window = Window { recording, slave: &slave, rows, snapshot };
        let (sample, checked_c) = window.time(&mut yardstick, effort)?;
        if busiest.as_ref().is_none_or(|most| sample.minimum > most.sample.minimum) {
            busiest = Some(TickCosts { state, sample, checked_c, slowest });
        }
    }
    busiest.context("no state of the recording lasts")
}

/// Goes through the recording and keeps the FMU's state before every window.
fn windows<'a>(recording: &Recording, slave: &'a Slave) -> Result<Vec<(String, Range<usize>, Snapshot<'a>)>> {
    let start = slave.snapshot()?;
    let (mut open, mut kept) = (recording.windows(), Vec::new());
    let mut outputs = vec![0.0; recording.outputs.len()];
    for row in 0..recording.count() {
        recording.switch(slave, row)?;
        for (state, rows) in open.extract_if(.., |(_, rows)| rows.start == row) {
            kept.push((state, rows, slave.snapshot()?));
        }
        ensure!(went_well(recording.replay(slave, row..row + 1, &mut outputs)), "a call of the FMU failed");
        let (found, seen) = (slave.integer(recording.state)?, recording.visited[row]);
        ensure!(found == seen, "the FMU is in state {found} after row {row}, the recording in {seen}");
    }
    start.restore()?;
    Ok(kept)
}

/// The sample that costs most, and leaves the FMU where it was; of each sample minimum and median count.
fn slowest(recording: &Recording, slave: &Slave, effort: &Effort) -> Result<Summary> {
    let start = slave.snapshot()?;
    let mut costs = vec![Samples::default(); recording.count()];
    let mut outputs = vec![0.0; recording.outputs.len()];
    for _ in 0..effort.repeats.min(MOST_REPLAYS) {
        start.restore()?;
        for (row, samples) in costs.iter_mut().enumerate() {
            recording.switch(slave, row)?;
            samples.0.push(timed(|| recording.replay(slave, row..row + 1, &mut outputs))?);
        }
    }
    start.restore()?;
    let costs = costs.iter().map(Samples::summary);
    Ok(costs.fold(Summary::once(0.0), |most, cost| Summary {
        minimum: most.minimum.max(cost.minimum),
        median: most.median.max(cost.median),
    }))
}

/// Time (ns) of calls that all have to go well.
fn timed(calls: impl FnOnce() -> i32) -> Result<f64> {
    // without the cost of reading the clock
    let clock = Instant::now();
    let start = Instant::now();
    let worst = calls();
    let spent = start.elapsed().saturating_sub(start - clock);
    ensure!(went_well(worst), "a call of the FMU failed");
    Ok(spent.as_secs_f64() * 1e9)
}

/// A stay in a state.
struct Window<'a> {
    recording: &'a Recording,
    slave: &'a Slave<'a>,
    rows: Range<usize>,
    snapshot: Snapshot<'a>,
}

impl Window<'_> {
    /// Costs of a sample here and of one of the yardstick, in turns.
    fn time(&self, yardstick: &mut Runner, effort: &Effort) -> Result<(Summary, Summary)> {
        let (mut own, mut base) = (Samples::default(), Samples::default());
        let mut outputs = vec![0.0; self.recording.outputs.len()];
        for _ in 0..effort.repeats {
            self.snapshot.restore()?;
            let spent = timed(|| self.recording.replay(self.slave, self.rows.clone(), &mut outputs))?;
            own.0.push(spent / self.rows.len() as f64);
            base.0.push(yardstick.cost(effort.calls)?);
        }
        let (found, seen) = (self.slave.integer(self.recording.state)?, self.recording.visited[self.rows.end - 1]);
        ensure!(found == seen, "the replay ends in state {found}, the recording in {seen}");
        Ok((own.summary(), base.summary()))
    }
}

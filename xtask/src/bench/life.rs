//! Times of an instance: exit of the initialization, whole life cycle, saving and restoring its state.

use std::time::Instant;

use anyhow::{Result, ensure};

use super::effort::Effort;
use super::library::Fmu;
use super::recording::Recording;
use super::slave::{Slave, Snapshot, Value, Variable, went_well};
use super::statistics::{Samples, Summary};
use super::yardstick::{PORTS, Runner};

/// An instance is made at most so often.
const MOST_LIVES: usize = 100;
/// One call of the yardstick is shorter than the resolution of the clock.
const CALLS: u32 = 1000;

/// Times in us; `checked_c` is the same of the C FMU with the checks of FMI 2.0, in turns.
pub struct LifeCosts {
    /// `fmi2ExitInitializationMode`.
    pub exit: Summary,
    /// From instantiate to free, without a step.
    pub life: Pair,
    /// Save the state in place of the one before, and restore it.
    pub state: Pair,
}

/// A controller and its yardstick.
pub struct Pair {
    /// The controller.
    pub own: Summary,
    /// The C FMU with the checks of FMI 2.0.
    pub checked_c: Summary,
}

/// Measures the FMU of a recording.
///
/// # Errors
/// When a call fails.
pub fn measure(recording: &Recording, checked: &Fmu, effort: &Effort) -> Result<LifeCosts> {
    let fmu = recording.load()?;
    let (mut exits, mut lives, mut yardsticks) = (Samples::default(), Samples::default(), Samples::default());
    for _ in 0..effort.repeats.min(MOST_LIVES) {
        let (exit, life) = life(&fmu, &recording.start)?;
        exits.0.push(exit);
        lives.0.push(life);
        yardsticks.0.push(mean(CALLS, || life_of(checked))?);
    }
    let life = Pair { own: lives.summary(), checked_c: yardsticks.summary() };
    Ok(LifeCosts { exit: exits.summary(), life, state: state(recording, &fmu, checked, effort)? })
}

/// Times (us) of the exit of the initialization mode and of the whole life cycle.
fn life(fmu: &Fmu, values: &[(Variable, Value)]) -> Result<(f64, f64)> {
    let start = Instant::now();
    let slave = Slave::new(fmu)?;
    slave.enter_initialization(values)?;
    let entered = Instant::now();
    slave.exit_initialization()?;
    let exit = entered.elapsed();
    slave.terminate()?;
    drop(slave);
    Ok((exit.as_secs_f64() * 1e6, start.elapsed().as_secs_f64() * 1e6))
}

fn life_of(fmu: &Fmu) -> Result<()> {
    Slave::start(fmu, &[])?.terminate()
}

/// Times of save and restore after half of the run.
fn state(recording: &Recording, fmu: &Fmu, checked: &Fmu, effort: &Effort) -> Result<Pair> {
    let (slave, mut outputs) = (Slave::start(fmu, &recording.start)?, vec![0.0; recording.outputs.len()]);
    for row in 0..recording.count() / 2 {
        recording.switch(&slave, row)?;
        ensure!(went_well(recording.replay(&slave, row..row + 1, &mut outputs)), "a call of the FMU failed");
    }
    let runner = Runner::start(checked, PORTS)?;
    let (mut snapshot, mut yardstick) = (slave.snapshot()?, runner.snapshot()?);
    let (mut own, mut checked_c) = (Samples::default(), Samples::default());
    for _ in 0..effort.repeats {
        own.0.push(mean(1, || round_trip(&mut snapshot))?);
        checked_c.0.push(mean(CALLS, || round_trip(&mut yardstick))?);
    }
    Ok(Pair { own: own.summary(), checked_c: checked_c.summary() })
}

fn round_trip(snapshot: &mut Snapshot) -> Result<()> {
    snapshot.save()?;
    snapshot.restore()
}

/// Mean time (us) of a number of calls.
fn mean(count: u32, mut call: impl FnMut() -> Result<()>) -> Result<f64> {
    let start = Instant::now();
    for _ in 0..count {
        call()?;
    }
    Ok(start.elapsed().as_secs_f64() * 1e6 / f64::from(count))
}

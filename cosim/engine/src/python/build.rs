//! Conversion of the Python rows to the parts of a stepper.

use plants::Place;
use plants::python::Cell;
use pyo3::exceptions::PyValueError;
use pyo3::prelude::*;

use super::rows::{FaultEffectRow, FaultRow, LinkRow, LinksRow, LogRow, MachineRow, ShapeRow, StimulusRow, TriggerRow};
use crate::condition::{Condition, Operation};
use crate::fault::FaultEffect;
use crate::ffi::{Bank, Exports};
use crate::links::{Injection, Link, Links, Stimulus};
use crate::log::{Log, Trigger};
use crate::machine::Machine;
use crate::wire::{Delay, Shape};

/// All connections of a run.
pub fn links(exports: &mut Exports, row: LinksRow) -> PyResult<Links> {
    let mut links = |rows: Vec<LinkRow>| rows.into_iter().map(|row| link(exports, row)).collect::<PyResult<_>>();
    let (readings, outputs) = (links(row.readings)?, links(row.outputs)?);
    let mut faults = |rows: Vec<FaultRow>| rows.into_iter().map(|row| injection(exports, row)).collect::<PyResult<_>>();
    let (input_faults, command_faults) = (faults(row.input_faults)?, faults(row.command_faults)?);
    Ok(Links {
        sensed: exports.slots(&row.sensed)?,
        commands: exports.slots(&row.commands)?,
        readings,
        stimuli: row.stimuli.iter().map(|row| stimulus(exports, row)).collect::<PyResult<_>>()?,
        input_faults,
        outputs,
        command_faults,
    })
}

fn link(exports: &mut Exports, row: LinkRow) -> PyResult<Link> {
    let ShapeRow { from_plant, scale, offset, noise, quantum, minimum, maximum } = row.shape;
    Ok(Link {
        source: exports.slot(&row.source)?,
        target: exports.slot(&row.target)?,
        shape: Shape { from_plant, scale, offset, quantum, minimum, maximum },
        noise: noise.map(|samples| exports.series(&samples)).transpose()?,
        delay: Delay::new(row.delay.steps, row.delay.ring),
    })
}

fn stimulus(exports: &mut Exports, row: &StimulusRow) -> PyResult<Stimulus> {
    Ok(Stimulus { samples: exports.series(&row.samples)?, target: exports.slot(&row.target)? })
}

fn injection(exports: &mut Exports, row: FaultRow) -> PyResult<Injection> {
    let series = row.change.series.as_ref().map(|samples| exports.series(samples)).transpose()?;
    Ok(Injection {
        begin: exports.slot(&row.begin)?,
        length: row.length,
        change: change(row.change)?,
        series,
        target: exports.slot(&row.target)?,
    })
}

fn change(row: FaultEffectRow) -> PyResult<FaultEffect> {
    Ok(match row.kind.as_str() {
        "value" => FaultEffect::Value(row.number),
        "frozen" => FaultEffect::Frozen(0.0),
        "offset" => FaultEffect::Offset(row.number),
        "scale" => FaultEffect::Scale(row.number),
        "ramp" => FaultEffect::Ramp(row.number),
        "noise" => FaultEffect::Noise,
        "drop" => FaultEffect::Drop(0.0),
        "lose" => FaultEffect::Lose,
        "late" => FaultEffect::Late(Delay::new(row.delay.steps, row.delay.ring)),
        kind => return Err(PyValueError::new_err(format!("`{kind}` is no kind of injection"))),
    })
}

/// The trace of a run.
pub fn log(exports: &mut Exports, row: &LogRow, truths: usize) -> PyResult<Log> {
    let banks: Vec<Bank> = row.banks.iter().map(|array| exports.bank(array)).collect::<PyResult<_>>()?;
    let values: usize = banks.iter().map(Bank::count).sum();
    let table = exports.table(&row.table)?;
    if row.every == 0 || row.start + values + truths != table.columns() {
        return Err(PyValueError::new_err("the columns of the table do not fit"));
    }
    let stop = row.stop.as_ref().map(|program| condition(program, table.columns())).transpose()?;
    let mut triggers = Vec::with_capacity(row.triggers.len());
    for TriggerRow { program, delay, begin } in &row.triggers {
        let condition = condition(program, table.columns())?;
        triggers.push(Trigger { condition, delay: *delay, begin: exports.slot(begin)? });
    }
    Ok(Log { table, start: row.start, banks, every: row.every, stop, triggers })
}

/// A plant after its reset.
pub fn machine(exports: &mut Exports, row: &MachineRow, substeps: usize) -> PyResult<Machine> {
    let places = |cells: &[Py<Cell>]| cells.iter().map(|cell| cell.get().place()).collect::<Vec<Place>>();
    row.commands.iter().try_for_each(|cell| cell.get().check_writable())?;
    Ok(Machine {
        physics: exports.physics(row)?,
        timestep: row.timestep,
        substeps,
        readings: places(&row.readings),
        commands: places(&row.commands),
        truths: places(&row.truths),
    })
}

fn condition(program: &[(String, f64)], columns: usize) -> PyResult<Condition> {
    #[allow(clippy::cast_possible_truncation, clippy::cast_sign_loss)]
    let operation = |(name, value): &(String, f64)| match name.as_str() {
        "column" => Some(Operation::Column(*value as usize)),
        "number" => Some(Operation::Number(*value)),
        name => Operation::named(name),
    };
    let program = program.iter().map(operation).collect::<Option<_>>();
    let refused = || PyValueError::new_err("the condition is no program over the columns");
    program.and_then(|program| Condition::new(program, columns)).ok_or_else(refused)
}

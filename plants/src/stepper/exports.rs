//! From arrays and addresses of Python to those of the stepper.

use std::ffi::c_void;
use std::mem::transmute;
use std::ptr::NonNull;

use pyo3::buffer::{Element, PyBuffer};
use pyo3::exceptions::{PyRuntimeError, PyValueError};
use pyo3::prelude::*;

use super::condition::{Condition, Operation};
use super::controller::{Call, Controller, DoStep, Move};
use super::links::{Drive, Injection, Link, Links, Series};
use super::log::{Bank, Log};
use super::machine::{Half, Machine};
use super::rows::{
    CallRow, ControllerRow, DriveRow, FaultRow, LinkRow, LinksRow, LogRow, MachineRow, PlaceRow, ShapeRow,
};
use super::slot::Slot;
use super::trap::{Apply, DeleteBatch, ErrorText, Functions, MakeBatch, Trap};
use super::wire::{Delay, Shape};
use crate::binding::cells::Cell;
use crate::place::Place;

/// The arrays of a stepper, exported so that they neither move nor go away.
#[derive(Default)]
pub struct Exports(Vec<Box<dyn Send + Sync>>);

impl Exports {
    /// first item and number of items of an array
    fn array<T: Element + Send + Sync + 'static>(&mut self, array: &Bound<'_, PyAny>) -> PyResult<(NonNull<T>, usize)> {
        let buffer = PyBuffer::<T>::get(array)?;
        if !buffer.is_c_contiguous() || buffer.readonly() {
            return Err(PyValueError::new_err("the arrays of a stepper must be C-contiguous and writable"));
        }
        let first = NonNull::new(buffer.buf_ptr().cast::<T>());
        let found = (first.ok_or_else(|| PyValueError::new_err("an array without an address"))?, buffer.item_count());
        self.0.push(Box::new(buffer));
        Ok(found)
    }

    fn series(&mut self, array: &Bound<'_, PyAny>) -> PyResult<Series> {
        let (first, count) = self.array::<f64>(array)?;
        Ok(Series { first, count })
    }

    /// places of a whole array of numbers
    fn slots(&mut self, array: &Bound<'_, PyAny>) -> PyResult<Vec<Slot>> {
        let (first, count) = self.array::<f64>(array)?;
        // SAFETY: inside the array.
        Ok((0..count).map(|i| Slot::Real(unsafe { first.add(i) })).collect())
    }

    fn bank(&mut self, array: &Bound<'_, PyAny>) -> PyResult<Bank> {
        if let Ok((first, count)) = self.array::<f64>(array) {
            return Ok(Bank::Reals(first, count));
        }
        let (first, count) = self.array::<i32>(array)?;
        Ok(Bank::Integers(first, count))
    }

    fn slot(&mut self, row: &PlaceRow) -> PyResult<Slot> {
        let inside = |count| {
            let message = || PyValueError::new_err(format!("index `{}` of an array of `{count}`", row.index));
            if row.index < count { Ok(()) } else { Err(message()) }
        };
        if row.kind == "Real" {
            let (first, count) = self.array::<f64>(&row.array)?;
            inside(count)?;
            // SAFETY: inside the array.
            return Ok(Slot::Real(unsafe { first.add(row.index) }));
        }
        let (first, count) = self.array::<i32>(&row.array)?;
        inside(count)?;
        // SAFETY: inside the array.
        let place = unsafe { first.add(row.index) };
        Ok(if row.kind == "Boolean" { Slot::Boolean(place) } else { Slot::Integer(place) })
    }

    fn link(&mut self, row: LinkRow) -> PyResult<Link> {
        let ShapeRow { from_plant, scale, offset, noise, quantum, minimum, maximum } = row.shape;
        Ok(Link {
            source: self.slot(&row.source)?,
            target: self.slot(&row.target)?,
            shape: Shape { from_plant, scale, offset, quantum, minimum, maximum },
            noise: noise.map(|samples| self.series(&samples)).transpose()?,
            delay: Delay::new(row.delay.steps, row.delay.ring),
        })
    }

    fn drive(&mut self, row: &DriveRow) -> PyResult<Drive> {
        Ok(Drive { course: self.series(&row.course)?, target: self.slot(&row.target)? })
    }

    fn injection(&mut self, row: &FaultRow) -> PyResult<Injection> {
        Ok(Injection { begin: row.begin, end: row.end, value: row.value, target: self.slot(&row.target)? })
    }

    pub fn links(&mut self, row: LinksRow) -> PyResult<Links> {
        let mut links = |rows: Vec<LinkRow>| rows.into_iter().map(|row| self.link(row)).collect::<PyResult<_>>();
        let (readings, outputs) = (links(row.readings)?, links(row.outputs)?);
        let mut faults = |rows: &[FaultRow]| rows.iter().map(|row| self.injection(row)).collect::<PyResult<_>>();
        let (input_faults, command_faults) = (faults(&row.input_faults)?, faults(&row.command_faults)?);
        Ok(Links {
            sensed: self.slots(&row.sensed)?,
            commands: self.slots(&row.commands)?,
            readings,
            drives: row.drives.iter().map(|row| self.drive(row)).collect::<PyResult<_>>()?,
            input_faults,
            outputs,
            command_faults,
        })
    }

    pub fn log(&mut self, row: &LogRow, truths: usize) -> PyResult<Log> {
        let shape: (usize, usize) = row.table.getattr("shape")?.extract()?;
        let banks: Vec<Bank> = row.banks.iter().map(|array| self.bank(array)).collect::<PyResult<_>>()?;
        let values: usize = banks.iter().map(Bank::count).sum();
        if row.every == 0 || row.start + values + truths != shape.1 {
            return Err(PyValueError::new_err("the columns of the table do not fit"));
        }
        let stop = row.stop.as_ref().map(|program| condition(program, shape.1)).transpose()?;
        let (table, _) = self.array::<f64>(&row.table)?;
        Ok(Log { table, rows: shape.0, columns: shape.1, start: row.start, banks, every: row.every, stop })
    }

    pub fn controller(&mut self, row: &ControllerRow) -> PyResult<Controller> {
        let mut calls = |rows: &[CallRow]| rows.iter().map(|row| self.call(row)).collect::<PyResult<_>>();
        Ok(Controller {
            component: row.component as *mut c_void,
            set: calls(&row.set)?,
            get: calls(&row.get)?,
            // SAFETY: the caller of Python's constructor vouches for the address.
            step: unsafe { transmute::<usize, DoStep>(address(row.step)?) },
        })
    }

    fn call(&mut self, row: &CallRow) -> PyResult<Call> {
        let (references, count) = self.array::<u32>(&row.references)?;
        let bank = self.bank(&row.values)?;
        let values = match bank {
            Bank::Reals(first, _) => first.as_ptr().cast(),
            Bank::Integers(first, _) => first.as_ptr().cast(),
        };
        let there = bank.count();
        if there != count {
            return Err(PyValueError::new_err(format!("`{count}` references for `{there}` values")));
        }
        // SAFETY: the caller of Python's constructor vouches for the address.
        let function = unsafe { transmute::<usize, Move>(address(row.function)?) };
        Ok(Call { function, references: references.as_ptr(), count, values })
    }

    pub fn machine(&mut self, row: &MachineRow, substeps: usize) -> PyResult<Machine> {
        let buffer = PyBuffer::<i32>::get(&row.warnings)?;
        let stride = usize::try_from(buffer.strides()[0])?;
        let start = buffer.buf_ptr().cast::<u8>();
        // SAFETY: inside the array.
        let warnings = (0..buffer.item_count()).map(|i| unsafe { start.add(i * stride).cast_const().cast() }).collect();
        self.0.push(Box::new(buffer));
        let places = |cells: &[Py<Cell>]| cells.iter().map(|cell| cell.get().place).collect::<Vec<Place>>();
        row.commands.iter().try_for_each(|cell| cell.get().check_writable())?;
        let half = |number: usize| -> PyResult<Half> {
            // SAFETY: the caller of Python's constructor vouches for the addresses.
            Ok(unsafe { transmute::<usize, Half>(address(row.functions[number])?) })
        };
        Ok(Machine {
            first_half: half(0)?,
            second_half: half(1)?,
            model: address(row.model)? as *const c_void,
            data: address(row.data)? as *mut c_void,
            timestep: row.timestep,
            substeps,
            warnings,
            readings: places(&row.readings),
            commands: places(&row.commands),
            truths: places(&row.truths),
        })
    }
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

fn address(number: usize) -> PyResult<usize> {
    if number == 0 { Err(PyValueError::new_err("the address 0")) } else { Ok(number) }
}

/// Where errors of MuJoCo are caught.
pub fn trap(row: &MachineRow) -> PyResult<Trap> {
    let [_, _, make, delete, apply, error] = row.functions;
    for number in row.functions {
        address(number)?;
    }
    // SAFETY: the caller of Python's constructor vouches for the addresses.
    unsafe {
        let functions = Functions {
            make: transmute::<usize, MakeBatch>(make),
            delete: transmute::<usize, DeleteBatch>(delete),
            apply: transmute::<usize, Apply>(apply),
            error: transmute::<usize, ErrorText>(error),
        };
        Trap::new(functions, address(row.empty)? as *const c_void).map_err(PyRuntimeError::new_err)
    }
}

//! Conversion of Python arrays and addresses to values and functions.
//!
//! The caller of Python's constructor of the stepper guarantees valid bare addresses.

use std::ffi::c_void;
use std::mem::transmute;
use std::ptr::NonNull;

use pyo3::buffer::{Element, PyBuffer};
use pyo3::exceptions::{PyRuntimeError, PyValueError};
use pyo3::prelude::*;

use super::controller::{Call, Controller, DoStep, GetBooleanStatus, Move};
use super::physics::{Half, Physics};
use super::trap::{Apply, DeleteBatch, ErrorText, Functions, MakeBatch, Trap};
use super::values::{Bank, Series, Slot, Table};
use crate::python::rows::{CallRow, ControllerRow, MachineRow, PlaceRow};

/// The arrays of a stepper, exported so that they are neither moved nor freed.
#[derive(Default)]
pub struct Exports(Vec<Box<dyn Send + Sync>>);

impl Exports {
    /// First item and number of items of an array.
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

    /// Numbers, one per step.
    ///
    /// # Errors
    /// When the array is invalid.
    pub fn series(&mut self, array: &Bound<'_, PyAny>) -> PyResult<Series> {
        let (first, count) = self.array::<f64>(array)?;
        // SAFETY: inside an exported array.
        Ok(unsafe { Series::new(first, count) })
    }

    /// Every number of an array.
    ///
    /// # Errors
    /// When the array is invalid.
    pub fn slots(&mut self, array: &Bound<'_, PyAny>) -> PyResult<Vec<Slot>> {
        let (first, count) = self.array::<f64>(array)?;
        // SAFETY: inside an exported array.
        Ok((0..count).map(|i| unsafe { Slot::real(first.add(i)) }).collect())
    }

    /// A whole array of numbers or integers.
    ///
    /// # Errors
    /// When the array is invalid.
    pub fn bank(&mut self, array: &Bound<'_, PyAny>) -> PyResult<Bank> {
        if let Ok((first, count)) = self.array::<f64>(array) {
            // SAFETY: an exported array.
            return Ok(unsafe { Bank::reals(first, count) });
        }
        let (first, count) = self.array::<i32>(array)?;
        // SAFETY: an exported array.
        Ok(unsafe { Bank::integers(first, count) })
    }

    /// One value of an array.
    ///
    /// # Errors
    /// When the array is invalid or has no such item.
    pub fn slot(&mut self, row: &PlaceRow) -> PyResult<Slot> {
        if row.kind == "Real" {
            // SAFETY: inside an exported array.
            return Ok(unsafe { Slot::real(self.item(row)?) });
        }
        let place = self.item(row)?;
        // SAFETY: inside an exported array.
        Ok(unsafe { if row.kind == "Boolean" { Slot::boolean(place) } else { Slot::integer(place) } })
    }

    fn item<T: Element + Send + Sync + 'static>(&mut self, row: &PlaceRow) -> PyResult<NonNull<T>> {
        let (first, count) = self.array::<T>(&row.array)?;
        if row.index >= count {
            return Err(PyValueError::new_err(format!("index `{}` of an array of `{count}`", row.index)));
        }
        // SAFETY: inside the array.
        Ok(unsafe { first.add(row.index) })
    }

    /// An array of rows.
    ///
    /// # Errors
    /// When the array is invalid.
    pub fn table(&mut self, array: &Bound<'_, PyAny>) -> PyResult<Table> {
        let (rows, columns): (usize, usize) = array.getattr("shape")?.extract()?;
        let (first, _) = self.array::<f64>(array)?;
        // SAFETY: an exported array of this shape.
        Ok(unsafe { Table::new(first, rows, columns) })
    }

    /// An initialized controller.
    ///
    /// # Errors
    /// When an array does not fit or an address is 0.
    pub fn controller(&mut self, row: &ControllerRow) -> PyResult<Controller> {
        let mut calls = |rows: &[CallRow]| rows.iter().map(|row| self.call(row)).collect::<PyResult<_>>();
        let (set, get) = (calls(&row.set)?, calls(&row.get)?);
        // SAFETY: the caller vouches for the addresses.
        unsafe {
            let step = transmute::<usize, DoStep>(address(row.step)?);
            let status = transmute::<usize, GetBooleanStatus>(address(row.status)?);
            Ok(Controller::new(row.component as *mut c_void, set, step, status, get))
        }
    }

    fn call(&mut self, row: &CallRow) -> PyResult<Call> {
        let (references, count) = self.array::<u32>(&row.references)?;
        let (values, there) = match self.array::<f64>(&row.values) {
            Ok((first, there)) => (first.as_ptr().cast(), there),
            Err(_) => self.array::<i32>(&row.values).map(|(first, there)| (first.as_ptr().cast(), there))?,
        };
        if there != count {
            return Err(PyValueError::new_err(format!("`{count}` references for `{there}` values")));
        }
        // SAFETY: the caller vouches for the address.
        let function = unsafe { transmute::<usize, Move>(address(row.function)?) };
        Ok(Call { function, references: references.as_ptr(), count, values })
    }

    /// MuJoCo's part of a plant.
    ///
    /// # Errors
    /// When the counters are not integers or an address is 0.
    pub fn physics(&mut self, row: &MachineRow) -> PyResult<Physics> {
        let buffer = PyBuffer::<i32>::get(&row.warnings)?;
        let stride = usize::try_from(buffer.strides()[0])?;
        let start = buffer.buf_ptr().cast::<u8>();
        // SAFETY: inside the array.
        let warnings = (0..buffer.item_count()).map(|i| unsafe { start.add(i * stride).cast_const().cast() }).collect();
        self.0.push(Box::new(buffer));
        let (model, data) = (address(row.model)? as *const c_void, address(row.data)? as *mut c_void);
        let [first, second, ..] = row.functions;
        // SAFETY: the caller vouches for the addresses.
        unsafe {
            let half = |number| Ok::<_, PyErr>(transmute::<usize, Half>(address(number)?));
            Ok(Physics::new(half(first)?, half(second)?, model, data, warnings))
        }
    }
}

fn address(number: usize) -> PyResult<usize> {
    if number == 0 { Err(PyValueError::new_err("the address 0")) } else { Ok(number) }
}

/// Trap for errors of MuJoCo.
///
/// # Errors
/// When an address is 0, or the message of MuJoCo.
pub fn trap(row: &MachineRow) -> PyResult<Trap> {
    let [_, _, make, delete, apply, error] = row.functions;
    for number in row.functions {
        address(number)?;
    }
    // SAFETY: the caller vouches for the addresses.
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

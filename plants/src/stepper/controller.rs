//! A controller by its C functions, as FMI 2.0 names them.

use std::ffi::{c_int, c_uint, c_void};

use super::failure::Failure;

/// `fmi2SetReal`, `fmi2GetInteger` and so on.
pub type Move = unsafe extern "C" fn(*mut c_void, *const c_uint, usize, *mut c_void) -> c_int;
/// `fmi2DoStep`.
pub type DoStep = unsafe extern "C" fn(*mut c_void, f64, f64, c_int) -> c_int;

/// the last status that lets a run go on
const WARNING: c_int = 1;
const TRUE: c_int = 1;

/// One call with its arguments.
#[derive(Clone, Copy, Debug)]
pub struct Call {
    /// the function
    pub function: Move,
    /// value references
    pub references: *const c_uint,
    /// how many values
    pub count: usize,
    /// the values
    pub values: *mut c_void,
}

/// An initialised instance.
#[derive(Clone, Debug)]
pub struct Controller {
    /// what the functions call their component
    pub component: *mut c_void,
    /// calls that write the inputs
    pub set: Vec<Call>,
    /// does one communication step
    pub step: DoStep,
    /// calls that read the outputs
    pub get: Vec<Call>,
}

impl Controller {
    /// Writes the inputs, does the step from `time` to `time + step` and reads the outputs.
    ///
    /// # Safety
    /// Functions, component and arrays are those of one live instance.
    pub(super) unsafe fn compute(&self, time: f64, step: f64) -> Result<(), Failure> {
        let mut number = 0;
        let mut check = |status| {
            number += 1;
            if status > WARNING { Err(Failure::Call { call: number - 1, status }) } else { Ok(()) }
        };
        // SAFETY: by the contract of this function.
        unsafe {
            for call in &self.set {
                check(self.transfer(call))?;
            }
            check((self.step)(self.component, time, step, TRUE))?;
            for call in &self.get {
                check(self.transfer(call))?;
            }
        }
        Ok(())
    }

    unsafe fn transfer(&self, call: &Call) -> c_int {
        // SAFETY: by the contract of `compute`.
        unsafe { (call.function)(self.component, call.references, call.count, call.values) }
    }
}

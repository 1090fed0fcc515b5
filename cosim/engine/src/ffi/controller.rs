//! A controller by its C functions, with the names of FMI 2.0.

use std::ffi::{c_int, c_uint, c_void};

use crate::failure::Failure;

/// `fmi2SetReal`, `fmi2GetInteger` and so on.
pub type Move = unsafe extern "C" fn(*mut c_void, *const c_uint, usize, *mut c_void) -> c_int;
/// `fmi2DoStep`.
pub type DoStep = unsafe extern "C" fn(*mut c_void, f64, f64, c_int) -> c_int;

/// the last status that permits a run to continue
const WARNING: c_int = 1;
const TRUE: c_int = 1;

/// One call with its arguments.
#[derive(Clone, Copy, Debug)]
pub struct Call {
    /// the function
    pub function: Move,
    /// value references
    pub references: *const c_uint,
    /// number of values
    pub count: usize,
    /// the values
    pub values: *mut c_void,
}

/// An initialized instance.
#[derive(Clone, Debug)]
pub struct Controller {
    component: *mut c_void,
    set: Vec<Call>,
    step: DoStep,
    get: Vec<Call>,
}

// SAFETY: who makes it vouches for its addresses and for one thread at a time, see `Controller::new`.
unsafe impl Send for Controller {}
// SAFETY: as above.
unsafe impl Sync for Controller {}

impl Controller {
    /// Component of the functions, calls that write the inputs, `fmi2DoStep`, calls that read the outputs.
    ///
    /// # Safety
    /// Functions, component and arrays are those of one live instance that no other code uses.
    pub unsafe fn new(component: *mut c_void, set: Vec<Call>, step: DoStep, get: Vec<Call>) -> Self {
        Self { component, set, step, get }
    }

    /// Writes the inputs, does the step from `time` to `time + step` and reads the outputs.
    pub(crate) fn compute(&self, time: f64, step: f64) -> Result<(), Failure> {
        let mut number = 0;
        let mut check = |status| {
            number += 1;
            if status > WARNING { Err(Failure::Call { call: number - 1, status }) } else { Ok(()) }
        };
        for call in &self.set {
            check(self.transfer(call))?;
        }
        // SAFETY: by the contract of `new`.
        check(unsafe { (self.step)(self.component, time, step, TRUE) })?;
        for call in &self.get {
            check(self.transfer(call))?;
        }
        Ok(())
    }

    fn transfer(&self, call: &Call) -> c_int {
        // SAFETY: by the contract of `new`.
        unsafe { (call.function)(self.component, call.references, call.count, call.values) }
    }
}

//! A controller by its C functions, with the names of FMI 2.0.

use std::ffi::{c_int, c_uint, c_void};

use crate::failure::Failure;

/// `fmi2SetReal`, `fmi2GetInteger` and so on.
pub type Move = unsafe extern "C" fn(*mut c_void, *const c_uint, usize, *mut c_void) -> c_int;
/// `fmi2DoStep`.
pub type DoStep = unsafe extern "C" fn(*mut c_void, f64, f64, c_int) -> c_int;
/// `fmi2GetBooleanStatus`.
pub type GetBooleanStatus = unsafe extern "C" fn(*mut c_void, c_int, *mut c_int) -> c_int;

/// the last status that permits a run to continue
const WARNING: c_int = 1;
const DISCARD: c_int = 2;
/// the kind of status that states whether a discarded step ends the run
const TERMINATED: c_int = 3;
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
    status: GetBooleanStatus,
    get: Vec<Call>,
    /// number of the first call that returned a warning, and its time
    pub(crate) warned: Option<(usize, f64)>,
}

// SAFETY: who makes it vouches for its addresses and for one thread at a time, see `Controller::new`.
unsafe impl Send for Controller {}
// SAFETY: as above.
unsafe impl Sync for Controller {}

impl Controller {
    /// Component of the functions, calls that write the inputs, `fmi2DoStep`, `fmi2GetBooleanStatus`, calls that
    /// read the outputs.
    ///
    /// # Safety
    /// Functions, component and arrays are those of one live instance that no other code uses.
    pub unsafe fn new(
        component: *mut c_void,
        set: Vec<Call>,
        step: DoStep,
        status: GetBooleanStatus,
        get: Vec<Call>,
    ) -> Self {
        Self { component, set, step, status, get, warned: None }
    }

    /// Writes the inputs, does the step from `time` to `time + step` and reads the outputs; returns whether the
    /// controller ended the run in this step.
    pub(crate) fn compute(&mut self, time: f64, step: f64) -> Result<bool, Failure> {
        let mut warned = self.warned;
        let mut check = |call, status| {
            if status == WARNING {
                warned = warned.or(Some((call, time)));
            }
            if status > WARNING { Err(Failure::Call { call, status }) } else { Ok(()) }
        };
        for (number, call) in self.set.iter().enumerate() {
            check(number, self.transfer(call))?;
        }
        // SAFETY: by the contract of `new`.
        let status = unsafe { (self.step)(self.component, time, step, TRUE) };
        let ended = status == DISCARD && self.terminated();
        if !ended {
            check(self.set.len(), status)?;
        }
        for (number, call) in self.get.iter().enumerate() {
            check(self.set.len() + 1 + number, self.transfer(call))?;
        }
        self.warned = warned;
        Ok(ended)
    }

    /// Whether the discarded step ends the run.
    fn terminated(&self) -> bool {
        let mut value = 0;
        // SAFETY: by the contract of `new`.
        let status = unsafe { (self.status)(self.component, TERMINATED, &raw mut value) };
        status <= WARNING && value != 0
    }

    fn transfer(&self, call: &Call) -> c_int {
        // SAFETY: by the contract of `new`.
        unsafe { (call.function)(self.component, call.references, call.count, call.values) }
    }
}

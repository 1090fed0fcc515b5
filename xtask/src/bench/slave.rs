//! An instance of an FMU in this process.

use std::ffi::{CString, c_char};
use std::ptr;

use anyhow::{Result, bail, ensure};
use serde::Deserialize;

use super::library::{Component, Fmu, State, Status};

/// A variable that is set from outside.
#[derive(Clone, Copy, Deserialize)]
pub struct Variable {
    /// Value reference.
    pub reference: u32,
    /// How FMI moves it.
    pub base: Base,
}

/// How FMI moves a value; enumerations travel as integers.
#[derive(Clone, Copy, Deserialize)]
pub enum Base {
    /// `fmi2SetReal`.
    Real,
    /// `fmi2SetInteger`.
    Integer,
    /// `fmi2SetBoolean`.
    Boolean,
    /// `fmi2SetString`.
    String,
}

/// A value of any type.
#[derive(Deserialize)]
#[serde(untagged)]
pub enum Value {
    /// Of all types but one.
    Number(f64),
    /// Of a String.
    Text(String),
}

/// An instance. The time of the next step is counted by the caller.
pub struct Slave<'a> {
    component: Component,
    fmu: &'a Fmu,
}

impl<'a> Slave<'a> {
    /// Makes an instance.
    ///
    /// # Errors
    /// When the FMU makes none.
    pub fn new(fmu: &'a Fmu) -> Result<Self> {
        let component = fmu.component();
        ensure!(!component.is_null(), "the FMU makes no instance");
        Ok(Self { component, fmu })
    }

    /// Makes an instance and brings it to its first step at time 0.
    ///
    /// # Errors
    /// When a call fails.
    pub fn start(fmu: &'a Fmu, values: &[(Variable, Value)]) -> Result<Self> {
        let slave = Self::new(fmu)?;
        slave.enter_initialization(values)?;
        slave.exit_initialization()?;
        Ok(slave)
    }

    /// Defines the experiment, gives start values and enters the initialization mode.
    ///
    /// # Errors
    /// When a call fails.
    pub fn enter_initialization(&self, values: &[(Variable, Value)]) -> Result<()> {
        // SAFETY: the component is alive; no tolerance and no stop time are defined.
        passed("fmi2SetupExperiment", unsafe { (self.fmu.api.setup_experiment)(self.component, 0, 0.0, 0.0, 0, 0.0) })?;
        for (variable, value) in values {
            match value {
                Value::Number(value) => self.set(*variable, *value)?,
                Value::Text(text) => self.set_text(variable.reference, text)?,
            }
        }
        // SAFETY: the component is alive.
        passed("fmi2EnterInitializationMode", unsafe { (self.fmu.api.enter_initialization)(self.component) })
    }

    /// Leaves the initialization mode.
    ///
    /// # Errors
    /// When the call fails.
    pub fn exit_initialization(&self) -> Result<()> {
        // SAFETY: the component is alive.
        passed("fmi2ExitInitializationMode", unsafe { (self.fmu.api.exit_initialization)(self.component) })
    }

    /// Ends the simulation.
    ///
    /// # Errors
    /// When the call fails.
    pub fn terminate(&self) -> Result<()> {
        // SAFETY: the component is alive.
        passed("fmi2Terminate", unsafe { (self.fmu.api.terminate)(self.component) })
    }

    /// Sets Real inputs, does one step and gets Real outputs; the worst of the three statuses.
    #[inline]
    pub fn step(&self, inputs: (&[u32], &[f64]), time: f64, step: f64, outputs: (&[u32], &mut [f64])) -> Status {
        debug_assert!(inputs.0.len() == inputs.1.len() && outputs.0.len() == outputs.1.len());
        // SAFETY: the component is alive; references and values are of the same length.
        unsafe {
            let set = (self.fmu.api.set_real)(self.component, inputs.0.as_ptr(), inputs.0.len(), inputs.1.as_ptr());
            let step = (self.fmu.api.do_step)(self.component, time, step, 1);
            let (references, values) = (outputs.0.as_ptr(), outputs.1.as_mut_ptr());
            set.max(step).max((self.fmu.api.get_real)(self.component, references, outputs.0.len(), values))
        }
    }

    /// Sets one variable that takes numbers.
    ///
    /// # Errors
    /// When the FMU rejects a call.
    pub fn set(&self, variable: Variable, value: f64) -> Result<()> {
        type SetInteger = unsafe extern "C" fn(Component, *const u32, usize, *const i32) -> Status;
        let name = match variable.base {
            Base::Real => {
                // SAFETY: the component is alive; one reference and one value.
                let status = unsafe {
                    (self.fmu.api.set_real)(self.component, &raw const variable.reference, 1, &raw const value)
                };
                return passed("fmi2SetReal", status);
            }
            Base::Integer => "fmi2SetInteger",
            Base::Boolean => "fmi2SetBoolean",
            Base::String => bail!("a text cannot be set to `{value}`"),
        };
        let value = value as i32;
        // SAFETY: the component is alive; one reference and one value; Booleans are ints in C.
        passed(name, unsafe {
            self.fmu.function::<SetInteger>(name)?(self.component, &raw const variable.reference, 1, &raw const value)
        })
    }

    fn set_text(&self, reference: u32, text: &str) -> Result<()> {
        type SetString = unsafe extern "C" fn(Component, *const u32, usize, *const *const c_char) -> Status;
        let (name, text) = ("fmi2SetString", CString::new(text)?);
        let value = text.as_ptr();
        // SAFETY: the component is alive; one reference and one value.
        passed(name, unsafe {
            self.fmu.function::<SetString>(name)?(self.component, &raw const reference, 1, &raw const value)
        })
    }

    /// Gets one Integer or enumeration.
    ///
    /// # Errors
    /// When the FMU rejects a call.
    pub fn integer(&self, reference: u32) -> Result<i32> {
        type GetInteger = unsafe extern "C" fn(Component, *const u32, usize, *mut i32) -> Status;
        let (name, mut value) = ("fmi2GetInteger", 0);
        // SAFETY: the component is alive; one reference and one value.
        passed(name, unsafe {
            self.fmu.function::<GetInteger>(name)?(self.component, &raw const reference, 1, &raw mut value)
        })?;
        Ok(value)
    }

    /// A copy of the instance's state.
    ///
    /// # Errors
    /// When the FMU rejects a call.
    pub fn snapshot(&self) -> Result<Snapshot<'_>> {
        let mut snapshot = Snapshot { slave: self, state: ptr::null_mut() };
        snapshot.save()?;
        Ok(snapshot)
    }
}

impl Drop for Slave<'_> {
    fn drop(&mut self) {
        // SAFETY: the component is alive and not used again.
        unsafe { (self.fmu.api.free_instance)(self.component) }
    }
}

/// A saved state of an instance.
pub struct Snapshot<'a> {
    slave: &'a Slave<'a>,
    state: State,
}

impl Snapshot<'_> {
    /// Takes the instance's present state in place of the one before.
    ///
    /// # Errors
    /// When the FMU rejects a call.
    pub fn save(&mut self) -> Result<()> {
        // SAFETY: the component is alive; the state is its own, or NULL, which asks for a new one.
        passed("fmi2GetFMUstate", unsafe { (self.slave.fmu.api.get_state)(self.slave.component, &raw mut self.state) })
    }

    /// Brings the instance back to this state.
    ///
    /// # Errors
    /// When the FMU rejects a call.
    pub fn restore(&self) -> Result<()> {
        // SAFETY: component and state are alive and belong together.
        passed("fmi2SetFMUstate", unsafe { (self.slave.fmu.api.set_state)(self.slave.component, self.state) })
    }
}

impl Drop for Snapshot<'_> {
    fn drop(&mut self) {
        // SAFETY: the state is alive and not used again.
        unsafe { (self.slave.fmu.api.free_state)(self.slave.component, &raw mut self.state) };
    }
}

/// Whether a call went well: fmi2OK, or fmi2Warning, which a named fault of a controller gives.
pub fn went_well(status: Status) -> bool {
    (0..=1).contains(&status)
}

fn passed(name: &str, status: Status) -> Result<()> {
    ensure!(went_well(status), "`{name}` returned status {status}");
    Ok(())
}

//! An FMU in this process, driven through the function pointers of its library.

use std::ffi::{CStr, CString, c_char, c_void};
use std::path::Path;
use std::ptr;

use anyhow::{Context, Result, ensure};
use libloading::Library;
use serde::Deserialize;

type Component = *mut c_void;
type State = *mut c_void;
type Status = i32;
type Logger = unsafe extern "C" fn(*mut c_void, *const c_char, Status, *const c_char, *const c_char);
type Instantiate =
    unsafe extern "C" fn(*const c_char, i32, *const c_char, *const c_char, *const Callbacks, i32, i32) -> Component;
type SetupExperiment = unsafe extern "C" fn(Component, i32, f64, f64, i32, f64) -> Status;
type Transition = unsafe extern "C" fn(Component) -> Status;
type SetReal = unsafe extern "C" fn(Component, *const u32, usize, *const f64) -> Status;
type GetReal = unsafe extern "C" fn(Component, *const u32, usize, *mut f64) -> Status;
type SetInteger = unsafe extern "C" fn(Component, *const u32, usize, *const i32) -> Status;
type GetInteger = unsafe extern "C" fn(Component, *const u32, usize, *mut i32) -> Status;
type DoStep = unsafe extern "C" fn(Component, f64, f64, i32) -> Status;
type GetState = unsafe extern "C" fn(Component, *mut State) -> Status;
type SetState = unsafe extern "C" fn(Component, State) -> Status;

#[repr(C)]
struct Callbacks {
    logger: Option<Logger>,
    allocate: *const c_void,
    free: *const c_void,
    step_finished: *const c_void,
    environment: *const c_void,
}

const CO_SIMULATION: i32 = 1;

/// A variable that takes numbers.
#[derive(Clone, Copy, Deserialize)]
pub struct Variable {
    /// Value reference.
    pub reference: u32,
    /// How FMI moves it.
    pub base: Base,
}

/// How FMI moves a number; enumerations travel as integers.
#[derive(Clone, Copy, Deserialize)]
pub enum Base {
    /// `fmi2SetReal`.
    Real,
    /// `fmi2SetInteger`.
    Integer,
    /// `fmi2SetBoolean`.
    Boolean,
}

/// An instance that is being stepped. The time of the next step is counted by the caller.
pub struct Slave {
    component: Component,
    set_real: SetReal,
    get_real: GetReal,
    do_step: DoStep,
    library: Library,
    // the FMU keeps the address of the callbacks
    _callbacks: Box<Callbacks>,
}

impl Slave {
    /// Loads a library, gives start values, and brings one instance to its first step at time 0.
    ///
    /// # Errors
    /// When the library does not load, a function is missing, or a call fails.
    pub fn start(library: &Path, guid: &str, values: &[(Variable, f64)]) -> Result<Self> {
        let shown = library.display();
        // SAFETY: the library is an FMU built a moment ago from this workspace.
        let library = unsafe { Library::new(library) }.with_context(|| format!("cannot load `{shown}`"))?;
        let callbacks = Box::new(Callbacks {
            logger: Some(log),
            allocate: ptr::null(),
            free: ptr::null(),
            step_finished: ptr::null(),
            environment: ptr::null(),
        });
        let guid = CString::new(guid)?;
        // SAFETY: the types above are those of fmi2FunctionTypes.h; names and callbacks outlive the calls.
        let slave = unsafe {
            let instantiate = function::<Instantiate>(&library, "fmi2Instantiate")?;
            let component =
                instantiate(c"bench".as_ptr(), CO_SIMULATION, guid.as_ptr(), ptr::null(), &raw const *callbacks, 0, 0);
            ensure!(!component.is_null(), "`{shown}` makes no instance");
            Self {
                component,
                set_real: function(&library, "fmi2SetReal")?,
                get_real: function(&library, "fmi2GetReal")?,
                do_step: function(&library, "fmi2DoStep")?,
                library,
                _callbacks: callbacks,
            }
        };
        slave.initialise(values)?;
        Ok(slave)
    }

    fn initialise(&self, values: &[(Variable, f64)]) -> Result<()> {
        let setup = self.function::<SetupExperiment>("fmi2SetupExperiment")?;
        // SAFETY: the component is alive; no tolerance and no stop time are defined.
        passed("fmi2SetupExperiment", unsafe { setup(self.component, 0, 0.0, 0.0, 0, 0.0) })?;
        for (variable, value) in values {
            self.set(*variable, *value)?;
        }
        for name in ["fmi2EnterInitializationMode", "fmi2ExitInitializationMode"] {
            let transition = self.function::<Transition>(name)?;
            // SAFETY: the component is alive.
            passed(name, unsafe { transition(self.component) })?;
        }
        Ok(())
    }

    /// Sets Real inputs, does one step and gets Real outputs; the sum of the three statuses, 0 when all went well.
    #[inline]
    pub fn step(&self, inputs: (&[u32], &[f64]), time: f64, step: f64, outputs: (&[u32], &mut [f64])) -> Status {
        debug_assert!(inputs.0.len() == inputs.1.len() && outputs.0.len() == outputs.1.len());
        // SAFETY: the component is alive; references and values are of the same length.
        unsafe {
            (self.set_real)(self.component, inputs.0.as_ptr(), inputs.0.len(), inputs.1.as_ptr())
                + (self.do_step)(self.component, time, step, 1)
                + (self.get_real)(self.component, outputs.0.as_ptr(), outputs.0.len(), outputs.1.as_mut_ptr())
        }
    }

    /// Sets one variable.
    ///
    /// # Errors
    /// When the FMU refuses.
    pub fn set(&self, variable: Variable, value: f64) -> Result<()> {
        let name = match variable.base {
            Base::Real => {
                // SAFETY: the component is alive; one reference and one value.
                let status =
                    unsafe { (self.set_real)(self.component, &raw const variable.reference, 1, &raw const value) };
                return passed("fmi2SetReal", status);
            }
            Base::Integer => "fmi2SetInteger",
            Base::Boolean => "fmi2SetBoolean",
        };
        let set = self.function::<SetInteger>(name)?;
        let value = value as i32;
        // SAFETY: the component is alive; one reference and one value; Booleans are ints in C.
        passed(name, unsafe { set(self.component, &raw const variable.reference, 1, &raw const value) })
    }

    /// Gets one Integer or enumeration.
    ///
    /// # Errors
    /// When the FMU refuses.
    pub fn integer(&self, reference: u32) -> Result<i32> {
        let get = self.function::<GetInteger>("fmi2GetInteger")?;
        let mut value = 0;
        // SAFETY: the component is alive; one reference and one value.
        passed("fmi2GetInteger", unsafe { get(self.component, &raw const reference, 1, &raw mut value) })?;
        Ok(value)
    }

    /// A copy of the instance's state.
    ///
    /// # Errors
    /// When the FMU refuses.
    pub fn snapshot(&self) -> Result<Snapshot<'_>> {
        let get = self.function::<GetState>("fmi2GetFMUstate")?;
        let mut state = ptr::null_mut();
        // SAFETY: the component is alive; NULL asks for a new state.
        passed("fmi2GetFMUstate", unsafe { get(self.component, &raw mut state) })?;
        Ok(Snapshot { slave: self, state, set: self.function("fmi2SetFMUstate")? })
    }

    fn function<T: Copy>(&self, name: &str) -> Result<T> {
        // SAFETY: callers name the type that fmi2FunctionTypes.h gives the function.
        unsafe { function(&self.library, name) }
    }
}

impl Drop for Slave {
    fn drop(&mut self) {
        if let Ok(free) = self.function::<unsafe extern "C" fn(Component)>("fmi2FreeInstance") {
            // SAFETY: the component is alive and not used again.
            unsafe { free(self.component) }
        }
    }
}

/// A saved state of an instance.
pub struct Snapshot<'a> {
    slave: &'a Slave,
    state: State,
    set: SetState,
}

impl Snapshot<'_> {
    /// Brings the instance back to this state.
    ///
    /// # Errors
    /// When the FMU refuses.
    pub fn restore(&self) -> Result<()> {
        // SAFETY: component and state are alive and belong together.
        passed("fmi2SetFMUstate", unsafe { (self.set)(self.slave.component, self.state) })
    }
}

impl Drop for Snapshot<'_> {
    fn drop(&mut self) {
        if let Ok(free) = self.slave.function::<GetState>("fmi2FreeFMUstate") {
            // SAFETY: the state is alive and not used again.
            unsafe { free(self.slave.component, &raw mut self.state) };
        }
    }
}

/// # Safety
/// `T` must be the type of the function.
unsafe fn function<T: Copy>(library: &Library, name: &str) -> Result<T> {
    // SAFETY: the caller vouches for the type.
    unsafe { library.get::<T>(name.as_bytes()) }.map(|symbol| *symbol).with_context(|| format!("`{name}` is missing"))
}

fn passed(name: &str, status: Status) -> Result<()> {
    ensure!(status == 0, "`{name}` returned status {status}");
    Ok(())
}

// our FMUs hand over ready text, so the variadic arguments of the logger stay unread
unsafe extern "C" fn log(_: *mut c_void, _: *const c_char, _: Status, _: *const c_char, message: *const c_char) {
    if !message.is_null() {
        // SAFETY: a message is a C string.
        eprintln!("{}", unsafe { CStr::from_ptr(message) }.to_string_lossy());
    }
}

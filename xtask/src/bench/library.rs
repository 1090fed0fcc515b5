//! A loaded FMU: the functions of FMI 2.0 that the bench calls, found once.

use std::ffi::{CStr, CString, c_char, c_void};
use std::path::Path;
use std::ptr;

use anyhow::{Context, Result};
use libloading::Library;

/// An instance of an FMU.
pub type Component = *mut c_void;
/// A saved state of an instance.
pub type State = *mut c_void;
/// Status that a call returns, 0 for fmi2OK.
pub type Status = i32;
/// A call that only names the instance.
pub type Transition = unsafe extern "C" fn(Component) -> Status;
/// `fmi2GetFMUstate` and `fmi2FreeFMUstate`.
pub type TakeState = unsafe extern "C" fn(Component, *mut State) -> Status;

type Logger = unsafe extern "C" fn(*mut c_void, *const c_char, Status, *const c_char, *const c_char);
type Instantiate =
    unsafe extern "C" fn(*const c_char, i32, *const c_char, *const c_char, *const Callbacks, i32, i32) -> Component;

/// Functions that the FMU may call: `fmi2CallbackFunctions`.
#[repr(C)]
pub struct Callbacks {
    logger: Option<Logger>,
    allocate: *const c_void,
    free: *const c_void,
    step_finished: *const c_void,
    environment: *const c_void,
}

/// Declares the functions that are called often, each with its type and its name in the library.
macro_rules! functions {
    ($($field:ident: $type:ty = $name:literal,)+) => {
        /// The functions of a library that are called often.
        pub(super) struct Functions {
            $(pub(super) $field: $type,)+
        }

        impl Functions {
            fn find(library: &Library) -> Result<Self> {
                // SAFETY: the types are those of fmi2FunctionTypes.h.
                unsafe { Ok(Self { $($field: function(library, $name)?,)+ }) }
            }
        }
    };
}

functions! {
    instantiate: Instantiate = "fmi2Instantiate",
    free_instance: unsafe extern "C" fn(Component) = "fmi2FreeInstance",
    setup_experiment: unsafe extern "C" fn(Component, i32, f64, f64, i32, f64) -> Status = "fmi2SetupExperiment",
    enter_initialization: Transition = "fmi2EnterInitializationMode",
    exit_initialization: Transition = "fmi2ExitInitializationMode",
    terminate: Transition = "fmi2Terminate",
    set_real: unsafe extern "C" fn(Component, *const u32, usize, *const f64) -> Status = "fmi2SetReal",
    get_real: unsafe extern "C" fn(Component, *const u32, usize, *mut f64) -> Status = "fmi2GetReal",
    do_step: unsafe extern "C" fn(Component, f64, f64, i32) -> Status = "fmi2DoStep",
    get_state: TakeState = "fmi2GetFMUstate",
    set_state: unsafe extern "C" fn(Component, State) -> Status = "fmi2SetFMUstate",
    free_state: TakeState = "fmi2FreeFMUstate",
}

/// An FMU whose library is loaded.
pub struct Fmu {
    guid: CString,
    resources: Option<CString>,
    // instances keep this address
    callbacks: Box<Callbacks>,
    pub(super) api: Functions,
    library: Library,
}

impl Fmu {
    /// Loads a library; `resources` is the URI of its folder of resources.
    ///
    /// # Errors
    /// When the library does not load or a function is missing.
    pub fn load(library: &Path, guid: &str, resources: Option<&str>) -> Result<Self> {
        // SAFETY: the library is an FMU built a moment ago from this workspace.
        let library =
            unsafe { Library::new(library) }.with_context(|| format!("cannot load `{}`", library.display()))?;
        let callbacks = Callbacks {
            logger: Some(log),
            allocate: ptr::null(),
            free: ptr::null(),
            step_finished: ptr::null(),
            environment: ptr::null(),
        };
        Ok(Self {
            guid: CString::new(guid)?,
            resources: resources.map(CString::new).transpose()?,
            callbacks: Box::new(callbacks),
            api: Functions::find(&library)?,
            library,
        })
    }

    /// Calls `fmi2Instantiate`; NULL when the FMU makes no instance.
    pub(super) fn component(&self) -> Component {
        const CO_SIMULATION: i32 = 1;
        let resources = self.resources.as_ref().map_or(ptr::null(), |uri| uri.as_ptr());
        // SAFETY: texts and callbacks live as long as the library.
        unsafe {
            (self.api.instantiate)(
                c"bench".as_ptr(),
                CO_SIMULATION,
                self.guid.as_ptr(),
                resources,
                &raw const *self.callbacks,
                0,
                0,
            )
        }
    }

    /// A function that is not called often.
    ///
    /// # Safety
    /// `T` must be the type of the function.
    pub(super) unsafe fn function<T: Copy>(&self, name: &str) -> Result<T> {
        // SAFETY: the caller vouches for the type.
        unsafe { function(&self.library, name) }
    }
}

/// # Safety
/// `T` must be the type of the function.
unsafe fn function<T: Copy>(library: &Library, name: &str) -> Result<T> {
    // SAFETY: the caller vouches for the type.
    unsafe { library.get::<T>(name.as_bytes()) }.map(|symbol| *symbol).with_context(|| format!("`{name}` is missing"))
}

// our FMUs hand over ready text, so the variadic arguments of the logger stay unread
unsafe extern "C" fn log(_: *mut c_void, _: *const c_char, _: Status, _: *const c_char, message: *const c_char) {
    if !message.is_null() {
        // SAFETY: a message is a C string.
        eprintln!("{}", unsafe { CStr::from_ptr(message) }.to_string_lossy());
    }
}

//! The C API of FMI 2.0.5 for co-simulation: all 34 functions, and all `unsafe` code of this crate.
//!
//! Every function turns C arguments into Rust ones, passes a barrier for panics and re-entrance,
//! and calls the safe instance. Names and types are those of the standard's headers.
//!
//! # Safety
//! Callers keep the promises of the standard: an instance pointer comes from [`fmi2Instantiate`]
//! and was not freed, arrays hold as many elements as the call says, strings end with NUL. NULL is
//! answered with an error everywhere.
#![allow(unsafe_code, non_camel_case_types, non_snake_case, missing_docs, clippy::missing_safety_doc)]

use crate::export::Exported;
use crate::files::Files;
use crate::hook;
use crate::instance::Instance;
use crate::logger::{Callback, Category, Logger};
use crate::model::Host;
use crate::phase::{Function, Status};
use crate::resources;
use crate::slave::Slave;
use crate::states::{self, TakenState};
use crate::text::c_string;
use std::cell::{Cell, UnsafeCell};
use std::ffi::{CStr, CString, c_char, c_int, c_uint, c_void};
use std::panic::{AssertUnwindSafe, catch_unwind};
use std::path::PathBuf;

pub type fmi2Component = *mut c_void;
pub type fmi2ComponentEnvironment = *mut c_void;
pub type fmi2FMUstate = *mut c_void;
pub type fmi2ValueReference = c_uint;
pub type fmi2Real = f64;
pub type fmi2Integer = c_int;
pub type fmi2Boolean = c_int;
pub type fmi2Char = c_char;
pub type fmi2String = *const fmi2Char;
pub type fmi2Byte = c_char;
/// A C enumeration as an argument may hold any number, so it is a plain number here.
pub type fmi2Type = c_uint;
/// See [`fmi2Type`].
pub type fmi2StatusKind = c_uint;

#[repr(C)]
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum fmi2Status {
    fmi2OK,
    fmi2Warning,
    fmi2Discard,
    fmi2Error,
    fmi2Fatal,
    fmi2Pending,
}
use fmi2Status::{fmi2Discard, fmi2Error, fmi2Fatal, fmi2OK, fmi2Warning};

pub type fmi2CallbackLogger =
    Option<unsafe extern "C" fn(fmi2ComponentEnvironment, fmi2String, fmi2Status, fmi2String, fmi2String, ...)>;
pub type fmi2CallbackAllocateMemory = Option<unsafe extern "C" fn(usize, usize) -> *mut c_void>;
pub type fmi2CallbackFreeMemory = Option<unsafe extern "C" fn(*mut c_void)>;
pub type fmi2StepFinished = Option<unsafe extern "C" fn(fmi2ComponentEnvironment, fmi2Status)>;

#[repr(C)]
#[derive(Clone, Copy)]
pub struct fmi2CallbackFunctions {
    pub logger: fmi2CallbackLogger,
    pub allocateMemory: fmi2CallbackAllocateMemory,
    pub freeMemory: fmi2CallbackFreeMemory,
    pub stepFinished: fmi2StepFinished,
    pub componentEnvironment: fmi2ComponentEnvironment,
}

/// No array of the elements of this API can be longer.
const LONGEST_ARRAY: usize = isize::MAX as usize / size_of::<fmi2Real>();
const CO_SIMULATION: fmi2Type = 1;
const DO_STEP_STATUS: fmi2StatusKind = 0;
const PENDING_STATUS: fmi2StatusKind = 1;
const LAST_SUCCESSFUL_TIME: fmi2StatusKind = 2;
const TERMINATED: fmi2StatusKind = 3;

/// Type of fmi2Instantiate.
pub type Instantiate = unsafe extern "C" fn(
    instanceName: fmi2String,
    fmuType: fmi2Type,
    fmuGUID: fmi2String,
    fmuResourceLocation: fmi2String,
    functions: *const fmi2CallbackFunctions,
    visible: fmi2Boolean,
    loggingOn: fmi2Boolean,
) -> fmi2Component;
/// Type of fmi2SetReal.
pub type SetReal = unsafe extern "C" fn(
    c: fmi2Component,
    vr: *const fmi2ValueReference,
    nvr: usize,
    value: *const fmi2Real,
) -> fmi2Status;
/// Type of fmi2GetReal.
pub type GetReal = unsafe extern "C" fn(
    c: fmi2Component,
    vr: *const fmi2ValueReference,
    nvr: usize,
    value: *mut fmi2Real,
) -> fmi2Status;
/// Type of fmi2DoStep.
pub type DoStep = unsafe extern "C" fn(
    c: fmi2Component,
    currentCommunicationPoint: fmi2Real,
    communicationStepSize: fmi2Real,
    noSetFMUStatePriorToCurrentPoint: fmi2Boolean,
) -> fmi2Status;

/// What a `fmi2Component` points to; its address is the owner of the states it has made.
struct Component {
    /// Set while a call runs, so that a logger that calls back finds a closed door. Not atomic:
    /// the standard forbids overlapping calls, and an atomic swap would cost more than the call.
    busy: Cell<bool>,
    slave: UnsafeCell<Box<dyn Slave>>,
}

impl From<Status> for fmi2Status {
    fn from(status: Status) -> Self {
        match status {
            Status::Ok => fmi2OK,
            Status::Warning => fmi2Warning,
            Status::Discard => fmi2Discard,
            Status::Error => fmi2Error,
            Status::Fatal => fmi2Fatal,
        }
    }
}

/// The way into an instance: NULL check, re-entrance check, panic barrier.
#[inline(always)]
fn with(component: fmi2Component, function: Function, body: impl FnOnce(&mut dyn Slave) -> Status) -> fmi2Status {
    // SAFETY: the caller gives a pointer from `fmi2Instantiate`, or NULL.
    let Some(component) = (unsafe { component.cast::<Component>().as_ref() }) else { return fmi2Error };
    if component.busy.replace(true) {
        return fmi2Error;
    }
    // SAFETY: `busy` was false, so no other reference to the instance exists until it is again.
    let slave = unsafe { &mut *component.slave.get() };
    let status = match catch_unwind(AssertUnwindSafe(|| body(slave.as_mut()))) {
        Ok(status) => status.into(),
        Err(_) => match catch_unwind(AssertUnwindSafe(|| slave.poison(function, &hook::take_panic()))) {
            Ok(()) => fmi2Error,
            Err(_) => fmi2Fatal,
        },
    };
    component.busy.set(false);
    status
}

/// The instance behind a pointer when no call runs on it. Only for calls in which no callback can run: they leave `busy`
/// as it is.
///
/// # Safety
/// As [`with`], and the instance is one of the model `M`.
#[inline(always)]
unsafe fn idle<'a, M: Exported>(component: fmi2Component) -> Option<&'a mut Instance<M>> {
    // SAFETY: the caller gives a pointer from `fmi2Instantiate`, or NULL.
    let component = unsafe { component.cast::<Component>().as_ref() }?;
    if component.busy.get() {
        return None;
    }
    // SAFETY: no other reference to the instance exists while no call runs, and it is an `Instance<M>`.
    Some(unsafe { &mut *std::ptr::from_mut((*component.slave.get()).as_mut()).cast::<Instance<M>>() })
}

// The helpers below take the importer's pointers at its word, as the whole module does.

/// An array argument; `None` when it is NULL although it should hold something, or impossibly long.
fn slice<'a, T>(pointer: *const T, count: usize) -> Option<&'a [T]> {
    if pointer.is_null() || count > LONGEST_ARRAY {
        return if count == 0 { Some(&[]) } else { None };
    }
    // SAFETY: the caller gives `count` readable elements.
    Some(unsafe { std::slice::from_raw_parts(pointer, count) })
}

/// An array to write to; `None` when it is NULL although it should hold something, or impossibly long.
fn slice_mut<'a, T>(pointer: *mut T, count: usize) -> Option<&'a mut [T]> {
    if pointer.is_null() || count > LONGEST_ARRAY {
        return if count == 0 { Some(&mut []) } else { None };
    }
    // SAFETY: the caller gives `count` writable elements.
    Some(unsafe { std::slice::from_raw_parts_mut(pointer, count) })
}

/// A string argument; `None` when it is NULL or not UTF-8.
fn text<'a>(pointer: fmi2String) -> Option<&'a str> {
    if pointer.is_null() {
        return None;
    }
    // SAFETY: the caller gives a string that ends with NUL.
    unsafe { CStr::from_ptr(pointer) }.to_str().ok()
}

/// All string arguments of an array.
fn texts<'a>(pointer: *const fmi2String, count: usize) -> Option<Vec<&'a str>> {
    slice(pointer, count)?.iter().map(|&string| text(string)).collect()
}

const NULL_ARRAY: &str = "an array argument is NULL or impossibly long";
const UNKNOWN_STATE: &str = "`FMUstate` is no state of this FMU, or it was freed, by itself or with its instance; \
                             hint: a place for a new one starts with NULL";
const BAD_STRING: &str = "a string argument is NULL or not UTF-8";

/// A call with an array of value references and one of values.
fn with_arrays<A, B>(
    component: fmi2Component,
    function: Function,
    arrays: (Option<A>, Option<B>),
    body: impl FnOnce(&mut dyn Slave, A, B) -> Status,
) -> fmi2Status {
    with(component, function, |slave| match arrays {
        (Some(references), Some(values)) => body(slave, references, values),
        _ => slave.refuse(function, Status::Error, NULL_ARRAY),
    })
}

#[unsafe(no_mangle)]
pub extern "C" fn fmi2GetTypesPlatform() -> *const c_char {
    c"default".as_ptr()
}

#[unsafe(no_mangle)]
pub extern "C" fn fmi2GetVersion() -> *const c_char {
    c"2.0".as_ptr()
}

#[unsafe(no_mangle)]
pub unsafe extern "C" fn fmi2SetDebugLogging(
    c: fmi2Component,
    loggingOn: fmi2Boolean,
    nCategories: usize,
    categories: *const fmi2String,
) -> fmi2Status {
    with(c, Function::SetDebugLogging, |slave| match texts(categories, nCategories) {
        Some(categories) => slave.set_debug_logging(loggingOn != 0, &categories),
        None => slave.refuse(Function::SetDebugLogging, Status::Error, BAD_STRING),
    })
}

/// fmi2Instantiate of a model.
///
/// # Safety
/// As the standard says.
pub unsafe fn instantiate<M: Exported>(
    name: fmi2String,
    kind: fmi2Type,
    guid: fmi2String,
    resources: fmi2String,
    functions: *const fmi2CallbackFunctions,
    _: fmi2Boolean,
    logging: fmi2Boolean,
) -> fmi2Component {
    hook::install();
    let instantiate = || {
        let name = text(name).unwrap_or_default();
        // SAFETY: the caller gives a valid structure or NULL.
        let logger = Logger::new(callback(unsafe { functions.as_ref() }, name), logging != 0);
        if let Err(reason) = accept(name, kind, text(guid), M::guid()) {
            logger.send(Category::Error, format_args!("fmi2Instantiate: {reason}"));
            return std::ptr::null_mut();
        }
        let resources = folder(resources).unwrap_or_else(|reason| {
            logger.send(Category::Warning, format_args!("fmi2Instantiate: {reason}"));
            None
        });
        let instance = Instance::<M>::new(Host { name: name.to_owned(), resources, logger });
        let component = Component { busy: Cell::new(false), slave: UnsafeCell::new(Box::new(instance)) };
        Box::into_raw(Box::new(component)).cast()
    };
    catch_unwind(AssertUnwindSafe(instantiate)).unwrap_or(std::ptr::null_mut())
}

/// The resource folder behind a location, which may be NULL.
fn folder(location: fmi2String) -> Result<Option<PathBuf>, String> {
    if location.is_null() {
        return Ok(None);
    }
    // SAFETY: the caller gives a string that ends with NUL.
    resources::folder(unsafe { CStr::from_ptr(location) }.to_bytes())
}

/// Whether an instance may be made of these arguments.
fn accept(name: &str, kind: fmi2Type, guid: Option<&str>, own: &str) -> Result<(), String> {
    if name.trim().is_empty() {
        return Err("the instance name is empty, blank or not UTF-8".to_owned());
    }
    if kind != CO_SIMULATION {
        return Err(format!("the FMU type {kind} is not supported, only co-simulation ({CO_SIMULATION})"));
    }
    match guid {
        Some(guid) if guid == own => Ok(()),
        Some(guid) => Err(format!("the GUID `{guid}` is not that of this binary, `{own}`")),
        None => Err("the GUID is NULL or not UTF-8".to_owned()),
    }
}

/// The importer's logger and its environment, handed from thread to thread with the instance.
struct Importer {
    logger: unsafe extern "C" fn(fmi2ComponentEnvironment, fmi2String, fmi2Status, fmi2String, fmi2String, ...),
    environment: fmi2ComponentEnvironment,
    instance: CString,
}

// SAFETY: the standard lets an instance move between threads as long as calls do not overlap, and
// its callbacks with it.
unsafe impl Send for Importer {}

impl Importer {
    /// Sends a ready text; `%` is doubled, as the standard's logger is a printf, and `#`, which begins a reference to a
    /// variable there.
    fn send(&self, status: Status, category: Category, message: &str) {
        let (category, message) = (c_string(category.name()), c_string(message.replace('%', "%%").replace('#', "##")));
        // SAFETY: the importer's own function, with strings that live during the call.
        unsafe {
            (self.logger)(self.environment, self.instance.as_ptr(), status.into(), category.as_ptr(), message.as_ptr());
        }
    }
}

fn callback(functions: Option<&fmi2CallbackFunctions>, name: &str) -> Option<Callback> {
    let functions = functions?;
    let importer =
        Importer { logger: functions.logger?, environment: functions.componentEnvironment, instance: c_string(name) };
    Some(Box::new(move |status, category, message| importer.send(status, category, message)))
}

#[unsafe(no_mangle)]
pub unsafe extern "C" fn fmi2FreeInstance(c: fmi2Component) {
    // SAFETY: the caller gives a pointer from `fmi2Instantiate`, or NULL.
    let Some(component) = (unsafe { c.cast::<Component>().as_ref() }) else { return };
    if component.busy.get() {
        return;
    }
    // SAFETY: no call is running, and the caller does not use the pointer again.
    let component = unsafe { Box::from_raw(c.cast::<Component>()) };
    let _ = catch_unwind(AssertUnwindSafe(|| {
        states::free_all_of(c.addr());
        drop(component);
    }));
}

#[unsafe(no_mangle)]
pub unsafe extern "C" fn fmi2SetupExperiment(
    c: fmi2Component,
    toleranceDefined: fmi2Boolean,
    tolerance: fmi2Real,
    startTime: fmi2Real,
    stopTimeDefined: fmi2Boolean,
    stopTime: fmi2Real,
) -> fmi2Status {
    with(c, Function::SetupExperiment, |slave| {
        let stop = (stopTimeDefined != 0).then_some(stopTime);
        slave.setup_experiment((toleranceDefined != 0).then_some(tolerance), startTime, stop)
    })
}

#[unsafe(no_mangle)]
pub unsafe extern "C" fn fmi2EnterInitializationMode(c: fmi2Component) -> fmi2Status {
    with(c, Function::EnterInitializationMode, |slave| slave.enter_initialization_mode())
}

#[unsafe(no_mangle)]
pub unsafe extern "C" fn fmi2ExitInitializationMode(c: fmi2Component) -> fmi2Status {
    with(c, Function::ExitInitializationMode, |slave| slave.exit_initialization_mode())
}

#[unsafe(no_mangle)]
pub unsafe extern "C" fn fmi2Terminate(c: fmi2Component) -> fmi2Status {
    with(c, Function::Terminate, |slave| slave.terminate())
}

#[unsafe(no_mangle)]
pub unsafe extern "C" fn fmi2Reset(c: fmi2Component) -> fmi2Status {
    with(c, Function::Reset, |slave| slave.reset())
}

/// fmi2GetReal of a model.
///
/// # Safety
/// As the standard says, with an instance of the model `M`.
#[inline(always)]
pub unsafe fn get_real<M: Exported>(
    c: fmi2Component,
    vr: *const fmi2ValueReference,
    nvr: usize,
    value: *mut fmi2Real,
) -> fmi2Status {
    // SAFETY: as above.
    if let Some(instance) = unsafe { idle::<M>(c) }
        && !(vr.is_null() || value.is_null())
        && let Some(references) = slice(vr, nvr)
        && let Some(values) = slice_mut(value, nvr)
        && instance.get_reals(references, values)
    {
        return fmi2OK;
    }
    get_real_or_reason(c, vr, nvr, value)
}

/// fmi2GetReal with every check and message.
#[cold]
fn get_real_or_reason(c: fmi2Component, vr: *const fmi2ValueReference, nvr: usize, value: *mut fmi2Real) -> fmi2Status {
    let arrays = (slice(vr, nvr), slice_mut(value, nvr));
    with_arrays(c, Function::GetReal, arrays, |slave, vr, value| slave.get_real(vr, value))
}

#[unsafe(no_mangle)]
pub unsafe extern "C" fn fmi2GetInteger(
    c: fmi2Component,
    vr: *const fmi2ValueReference,
    nvr: usize,
    value: *mut fmi2Integer,
) -> fmi2Status {
    let arrays = (slice(vr, nvr), slice_mut(value, nvr));
    with_arrays(c, Function::GetInteger, arrays, |slave, vr, value| slave.get_integer(vr, value))
}

#[unsafe(no_mangle)]
pub unsafe extern "C" fn fmi2GetBoolean(
    c: fmi2Component,
    vr: *const fmi2ValueReference,
    nvr: usize,
    value: *mut fmi2Boolean,
) -> fmi2Status {
    let arrays = (slice(vr, nvr), slice_mut(value, nvr));
    with_arrays(c, Function::GetBoolean, arrays, |slave, vr, value| {
        slave.get_boolean(vr, &mut |i, x| value[i] = fmi2Boolean::from(x))
    })
}

#[unsafe(no_mangle)]
pub unsafe extern "C" fn fmi2GetString(
    c: fmi2Component,
    vr: *const fmi2ValueReference,
    nvr: usize,
    value: *mut fmi2String,
) -> fmi2Status {
    let arrays = (slice(vr, nvr), slice_mut(value, nvr));
    with_arrays(c, Function::GetString, arrays, |slave, vr, value| {
        slave.get_string(vr, &mut |i, x| value[i] = x.as_ptr())
    })
}

/// fmi2SetReal of a model.
///
/// # Safety
/// As the standard says, with an instance of the model `M`.
#[inline(always)]
pub unsafe fn set_real<M: Exported>(
    c: fmi2Component,
    vr: *const fmi2ValueReference,
    nvr: usize,
    value: *const fmi2Real,
) -> fmi2Status {
    // SAFETY: as above.
    if let Some(instance) = unsafe { idle::<M>(c) }
        && !(vr.is_null() || value.is_null())
        && let Some(references) = slice(vr, nvr)
        && let Some(values) = slice(value, nvr)
        && instance.set_inputs(references, values)
    {
        return fmi2OK;
    }
    set_real_or_reason(c, vr, nvr, value)
}

/// fmi2SetReal with every check and message.
#[cold]
fn set_real_or_reason(
    c: fmi2Component,
    vr: *const fmi2ValueReference,
    nvr: usize,
    value: *const fmi2Real,
) -> fmi2Status {
    let arrays = (slice(vr, nvr), slice(value, nvr));
    with_arrays(c, Function::SetReal, arrays, |slave, vr, value| slave.set_real(vr, value))
}

#[unsafe(no_mangle)]
pub unsafe extern "C" fn fmi2SetInteger(
    c: fmi2Component,
    vr: *const fmi2ValueReference,
    nvr: usize,
    value: *const fmi2Integer,
) -> fmi2Status {
    let arrays = (slice(vr, nvr), slice(value, nvr));
    with_arrays(c, Function::SetInteger, arrays, |slave, vr, value| slave.set_integer(vr, value))
}

#[unsafe(no_mangle)]
pub unsafe extern "C" fn fmi2SetBoolean(
    c: fmi2Component,
    vr: *const fmi2ValueReference,
    nvr: usize,
    value: *const fmi2Boolean,
) -> fmi2Status {
    let arrays = (slice(vr, nvr), slice(value, nvr));
    with_arrays(c, Function::SetBoolean, arrays, |slave, vr, value| {
        let value: Vec<bool> = value.iter().map(|x| *x != 0).collect();
        slave.set_boolean(vr, &value)
    })
}

#[unsafe(no_mangle)]
pub unsafe extern "C" fn fmi2SetString(
    c: fmi2Component,
    vr: *const fmi2ValueReference,
    nvr: usize,
    value: *const fmi2String,
) -> fmi2Status {
    with(c, Function::SetString, |slave| match (slice(vr, nvr), texts(value, nvr)) {
        (Some(vr), Some(value)) => slave.set_string(vr, &value),
        (None, _) => slave.refuse(Function::SetString, Status::Error, NULL_ARRAY),
        _ => slave.refuse(Function::SetString, Status::Error, BAD_STRING),
    })
}

#[unsafe(no_mangle)]
pub unsafe extern "C" fn fmi2GetFMUstate(c: fmi2Component, FMUstate: *mut fmi2FMUstate) -> fmi2Status {
    with_slot(c, Function::GetFMUstate, FMUstate, |slave, slot| slave.take_state(slot))
}

#[unsafe(no_mangle)]
pub unsafe extern "C" fn fmi2SetFMUstate(c: fmi2Component, FMUstate: fmi2FMUstate) -> fmi2Status {
    with_state(c, Function::SetFMUstate, FMUstate, |slave, state| slave.put_state(state))
}

#[unsafe(no_mangle)]
pub unsafe extern "C" fn fmi2FreeFMUstate(c: fmi2Component, FMUstate: *mut fmi2FMUstate) -> fmi2Status {
    with(c, Function::FreeFMUstate, |slave| {
        // SAFETY: the caller gives a place for a state, or NULL, which is nothing to free.
        let Some(place) = (unsafe { FMUstate.as_mut() }) else { return Status::Ok };
        let state = std::mem::replace(place, std::ptr::null_mut());
        if !state.is_null() && !states::free(state.addr()) {
            return slave.refuse(Function::FreeFMUstate, Status::Error, UNKNOWN_STATE);
        }
        slave.permit(Function::FreeFMUstate)
    })
}

#[unsafe(no_mangle)]
pub unsafe extern "C" fn fmi2SerializedFMUstateSize(
    c: fmi2Component,
    FMUstate: fmi2FMUstate,
    size: *mut usize,
) -> fmi2Status {
    const THIS: Function = Function::SerializedFMUstateSize;
    with_state(c, THIS, FMUstate, |slave, state| {
        // SAFETY: the caller gives a place for a number, or NULL.
        let Some(size) = (unsafe { size.as_mut() }) else {
            return slave.refuse(THIS, Status::Error, "`size` is NULL");
        };
        let mut bytes = Vec::new();
        let status = slave.serialize(THIS, state, &mut bytes);
        *size = bytes.len();
        status
    })
}

#[unsafe(no_mangle)]
pub unsafe extern "C" fn fmi2SerializeFMUstate(
    c: fmi2Component,
    FMUstate: fmi2FMUstate,
    serializedState: *mut fmi2Byte,
    size: usize,
) -> fmi2Status {
    const THIS: Function = Function::SerializeFMUstate;
    with_state(c, THIS, FMUstate, |slave, state| {
        let mut bytes = Vec::new();
        let status = slave.serialize(THIS, state, &mut bytes);
        match slice_mut(serializedState.cast::<u8>(), size) {
            _ if status != Status::Ok => status,
            Some(target) if target.len() >= bytes.len() => {
                target[..bytes.len()].copy_from_slice(&bytes);
                status
            }
            Some(_) => {
                let text = format!("the state takes {} bytes, `size` = {size}", bytes.len());
                slave.refuse(THIS, Status::Error, &text)
            }
            None => slave.refuse(THIS, Status::Error, NULL_ARRAY),
        }
    })
}

#[unsafe(no_mangle)]
pub unsafe extern "C" fn fmi2DeSerializeFMUstate(
    c: fmi2Component,
    serializedState: *const fmi2Byte,
    size: usize,
    FMUstate: *mut fmi2FMUstate,
) -> fmi2Status {
    const THIS: Function = Function::DeSerializeFMUstate;
    with_slot(c, THIS, FMUstate, |slave, slot| match slice(serializedState.cast::<u8>(), size) {
        Some(bytes) => slave.deserialize(bytes, slot),
        None => slave.refuse(THIS, Status::Error, NULL_ARRAY),
    })
}

/// A call with a state that must be there.
fn with_state(
    component: fmi2Component,
    function: Function,
    state: fmi2FMUstate,
    body: impl FnOnce(&mut dyn Slave, &TakenState) -> Status,
) -> fmi2Status {
    with(component, function, |slave| match states::get(state.addr()) {
        Some(state) => body(slave, &state),
        None if state.is_null() => slave.refuse(function, Status::Error, "`FMUstate` is NULL"),
        None => slave.refuse(function, Status::Error, UNKNOWN_STATE),
    })
}

/// A call that makes a state, in the caller's place, which may hold an older one.
fn with_slot(
    component: fmi2Component,
    function: Function,
    place: *mut fmi2FMUstate,
    body: impl FnOnce(&mut dyn Slave, &mut Option<TakenState>) -> Status,
) -> fmi2Status {
    with(component, function, |slave| {
        // SAFETY: the caller gives a place for a state, or NULL.
        let Some(place) = (unsafe { place.as_mut() }) else {
            return slave.refuse(function, Status::Error, "`FMUstate` is NULL");
        };
        let mut slot = None;
        let status = body(slave, &mut slot);
        let Some(state) = slot else { return status };
        if place.is_null() {
            *place = std::ptr::without_provenance_mut(states::hold(component.addr(), state));
        } else if !states::replace(place.addr(), state) {
            return slave.refuse(function, Status::Error, UNKNOWN_STATE);
        }
        status
    })
}

#[unsafe(no_mangle)]
pub unsafe extern "C" fn fmi2GetDirectionalDerivative(
    c: fmi2Component,
    _vUnknown_ref: *const fmi2ValueReference,
    _nUnknown: usize,
    _vKnown_ref: *const fmi2ValueReference,
    _nKnown: usize,
    _dvKnown: *const fmi2Real,
    _dvUnknown: *mut fmi2Real,
) -> fmi2Status {
    not_offered(c, Function::GetDirectionalDerivative, "a sampled controller has no directional derivatives")
}

#[unsafe(no_mangle)]
pub unsafe extern "C" fn fmi2SetRealInputDerivatives(
    c: fmi2Component,
    vr: *const fmi2ValueReference,
    nvr: usize,
    order: *const fmi2Integer,
    value: *const fmi2Real,
) -> fmi2Status {
    let arrays = (slice(vr, nvr), slice(order, nvr).zip(slice(value, nvr)));
    with_arrays(c, Function::SetRealInputDerivatives, arrays, |slave, vr, (order, value)| {
        slave.set_input_derivatives(vr, order, value)
    })
}

#[unsafe(no_mangle)]
pub unsafe extern "C" fn fmi2GetRealOutputDerivatives(
    c: fmi2Component,
    _vr: *const fmi2ValueReference,
    _nvr: usize,
    _order: *const fmi2Integer,
    _value: *mut fmi2Real,
) -> fmi2Status {
    not_offered(c, Function::GetRealOutputDerivatives, "outputs are held between samples and have no derivatives")
}

/// fmi2DoStep of a model.
///
/// # Safety
/// As the standard says, with an instance of the model `M`.
#[inline(always)]
pub unsafe fn do_step<M: Exported>(c: fmi2Component, time: fmi2Real, step: fmi2Real, _: fmi2Boolean) -> fmi2Status {
    with(c, Function::DoStep, |slave| {
        // SAFETY: the instance is one of the model `M`.
        let instance = unsafe { &mut *std::ptr::from_mut(slave).cast::<Instance<M>>() };
        instance.do_step(time, step)
    })
}

#[unsafe(no_mangle)]
pub unsafe extern "C" fn fmi2CancelStep(c: fmi2Component) -> fmi2Status {
    with(c, Function::CancelStep, |slave| slave.permit(Function::CancelStep))
}

#[unsafe(no_mangle)]
pub unsafe extern "C" fn fmi2GetStatus(c: fmi2Component, s: fmi2StatusKind, _value: *mut fmi2Status) -> fmi2Status {
    with(c, Function::GetStatus, |slave| no_status(slave, Function::GetStatus, s))
}

#[unsafe(no_mangle)]
pub unsafe extern "C" fn fmi2GetRealStatus(c: fmi2Component, s: fmi2StatusKind, value: *mut fmi2Real) -> fmi2Status {
    // SAFETY: the caller gives a place for a number, or NULL.
    with(c, Function::GetRealStatus, |slave| match unsafe { value.as_mut() } {
        Some(value) if s == LAST_SUCCESSFUL_TIME => slave.last_successful_time(value),
        Some(_) => no_status(slave, Function::GetRealStatus, s),
        None => slave.refuse(Function::GetRealStatus, Status::Error, "`value` is NULL"),
    })
}

#[unsafe(no_mangle)]
pub unsafe extern "C" fn fmi2GetIntegerStatus(
    c: fmi2Component,
    s: fmi2StatusKind,
    _value: *mut fmi2Integer,
) -> fmi2Status {
    with(c, Function::GetIntegerStatus, |slave| no_status(slave, Function::GetIntegerStatus, s))
}

#[unsafe(no_mangle)]
pub unsafe extern "C" fn fmi2GetBooleanStatus(
    c: fmi2Component,
    s: fmi2StatusKind,
    value: *mut fmi2Boolean,
) -> fmi2Status {
    const THIS: Function = Function::GetBooleanStatus;
    // SAFETY: the caller gives a place for a Boolean, or NULL.
    with(c, Function::GetBooleanStatus, |slave| match unsafe { value.as_mut() } {
        Some(value) if s == TERMINATED => {
            // a controller never asks to end the simulation
            *value = 0;
            slave.permit(THIS)
        }
        Some(_) => no_status(slave, THIS, s),
        None => slave.refuse(THIS, Status::Error, "`value` is NULL"),
    })
}

#[unsafe(no_mangle)]
pub unsafe extern "C" fn fmi2GetStringStatus(
    c: fmi2Component,
    s: fmi2StatusKind,
    _value: *mut fmi2String,
) -> fmi2Status {
    with(c, Function::GetStringStatus, |slave| no_status(slave, Function::GetStringStatus, s))
}

/// Text of a generated file of the FMU.
///
/// # Safety
/// `path` is a C string or NULL.
pub unsafe fn file<M: Exported>(files: &'static Files, path: fmi2String) -> fmi2String {
    let file = || text(path).and_then(|path| files.get::<M>(path));
    catch_unwind(AssertUnwindSafe(file)).ok().flatten().map_or(std::ptr::null(), CStr::as_ptr)
}

/// A function that must exist but has nothing to do in this kind of FMU.
fn not_offered(component: fmi2Component, function: Function, reason: &str) -> fmi2Status {
    with(component, function, |slave| match slave.permit(function) {
        Status::Ok => slave.refuse(function, Status::Error, reason),
        status => status,
    })
}

/// Steps are synchronous, so nothing is ever pending: a status is discarded, as the standard says.
fn no_status(slave: &mut dyn Slave, function: Function, kind: fmi2StatusKind) -> Status {
    match (slave.permit(function), kind) {
        (Status::Ok, DO_STEP_STATUS | PENDING_STATUS) => {
            slave.refuse(function, Status::Discard, "steps are synchronous, nothing is pending")
        }
        (Status::Ok, LAST_SUCCESSFUL_TIME | TERMINATED) => {
            slave.refuse(function, Status::Discard, "the status is of another type")
        }
        (Status::Ok, _) => slave.refuse(function, Status::Discard, &format!("there is no status kind {kind}")),
        (status, _) => status,
    }
}

//! C functions that set up an instance and change its phase; version, types platform and debug logging.

use super::call::{BAD_STRING, texts, with};
use super::types::*;
use crate::host::phase::{Function, Status};
use std::ffi::c_char;

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

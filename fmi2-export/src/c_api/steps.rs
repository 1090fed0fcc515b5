//! Steps, their status, and what a sampled controller does not offer.

use super::call::with;
use super::types::*;
use crate::exported::Exported;
use crate::host::phase::{Function, Status};
use crate::instance::Instance;
use crate::instance::slave::Slave;

const DO_STEP_STATUS: fmi2StatusKind = 0;
const PENDING_STATUS: fmi2StatusKind = 1;
const LAST_SUCCESSFUL_TIME: fmi2StatusKind = 2;
const TERMINATED: fmi2StatusKind = 3;

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
pub unsafe extern "C" fn fmi2GetRealOutputDerivatives(
    c: fmi2Component,
    _vr: *const fmi2ValueReference,
    _nvr: usize,
    _order: *const fmi2Integer,
    _value: *mut fmi2Real,
) -> fmi2Status {
    not_offered(c, Function::GetRealOutputDerivatives, "outputs are held between samples and have no derivatives")
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

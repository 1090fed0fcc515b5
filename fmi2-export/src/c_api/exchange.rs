//! Model exchange: time events, and continuous states of which there are none.

use super::call::with;
use super::types::*;
use crate::host::phase::{Function, Phase, Status};

#[unsafe(no_mangle)]
pub unsafe extern "C" fn fmi2EnterEventMode(c: fmi2Component) -> fmi2Status {
    with(c, Function::EnterEventMode, |slave| slave.enter(Function::EnterEventMode, Phase::EventMode))
}

#[unsafe(no_mangle)]
pub unsafe extern "C" fn fmi2EnterContinuousTimeMode(c: fmi2Component) -> fmi2Status {
    const THIS: Function = Function::EnterContinuousTimeMode;
    with(c, THIS, |slave| slave.enter(THIS, Phase::ContinuousTime))
}

#[unsafe(no_mangle)]
pub unsafe extern "C" fn fmi2NewDiscreteStates(c: fmi2Component, fmi2eventInfo: *mut fmi2EventInfo) -> fmi2Status {
    const THIS: Function = Function::NewDiscreteStates;
    with(c, THIS, |slave| {
        // SAFETY: the caller gives a place for the structure, or NULL.
        let Some(info) = (unsafe { fmi2eventInfo.as_mut() }) else {
            return slave.refuse(THIS, Status::Error, "`fmi2eventInfo` is NULL");
        };
        let mut next = f64::NAN;
        let status = slave.new_discrete_states(&mut next);
        if matches!(status, Status::Ok | Status::Warning) {
            // one sample does all, a controller never asks to end the simulation, and there are no continuous states
            *info = fmi2EventInfo {
                newDiscreteStatesNeeded: 0,
                terminateSimulation: 0,
                nominalsOfContinuousStatesChanged: 0,
                valuesOfContinuousStatesChanged: 0,
                nextEventTimeDefined: 1,
                nextEventTime: next,
            };
        }
        status
    })
}

#[unsafe(no_mangle)]
pub unsafe extern "C" fn fmi2CompletedIntegratorStep(
    c: fmi2Component,
    _noSetFMUStatePriorToCurrentPoint: fmi2Boolean,
    enterEventMode: *mut fmi2Boolean,
    terminateSimulation: *mut fmi2Boolean,
) -> fmi2Status {
    const THIS: Function = Function::CompletedIntegratorStep;
    // SAFETY: the caller gives places for Booleans, or NULL.
    with(c, THIS, |slave| match unsafe { (enterEventMode.as_mut(), terminateSimulation.as_mut()) } {
        (Some(event), Some(end)) => {
            (*event, *end) = (0, 0);
            slave.permit(THIS)
        }
        (None, _) => slave.refuse(THIS, Status::Error, "`enterEventMode` is NULL"),
        (_, None) => slave.refuse(THIS, Status::Error, "`terminateSimulation` is NULL"),
    })
}

#[unsafe(no_mangle)]
pub unsafe extern "C" fn fmi2SetTime(c: fmi2Component, time: fmi2Real) -> fmi2Status {
    with(c, Function::SetTime, |slave| slave.set_time(time))
}

#[unsafe(no_mangle)]
pub unsafe extern "C" fn fmi2SetContinuousStates(c: fmi2Component, _x: *const fmi2Real, nx: usize) -> fmi2Status {
    empty(c, Function::SetContinuousStates, "continuous states", nx)
}

#[unsafe(no_mangle)]
pub unsafe extern "C" fn fmi2GetDerivatives(c: fmi2Component, _derivatives: *mut fmi2Real, nx: usize) -> fmi2Status {
    empty(c, Function::GetDerivatives, "continuous states", nx)
}

#[unsafe(no_mangle)]
pub unsafe extern "C" fn fmi2GetEventIndicators(
    c: fmi2Component,
    _eventIndicators: *mut fmi2Real,
    ni: usize,
) -> fmi2Status {
    empty(c, Function::GetEventIndicators, "event indicators", ni)
}

#[unsafe(no_mangle)]
pub unsafe extern "C" fn fmi2GetContinuousStates(c: fmi2Component, _x: *mut fmi2Real, nx: usize) -> fmi2Status {
    empty(c, Function::GetContinuousStates, "continuous states", nx)
}

#[unsafe(no_mangle)]
pub unsafe extern "C" fn fmi2GetNominalsOfContinuousStates(
    c: fmi2Component,
    _x_nominal: *mut fmi2Real,
    nx: usize,
) -> fmi2Status {
    empty(c, Function::GetNominalsOfContinuousStates, "continuous states", nx)
}

/// A call with an array that can only be empty.
fn empty(component: fmi2Component, function: Function, elements: &str, count: usize) -> fmi2Status {
    with(component, function, |slave| match slave.permit(function) {
        Status::Ok if count > 0 => {
            let text = format!("a sampled controller has no {elements}, the call is for {count}");
            slave.refuse(function, Status::Error, &text)
        }
        status => status,
    })
}

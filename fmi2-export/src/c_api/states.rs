//! FMU states and their bytes.

use super::call::{NULL_ARRAY, UNKNOWN_STATE, slice, slice_mut, with};
use super::types::*;
use crate::host::phase::{Function, Status};
use crate::instance::slave::Slave;
use crate::instance::states::{self, TakenState};

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

//! Getting and setting values.

use super::call::{BAD_STRING, NULL_ARRAY, idle, slice, slice_mut, texts, with, with_arrays};
use super::types::fmi2Status::fmi2OK;
use super::types::*;
use crate::exported::Exported;
use crate::host::phase::{Function, Status};

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
    with_arrays(c, Function::SetBoolean, arrays, |slave, vr, value| slave.set_boolean(vr, &|i| value[i] != 0))
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

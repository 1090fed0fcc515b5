//! The way of every call into its instance, and what C gives it as arguments.

use super::types::fmi2Status::{fmi2Error, fmi2Fatal};
use super::types::{fmi2Component, fmi2Real, fmi2Status, fmi2String};
use crate::exported::Exported;
use crate::host::hook;
use crate::host::phase::{Function, Status};
use crate::instance::Instance;
use crate::instance::slave::Slave;
use std::any::Any;
use std::cell::{Cell, UnsafeCell};
use std::ffi::CStr;
use std::panic::{AssertUnwindSafe, catch_unwind};

/// No array of the elements of this API can be longer.
pub(super) const LONGEST_ARRAY: usize = isize::MAX as usize / size_of::<fmi2Real>();

/// Target of a `fmi2Component` pointer; its address identifies the owner of the FMU states made with it.
pub(super) struct Component {
    /// Set while a call runs, so that a call from within the logger is rejected. Not atomic:
    /// the standard forbids overlapping calls, and an atomic swap would cost more than the call.
    pub(super) busy: Cell<bool>,
    pub(super) slave: UnsafeCell<Box<dyn Slave>>,
}

/// The way into an instance: NULL check, re-entrance check, panic barrier.
#[inline(always)]
pub(super) fn with(
    component: fmi2Component,
    function: Function,
    body: impl FnOnce(&mut dyn Slave) -> Status,
) -> fmi2Status {
    // SAFETY: the caller gives a pointer from `fmi2Instantiate`, or NULL.
    let Some(component) = (unsafe { component.cast::<Component>().as_ref() }) else { return fmi2Error };
    if component.busy.replace(true) {
        return fmi2Error;
    }
    // SAFETY: `busy` was false, so no other reference to the instance exists until it is again.
    let slave = unsafe { &mut *component.slave.get() };
    let status = match catch_unwind(AssertUnwindSafe(|| body(slave.as_mut()))) {
        Ok(status) => status.into(),
        Err(panic) => panicked(slave.as_mut(), function, panic),
    };
    component.busy.set(false);
    status
}

/// A call that has panicked. Kept out of the way of all others, whose registers it would take.
#[cold]
#[inline(never)]
fn panicked(slave: &mut dyn Slave, function: Function, panic: Box<dyn Any + Send>) -> fmi2Status {
    let ended = catch_unwind(AssertUnwindSafe(|| {
        drop(panic);
        slave.poison(function, &hook::take_panic());
    }));
    if ended.is_ok() { fmi2Error } else { fmi2Fatal }
}

/// The instance at a pointer when no call runs on it. Only for calls in which no callback can run: they leave `busy`
/// as it is.
///
/// # Safety
/// As [`with`], and the instance is one of the model `M`.
#[inline(always)]
pub(super) unsafe fn idle<'a, M: Exported>(component: fmi2Component) -> Option<&'a mut Instance<M>> {
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
pub(super) fn slice<'a, T>(pointer: *const T, count: usize) -> Option<&'a [T]> {
    if pointer.is_null() || count > LONGEST_ARRAY {
        return if count == 0 { Some(&[]) } else { None };
    }
    // SAFETY: the caller gives `count` readable elements.
    Some(unsafe { std::slice::from_raw_parts(pointer, count) })
}

/// An array to write to; `None` when it is NULL although it should hold something, or impossibly long.
pub(super) fn slice_mut<'a, T>(pointer: *mut T, count: usize) -> Option<&'a mut [T]> {
    if pointer.is_null() || count > LONGEST_ARRAY {
        return if count == 0 { Some(&mut []) } else { None };
    }
    // SAFETY: the caller gives `count` writable elements.
    Some(unsafe { std::slice::from_raw_parts_mut(pointer, count) })
}

/// A string argument; `None` when it is NULL or not UTF-8.
pub(super) fn text<'a>(pointer: fmi2String) -> Option<&'a str> {
    if pointer.is_null() {
        return None;
    }
    // SAFETY: the caller gives a string that ends with NUL.
    unsafe { CStr::from_ptr(pointer) }.to_str().ok()
}

/// All string arguments of an array.
pub(super) fn texts<'a>(pointer: *const fmi2String, count: usize) -> Option<Vec<&'a str>> {
    slice(pointer, count)?.iter().map(|&string| text(string)).collect()
}

pub(super) const NULL_ARRAY: &str = "an array argument is NULL or impossibly long";
pub(super) const UNKNOWN_STATE: &str = "`FMUstate` is not a state of this FMU, or it was freed; \
                             hint: Initialize the variable of a new state with NULL.";
pub(super) const BAD_STRING: &str = "a string argument is NULL or not UTF-8";

/// A call with an array of value references and one of values.
pub(super) fn with_arrays<A, B>(
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

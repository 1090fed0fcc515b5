//! Making and freeing instances.

use super::call::{Component, text};
use super::types::*;
use crate::description::files::Files;
use crate::exported::Exported;
use crate::host::hook;
use crate::host::logger::{Callback, Category, Logger};
use crate::host::phase::{FmuType, Status};
use crate::host::resources;
use crate::host::text::c_string;
use crate::instance::{Instance, states};
use crate::model::Host;
use std::cell::{Cell, UnsafeCell};
use std::ffi::{CStr, CString};
use std::panic::{AssertUnwindSafe, catch_unwind};
use std::path::PathBuf;

const MODEL_EXCHANGE: fmi2Type = 0;
const CO_SIMULATION: fmi2Type = 1;

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
        let fmu_type = match accept(name, kind, text(guid), M::guid()) {
            Ok(fmu_type) => fmu_type,
            Err(reason) => {
                logger.send(Category::Error, format_args!("fmi2Instantiate: {reason}"));
                return std::ptr::null_mut();
            }
        };
        let resources = folder(resources).unwrap_or_else(|reason| {
            logger.send(Category::Warning, format_args!("fmi2Instantiate: {reason}"));
            // fmi2Instantiate has no status; the next call is not to blame
            logger.take_warned();
            None
        });
        let instance = Instance::<M>::new(Host { name: name.to_owned(), resources, logger }, fmu_type);
        let component = Component { busy: Cell::new(false), slave: UnsafeCell::new(Box::new(instance)) };
        Box::into_raw(Box::new(component)).cast()
    };
    catch_unwind(AssertUnwindSafe(instantiate)).unwrap_or(std::ptr::null_mut())
}

/// The resource folder of a location, which may be NULL.
fn folder(location: fmi2String) -> Result<Option<PathBuf>, String> {
    if location.is_null() {
        return Ok(None);
    }
    // SAFETY: the caller gives a string that ends with NUL.
    resources::folder(unsafe { CStr::from_ptr(location) }.to_bytes())
}

/// The type of the instance that is made of these arguments, or why none is.
fn accept(name: &str, kind: fmi2Type, guid: Option<&str>, own: &str) -> Result<FmuType, String> {
    if name.trim().is_empty() {
        return Err("the instance name is empty, blank or not UTF-8".to_owned());
    }
    let fmu_type = match kind {
        MODEL_EXCHANGE => FmuType::ModelExchange,
        CO_SIMULATION => FmuType::CoSimulation,
        _ => {
            let known = format!("model exchange ({MODEL_EXCHANGE}) or co-simulation ({CO_SIMULATION})");
            return Err(format!("the FMU type {kind} is not {known}"));
        }
    };
    match guid {
        Some(guid) if guid == own => Ok(fmu_type),
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

/// Text of a generated file of the FMU.
///
/// # Safety
/// `path` is a C string or NULL.
pub unsafe fn file<M: Exported>(files: &'static Files, path: fmi2String) -> fmi2String {
    let file = || text(path).and_then(|path| files.get::<M>(path));
    catch_unwind(AssertUnwindSafe(file)).ok().flatten().map_or(std::ptr::null(), CStr::as_ptr)
}

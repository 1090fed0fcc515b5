//! fmi2Instantiate and the functions without an instance.

use crate::common::*;
use std::cell::{Cell, RefCell};
use std::ffi::{CStr, c_int, c_void};
use std::ptr::{null, null_mut};

thread_local! {
    static MESSAGES: RefCell<Vec<(Status, String, String)>> = const { RefCell::new(Vec::new()) };
    static REENTER: Cell<(Option<&'static Fmu>, Component)> = const { Cell::new((None, null_mut())) };
    static REENTERED: Cell<Option<Status>> = const { Cell::new(None) };
}

unsafe extern "C" fn log(_: *mut c_void, _: Text, status: Status, category: Text, text: Text) {
    // SAFETY: the FMU gives C strings that live during the call.
    let own = |text: Text| unsafe { CStr::from_ptr(text) }.to_str().unwrap().to_owned();
    MESSAGES.with_borrow_mut(|messages| messages.push((status, own(category), own(text))));
    if let (Some(fmu), component) = REENTER.get() {
        // SAFETY: the instance lives, it is in the middle of a call, which is the point.
        let status = unsafe {
            (fmu.free_instance)(component);
            (fmu.reset)(component)
        };
        REENTERED.set(Some(status));
    }
}

fn callbacks(logger: Option<LoggerFunction>) -> Callbacks {
    Callbacks { logger, allocate: None, free: None, step_finished: None, environment: null_mut() }
}

fn instantiate(fmu: &Fmu, name: Text, kind: c_int, guid: Text, functions: *const Callbacks) -> Component {
    unsafe { (fmu.instantiate)(name, kind, guid, null(), functions, 0, 0) }
}

#[test]
fn versions_are_those_of_the_headers() {
    let fmu = Fmu::probe();
    let texts = unsafe { [CStr::from_ptr((fmu.get_types_platform)()), CStr::from_ptr((fmu.get_version)())] };
    assert_eq!(texts, [c"default", c"2.0"]);
}

#[test]
fn wrong_arguments_give_no_instance_and_one_reason() {
    let fmu = Fmu::probe();
    let functions = callbacks(Some(log));
    let (name, guid) = (c"test".as_ptr(), fmu.guid.as_ptr());
    let foreign = c"01234567-89ab-cdef-0123-456789abcdef".as_ptr();
    let bad_utf8 = c"\xff".as_ptr();
    for (name, kind, guid, reason) in [
        (null(), CO_SIMULATION, guid, "instance name"),
        (c"".as_ptr(), CO_SIMULATION, guid, "instance name"),
        (c" \t\n".as_ptr(), CO_SIMULATION, guid, "instance name"),
        (bad_utf8, CO_SIMULATION, guid, "instance name"),
        (name, -1, guid, "FMU type"),
        (name, 2, guid, "FMU type 2 is not model exchange (0) or co-simulation (1)"),
        (name, 7, guid, "FMU type 7"),
        (name, CO_SIMULATION, null(), "GUID is NULL"),
        (name, CO_SIMULATION, bad_utf8, "GUID is NULL or not UTF-8"),
        (name, CO_SIMULATION, c"".as_ptr(), "GUID ``"),
        (name, CO_SIMULATION, foreign, "GUID `01234567-89ab-cdef-0123-456789abcdef`"),
    ] {
        assert!(instantiate(&fmu, name, kind, guid, &functions).is_null(), "{reason}");
        let messages = MESSAGES.take();
        assert_eq!(messages.len(), 1, "{reason}");
        assert_eq!((messages[0].0, messages[0].1.as_str()), (ERROR, "logStatusError"));
        assert!(messages[0].2.starts_with("fmi2Instantiate: ") && messages[0].2.contains(reason), "{}", messages[0].2);
        // and no message
        assert!(instantiate(&fmu, name, kind, guid, null()).is_null(), "{reason}");
    }
    assert!(!fmu.guid.to_str().unwrap().contains(['{', '}']));
}

#[test]
fn without_callbacks_or_logger_an_instance_works_in_silence() {
    let fmu = Fmu::probe();
    let silent = callbacks(None);
    for functions in [null(), &raw const silent] {
        let component = instantiate(&fmu, c"a/b.c d".as_ptr(), CO_SIMULATION, fmu.guid.as_ptr(), functions);
        assert!(!component.is_null());
        unsafe {
            assert_eq!((fmu.cancel_step)(component), ERROR);
            assert_eq!((fmu.reset)(component), OK);
            assert_eq!((fmu.setup_experiment)(component, 1, f64::NAN, 0.0, 0, f64::NAN), OK);
            assert_eq!((fmu.enter_initialization_mode)(component), OK);
            assert_eq!((fmu.exit_initialization_mode)(component), OK);
            assert_eq!((fmu.do_step)(component, 0.0, 1e-3, 1), OK);
            (fmu.free_instance)(component);
        }
    }
    assert!(MESSAGES.take().is_empty());
}

#[test]
fn resource_locations_of_any_shape_are_taken() {
    let fmu = Fmu::probe();
    for location in [&b"file:///tmp/x%20y"[..], b"", b"file:", b"nonsense", b"file:///%FF", b"\xff\xfe"] {
        let location = std::ffi::CString::new(location).unwrap();
        let (name, guid) = (c"test".as_ptr(), fmu.guid.as_ptr());
        unsafe {
            let component = (fmu.instantiate)(name, CO_SIMULATION, guid, location.as_ptr(), null(), 1, 1);
            assert!(!component.is_null(), "{location:?}");
            (fmu.free_instance)(component);
        }
    }
}

#[test]
fn a_location_that_is_no_folder_is_reported() {
    let fmu = Fmu::probe();
    let functions = callbacks(Some(log));
    for location in [c"http://server/resources", c"fmi2://resources"] {
        let (name, guid) = (c"test".as_ptr(), fmu.guid.as_ptr());
        unsafe {
            let component = (fmu.instantiate)(name, CO_SIMULATION, guid, location.as_ptr(), &functions, 0, 0);
            assert!(!component.is_null());
            assert_eq!((fmu.setup_experiment)(component, 0, 0.0, 0.0, 0, 0.0), OK, "the next call is not to blame");
            (fmu.free_instance)(component);
        }
        let [(status, category, text)] = &MESSAGES.take()[..] else { panic!("one message for {location:?}") };
        assert_eq!((*status, category.as_str()), (WARNING, "logStatusWarning"));
        assert!(text.contains(location.to_str().unwrap()) && text.contains("no resources"), "{text}");
    }
}

#[test]
fn a_logger_that_calls_back_finds_a_closed_door() {
    let fmu: &'static Fmu = Box::leak(Box::new(Fmu::probe()));
    let functions = callbacks(Some(log));
    let component = instantiate(fmu, c"test".as_ptr(), CO_SIMULATION, fmu.guid.as_ptr(), &functions);
    REENTER.set((Some(fmu), component));
    unsafe {
        assert_eq!((fmu.do_step)(component, 0.0, 1e-3, 1), ERROR);
        REENTER.set((None, null_mut()));
        assert_eq!(REENTERED.take(), Some(ERROR), "the logger was not called or its call got through");
        assert_eq!(MESSAGES.take().len(), 1);
        // the instance was neither freed nor reset by its logger
        assert_eq!((fmu.setup_experiment)(component, 0, 0.0, 0.0, 0, 0.0), ERROR);
        assert_eq!((fmu.reset)(component), OK);
        assert_eq!((fmu.setup_experiment)(component, 0, 0.0, 0.0, 0, 0.0), OK);
        (fmu.free_instance)(component);
    }
}

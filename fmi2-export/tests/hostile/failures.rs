//! A model that fails in a sample: error, panic, NaN, warnings.

use crate::common::*;

const NONE: i32 = 1;
const FAIL: i32 = 2;
const PANIC: i32 = 3;
const NOT_A_NUMBER: i32 = 4;
const WARN: i32 = 5;

/// An instance after ten samples, with the next one prepared to fail.
fn about_to_fail(fmu: &Fmu, failure: i32) -> Instance<'_> {
    let instance = Instance::started(fmu);
    assert_eq!(instance.set_real("position", 1.0), OK);
    assert_eq!(instance.step(0.0, 1e-2), OK);
    assert_eq!(instance.set_integer("failure", failure), OK);
    instance
}

/// Checks that outputs and parameters can be read after an error, and that stepping, setting and terminating fail.
fn is_stuck_but_readable(instance: &Instance) {
    for name in ["force", "sum", "natural_frequency", "position"] {
        assert!(instance.real(name).is_finite(), "{name}");
    }
    instance.messages();
    instance.assert_rejected(instance.step(1.1e-2, 1e-3), ERROR, &["fmi2DoStep", "may not be called after an error"]);
    instance.assert_rejected(
        instance.set_real("gain", 1.0),
        ERROR,
        &["fmi2SetReal", "may not be called after an error"],
    );
    instance.assert_rejected(instance.terminate(), ERROR, &["fmi2Terminate", "may not be called after an error"]);
}

fn works_after_reset(instance: &Instance) {
    assert_eq!(instance.reset(), OK);
    assert_eq!((instance.setup(0.0, None), instance.enter(), instance.exit()), (OK, OK, OK));
    assert_eq!(instance.set_real("position", 1.0), OK);
    assert_eq!(instance.step(0.0, 1e-2), OK);
    assert_eq!((instance.real("force"), instance.integer("ticks")), (3.5, 10));
}

/// The next sample fails with these words; what is left after that can be read, and works after a reset.
fn fails(instance: &Instance, words: &[&str]) {
    instance.assert_rejected(instance.step(1e-2, 1e-3), ERROR, words);
    is_stuck_but_readable(instance);
    works_after_reset(instance);
}

#[test]
fn an_error_or_nan_in_a_sample_ends_the_run_with_its_text() {
    let fmu = Fmu::probe();
    for (failure, words) in [(FAIL, "provoked error"), (NOT_A_NUMBER, "`force` = NaN")] {
        fails(&about_to_fail(&fmu, failure), &["fmi2DoStep", words]);
    }
}

#[test]
fn a_panic_is_caught_and_logged_with_its_location() {
    let fmu = Fmu::probe();
    let (instance, other) = (about_to_fail(&fmu, PANIC), about_to_fail(&fmu, NONE));
    let line = include_str!("../../examples/probe.rs").lines().position(|line| line.contains("panic!(")).unwrap() + 1;
    let location = format!("examples/probe.rs:{line}");
    fails(&instance, &["fmi2DoStep", "panicked at", &location, "provoked panic"]);
    // other instances do not notice
    assert_eq!(other.step(1e-2, 1e-3), OK);
    assert_eq!((other.integer("ticks"), other.messages()), (11, vec![]));
}

#[test]
fn a_state_from_before_the_failure_undoes_it() {
    let fmu = Fmu::probe();
    for failure in [FAIL, PANIC, NOT_A_NUMBER] {
        let (instance, twin) = (about_to_fail(&fmu, failure), about_to_fail(&fmu, NONE));
        let (state, bytes) = (instance.take_state(), instance.bytes());
        assert_eq!(instance.step(1e-2, 1e-3), ERROR);
        assert_eq!(instance.put_state(state), OK);
        assert_eq!(instance.set_integer("failure", NONE), OK);
        assert_eq!((instance.step(1e-2, 1e-3), twin.step(1e-2, 1e-3)), (OK, OK));
        assert_eq!(instance.outputs(), twin.outputs());
        // and once more, from bytes
        assert_eq!(instance.step(5.0, 1e-3), ERROR);
        instance.restore(&bytes);
        assert_eq!(instance.set_integer("failure", NONE), OK);
        assert_eq!(instance.step(1e-2, 1e-3), OK);
        assert_eq!(instance.outputs(), twin.outputs());
        instance.free_state(state);
    }
}

#[test]
fn parameters_that_do_not_fit_together_fail_at_the_end_of_initialization() {
    let fmu = Fmu::probe();
    let instance = Instance::in_phase(&fmu, Phase::Initialization);
    assert_eq!(instance.set_real("limits.low", 12.5), OK);
    let words = ["fmi2ExitInitializationMode", "`limits.low` = 12.5 N", "`limits.high` = 10 N"];
    instance.assert_rejected(instance.exit(), ERROR, &words);
    works_after_reset(&instance);
}

fn switch(instance: &Instance, on: i32, categories: &[&std::ffi::CStr]) -> Status {
    let names: Vec<Text> = categories.iter().map(|name| name.as_ptr()).collect();
    unsafe { (instance.fmu.set_debug_logging)(instance.component, on, names.len(), names.as_ptr()) }
}

#[test]
fn a_warning_is_the_status_of_its_call_and_messages_are_those_that_are_switched_on() {
    let fmu = Fmu::probe();
    let instance = about_to_fail(&fmu, WARN);
    let mut time = 1e-2;
    let mut categories = || {
        assert_eq!(instance.step(time, 1e-3), WARNING);
        time += 1e-3;
        let messages = instance.messages();
        assert!(messages.iter().all(|m| fmu.description.contains(&format!("<Category name=\"{}\"", m.category))));
        if let Some(warning) = messages.iter().find(|message| message.category == "logStatusWarning") {
            // '%' is doubled, for importers that take the text for a printf format
            assert!(warning.text.contains("50 %% of a warning"), "{warning:?}");
            assert_eq!((warning.status, warning.instance.as_str()), (WARNING, "test"));
        }
        messages.into_iter().map(|message| message.category).collect::<Vec<_>>()
    };
    let (warnings, all) = (["logStatusWarning"], ["logStatusWarning", "logEvents"]);
    assert_eq!(categories(), warnings);
    for (on, names, expected) in [
        (1, &[][..], &all[..]),
        (0, &[], &[]),
        (1, &[c"logEvents"], &["logEvents"]),
        (1, &[c"logEvents", c"logStatusWarning"], &all),
        (0, &[c"logStatusError", c"logEvents"], &warnings),
        (0, &[c"logStatusWarning"], &[]),
        (1, &[c"logAll"], &all),
    ] {
        assert_eq!(switch(&instance, on, names), OK);
        assert_eq!(categories(), expected, "{on} {names:?}");
    }
    assert_eq!(switch(&instance, 0, &[c"logStatusDiscard"]), OK);
    assert_eq!((instance.set_real("gain", -1.0), instance.messages()), (DISCARD, vec![]));
}

#[test]
fn reset_switches_logging_to_what_it_was_at_first() {
    let fmu = Fmu::probe();
    let instance = Instance::new(&fmu);
    for on in [0, 1] {
        assert_eq!(switch(&instance, on, &[]), OK);
        assert_eq!((instance.reset(), instance.setup(0.0, None)), (OK, OK));
        assert_eq!((instance.enter(), instance.exit(), instance.set_integer("failure", WARN)), (OK, OK, OK));
        assert_eq!(instance.step(0.0, 1e-3), WARNING);
        assert_eq!(instance.messages().into_iter().map(|m| m.category).collect::<Vec<_>>(), ["logStatusWarning"]);
    }
}

#[test]
fn the_model_sees_the_experiment_and_its_name() {
    let fmu = Fmu::probe();
    for (tolerance, stop, words) in [
        (None, None, "an event of test, stop time None, tolerance None"),
        (Some(1e-3), Some(2.0), "an event of test, stop time Some(2.0), tolerance Some(0.001)"),
        (Some(f64::NAN), Some(f64::INFINITY), "an event of test, stop time None, tolerance None"),
    ] {
        let instance = Instance::new(&fmu);
        let (is_defined, tolerance) = (i32::from(tolerance.is_some()), tolerance.unwrap_or(7.0));
        let (stops, stop) = (i32::from(stop.is_some()), stop.unwrap_or(7.0));
        let status = unsafe { (fmu.setup_experiment)(instance.component, is_defined, tolerance, 0.0, stops, stop) };
        assert_eq!((status, instance.enter(), instance.exit()), (OK, OK, OK));
        assert_eq!((switch(&instance, 1, &[]), instance.set_integer("failure", WARN)), (OK, OK));
        assert_eq!(instance.step(0.0, 1e-3), WARNING);
        assert!(instance.messages()[1].text.contains(words), "{words}");
    }
}

#[test]
fn an_undeclared_category_is_named_and_left_out() {
    let fmu = Fmu::probe();
    let instance = Instance::started(&fmu);
    let status = switch(&instance, 1, &[c"logEvents", c"log#2#"]);
    // `#` is doubled: it begins a reference to a variable
    instance.assert_rejected(status, WARNING, &["fmi2SetDebugLogging", "`log##2##`", "`logEvents`"]);
    assert_eq!((instance.set_integer("failure", WARN), instance.step(0.0, 1e-3)), (OK, WARNING));
    assert_eq!(instance.messages().into_iter().map(|m| m.category).collect::<Vec<_>>(), ["logEvents"]);
}

//! Model exchange: times, arrays that can only be empty, and what is set in which mode.

use crate::common::*;
use std::ptr::{null, null_mut};

#[test]
fn a_time_that_is_none_or_outside_of_the_experiment_is_rejected() {
    let fmu = Fmu::probe();
    for (time, words) in [
        (f64::NAN, "not finite"),
        (f64::INFINITY, "not finite"),
        (f64::NEG_INFINITY, "not finite"),
        (1.9, "before the start time 2 s"),
    ] {
        let instance = Instance::of_type(&fmu, MODEL_EXCHANGE);
        assert_eq!((instance.setup(2.0, Some(3.0)), instance.enter(), instance.exit()), (OK, OK, OK));
        assert_eq!((instance.set_time(2.0), instance.set_time(3.1), instance.set_time(2.5)), (OK, OK, OK));
        instance.assert_rejected(instance.set_time(time), ERROR, &["fmi2SetTime", words]);
        assert_eq!(instance.end_phase(), Phase::Error);
    }
    // integrators look past the stop time, but there is no event after it
    let instance = Instance::of_type(&fmu, MODEL_EXCHANGE);
    assert_eq!((instance.setup(2.0, Some(2.01)), instance.enter(), instance.exit()), (OK, OK, OK));
    assert_eq!((instance.new_discrete_states(), instance.set_time(2.01)), ((OK, 2.001), OK));
    assert_eq!(instance.new_discrete_states().0, WARNING);
    assert_eq!((instance.messages().len(), instance.integer("ticks"), instance.set_time(2.011)), (1, 11, OK));
    let (status, _) = instance.new_discrete_states();
    instance.assert_rejected(status, ERROR, &["the event at 2.011 s passes the stop time 2.01 s"]);
    assert_eq!(instance.integer("ticks"), 11);
}

#[test]
fn arrays_of_states_and_indicators_are_empty() {
    let fmu = Fmu::probe();
    let mut x = [7.0];
    type Call = fn(&Instance, &mut [f64; 1]) -> Status;
    let calls: [(&str, Call); 5] = [
        ("fmi2SetContinuousStates", |i, x| unsafe { (i.fmu.set_continuous_states)(i.component, x.as_ptr(), 1) }),
        ("fmi2GetDerivatives", |i, x| unsafe { (i.fmu.get_derivatives)(i.component, x.as_mut_ptr(), 1) }),
        ("fmi2GetContinuousStates", |i, x| unsafe { (i.fmu.get_continuous_states)(i.component, x.as_mut_ptr(), 1) }),
        ("fmi2GetNominalsOfContinuousStates", |i, x| unsafe { (i.fmu.get_nominals)(i.component, x.as_mut_ptr(), 1) }),
        ("fmi2GetEventIndicators", |i, x| unsafe { (i.fmu.get_event_indicators)(i.component, x.as_mut_ptr(), 1) }),
    ];
    for (function, call) in calls {
        let instance = Instance::of_type_in_phase(&fmu, MODEL_EXCHANGE, Phase::ContinuousTime);
        instance.assert_rejected(call(&instance, &mut x), ERROR, &[function, "the call is for 1"]);
        assert_eq!((x, instance.end_phase()), ([7.0], Phase::Error), "{function}");
    }
}

#[test]
fn a_null_result_pointer_is_rejected() {
    let fmu = Fmu::probe();
    let instance = Instance::at_first_event(&fmu);
    let status = unsafe { (fmu.new_discrete_states)(instance.component, null_mut()) };
    instance.assert_rejected(status, ERROR, &["fmi2NewDiscreteStates", "`fmi2eventInfo` is NULL"]);
    let mut answer = 7;
    let pointer = &raw mut answer;
    for (event, end, word) in [(null_mut(), pointer, "enterEventMode"), (pointer, null_mut(), "terminateSimulation")] {
        let instance = Instance::of_type_in_phase(&fmu, MODEL_EXCHANGE, Phase::ContinuousTime);
        let status = unsafe { (fmu.completed_integrator_step)(instance.component, 1, event, end) };
        instance.assert_rejected(status, ERROR, &["fmi2CompletedIntegratorStep", word, "is NULL"]);
    }
}

#[test]
fn without_an_instance_every_function_answers_with_an_error() {
    let fmu = Fmu::probe();
    let no_instance = null_mut();
    unsafe {
        assert_eq!((fmu.enter_event_mode)(no_instance), ERROR);
        assert_eq!((fmu.new_discrete_states)(no_instance, null_mut()), ERROR);
        assert_eq!((fmu.enter_continuous_time_mode)(no_instance), ERROR);
        assert_eq!((fmu.completed_integrator_step)(no_instance, 0, null_mut(), null_mut()), ERROR);
        assert_eq!((fmu.set_time)(no_instance, 0.0), ERROR);
        assert_eq!((fmu.set_continuous_states)(no_instance, null(), 0), ERROR);
        assert_eq!((fmu.get_derivatives)(no_instance, null_mut(), 0), ERROR);
        assert_eq!((fmu.get_event_indicators)(no_instance, null_mut(), 0), ERROR);
        assert_eq!((fmu.get_continuous_states)(no_instance, null_mut(), 0), ERROR);
        assert_eq!((fmu.get_nominals)(no_instance, null_mut(), 0), ERROR);
    }
}

#[test]
fn inputs_move_in_continuous_time_and_parameters_at_events_only() {
    let fmu = Fmu::probe();
    let instance = Instance::at_first_event(&fmu);
    assert_eq!((instance.set_real("gain", 5.0), instance.set_integer("count", 3)), (OK, OK));
    let (status, next) = instance.new_discrete_states();
    assert_eq!((status, next), (OK, 1e-3));
    assert_eq!(instance.enter_continuous_time_mode(), OK);
    assert_eq!(instance.set_real("position", 0.5), OK);
    // nothing happens before the event
    assert_eq!((instance.set_time(0.9e-3), instance.real("force"), instance.integer("ticks")), (OK, 1.5, 1));
    instance.event(next);
    assert_eq!((instance.real("force"), instance.integer("counted"), instance.integer("ticks")), (4.0, 6, 2));
    instance.assert_rejected(instance.set_real("gain", 1.0), ERROR, &["`gain` = 1", "in event mode"]);
}

#[test]
fn between_events_what_is_no_real_input_may_be_written_again_and_not_changed() {
    let fmu = Fmu::probe();
    let between = || {
        let instance = Instance::of_type(&fmu, MODEL_EXCHANGE);
        // law: Paper, so that a tunable parameter that is treated as set would show in `force`
        assert_eq!((instance.set_integer("law", 2), instance.set_real("position", -3.0)), (OK, OK));
        assert_eq!((instance.setup(0.0, None), instance.enter(), instance.exit()), (OK, OK, OK));
        assert_eq!((instance.set_integer("count", 3), instance.new_discrete_states().0), (OK, OK));
        assert_eq!(instance.enter_continuous_time_mode(), OK);
        instance
    };
    let instance = between();
    let before = instance.real("force");
    assert_eq!(before, 6.0);
    assert_eq!((instance.set_booleans(&["enable"], &[1]), instance.set_integer("count", 3)), (OK, OK));
    assert_eq!((instance.set_integer("mode", 3), instance.set_real("gain", 2.0)), (OK, OK));
    assert_eq!((instance.set_integer("order", 2), instance.set_texts(&["label"], &[c"100 % <probe>"])), (OK, OK));
    instance.event(1e-3);
    assert_eq!((instance.real("force"), instance.integer("counted"), instance.messages().len()), (before, 6, 0));
    let words = |name| [name, "in event mode, not in continuous-time mode"];
    instance.assert_rejected(instance.set_booleans(&["enable"], &[0]), ERROR, &words("`enable` = false"));
    assert_eq!((instance.boolean("enable"), instance.end_phase()), (1, Phase::Error));
    let instance = between();
    instance.assert_rejected(instance.set_integer("count", 4), ERROR, &words("`count` = 4"));
    let instance = between();
    instance.assert_rejected(instance.set_integer("mode", 1), ERROR, &words("`mode` = 1"));
}

#[test]
fn a_model_that_fails_ends_the_event_with_its_reason() {
    let fmu = Fmu::probe();
    for (failure, words) in [(2, "provoked error"), (3, "provoked panic"), (4, "`force` = NaN")] {
        let instance = Instance::at_first_event(&fmu);
        assert_eq!(instance.set_integer("failure", failure), OK);
        let (status, _) = instance.new_discrete_states();
        instance.assert_rejected(status, ERROR, &["fmi2NewDiscreteStates", words]);
        assert!(instance.real("force").is_finite());
        assert_eq!(instance.end_phase(), Phase::Error);
        assert_eq!((instance.reset(), instance.setup(0.0, None), instance.enter(), instance.exit()), (OK, OK, OK, OK));
        assert_eq!(instance.new_discrete_states(), (OK, 1e-3));
    }
    let instance = Instance::at_first_event(&fmu);
    assert_eq!(instance.set_integer("failure", 5), OK);
    let (status, next) = instance.new_discrete_states();
    assert_eq!(next, 1e-3);
    instance.assert_rejected(status, WARNING, &["50 %% of a warning"]);
}

#[test]
fn an_event_that_was_passed_is_reported_once_and_its_samples_run() {
    let fmu = Fmu::probe();
    let instance = Instance::at_first_event(&fmu);
    assert_eq!((instance.new_discrete_states(), instance.enter_continuous_time_mode()), ((OK, 1e-3), OK));
    for (time, status, ticks) in [(3.5e-3, WARNING, 4), (7e-3, OK, 8)] {
        assert_eq!((instance.set_time(time), instance.enter_event_mode()), (OK, OK));
        let (answer, _) = instance.new_discrete_states();
        match status {
            OK => assert_eq!((answer, instance.messages()), (OK, vec![])),
            _ => instance.assert_rejected(
                answer,
                WARNING,
                &["passed the time event at `0.001 s`", "3 samples", "nextEventTime"],
            ),
        }
        assert_eq!((instance.integer("ticks"), instance.enter_continuous_time_mode()), (ticks, OK));
    }
    assert_eq!((instance.set_time(1e9), instance.enter_event_mode()), (OK, OK));
    let (status, _) = instance.new_discrete_states();
    instance.assert_rejected(status, ERROR, &["1000000000 sample periods after the event at 0.008 s"]);
    assert_eq!(instance.integer("ticks"), 8);
}

#[test]
fn events_that_were_passed_begin_a_long_step_as_a_communication_step_does() {
    let fmu = Fmu::probe();
    let started = |fmu_type| {
        let instance = Instance::of_type(&fmu, fmu_type);
        assert_eq!(instance.set_real("sample_period", 1e-6), OK);
        assert_eq!((instance.setup(0.0, None), instance.enter(), instance.exit()), (OK, OK, OK));
        instance
    };
    // the probe works up to a million of its sample periods
    let (events, steps) = (started(MODEL_EXCHANGE), started(CO_SIMULATION));
    assert_eq!((events.new_discrete_states().0, events.enter_continuous_time_mode()), (OK, OK));
    assert_eq!(steps.step(0.0, 1e-6), OK);
    let (mut time, mut last) = (0.0, 1e-6);
    for (gap, long_steps) in [(1.0, 0), (1.000001, 1), (1e-3, 1)] {
        time += gap;
        assert_eq!((events.set_time(time), events.enter_event_mode()), (OK, OK));
        assert!(events.new_discrete_states().0 <= WARNING);
        assert_eq!((events.integer("long_steps"), events.enter_continuous_time_mode()), (long_steps, OK));
        assert!(steps.step(last, gap) <= WARNING);
        assert_eq!(steps.integer("long_steps"), long_steps);
        last += gap;
    }
    assert_eq!(events.integer("ticks"), steps.integer("ticks"));
}

#[test]
fn a_state_of_the_other_fmu_type_is_rejected() {
    let fmu = Fmu::probe();
    let (events, steps) = (Instance::at_first_event(&fmu), Instance::started(&fmu));
    let (state, bytes) = (events.take_state(), events.bytes());
    steps.assert_rejected(
        steps.put_state(state),
        ERROR,
        &["of an instance for model exchange, this one is for co-simulation"],
    );
    let (status, _) = steps.deserialize(&bytes);
    steps.assert_rejected(status, ERROR, &["of an instance for model exchange, this one is for co-simulation"]);
    let state = steps.take_state();
    events.assert_rejected(events.put_state(state), ERROR, &["of an instance for co-simulation"]);
}

//! fmi2GetXxxStatus, fmi2CancelStep and what is not offered.

use crate::common::*;
use std::ptr::null;

#[test]
fn last_successful_time_is_the_communication_point() {
    let fmu = Fmu::probe();
    let instance = Instance::new(&fmu);
    let time = || {
        let mut time = f64::NAN;
        assert_eq!(unsafe { (fmu.get_real_status)(instance.component, LAST_SUCCESSFUL_TIME, &mut time) }, OK);
        time
    };
    assert_eq!((instance.setup(2.0, None), instance.enter(), instance.exit()), (OK, OK, OK));
    assert_eq!(time(), 2.0);
    // half a sample: the point moves, the last sample does not
    assert_eq!(instance.step(2.0, 0.5e-3), OK);
    assert_eq!(time(), 2.0005);
    assert_eq!(instance.step(3.0, 1e-3), ERROR);
    assert_eq!(time(), 2.0005);
}

#[test]
fn a_status_that_is_not_there_is_discarded_and_changes_nothing() {
    let fmu = Fmu::probe();
    let instance = Instance::started(&fmu);
    let c = instance.component;
    let mut texts = Vec::new();
    for kind in [DO_STEP_STATUS, PENDING_STATUS, LAST_SUCCESSFUL_TIME, TERMINATED, 4, -1] {
        let statuses = unsafe {
            [
                ("fmi2GetStatus", (fmu.get_status)(c, kind, &mut 0), instance.messages()),
                ("fmi2GetRealStatus", (fmu.get_real_status)(c, kind, &mut 0.0), instance.messages()),
                ("fmi2GetIntegerStatus", (fmu.get_integer_status)(c, kind, &mut 0), instance.messages()),
                ("fmi2GetBooleanStatus", (fmu.get_boolean_status)(c, kind, &mut 0), instance.messages()),
                ("fmi2GetStringStatus", (fmu.get_string_status)(c, kind, &mut null()), instance.messages()),
            ]
        };
        for (function, status, messages) in statuses {
            let given = matches!((function, kind), ("fmi2GetRealStatus", 2) | ("fmi2GetBooleanStatus", 3));
            assert_eq!(status, if given { OK } else { DISCARD }, "{function} {kind}");
            assert_eq!(messages.len(), usize::from(!given));
            for message in messages {
                assert!(message.category == "logStatusDiscard" && message.text.starts_with(function), "{message:?}");
                texts.push(message.text);
            }
        }
    }
    assert_eq!(texts.len(), 28);
    assert_eq!(instance.end_phase(), Phase::StepComplete);
}

#[test]
fn a_controller_never_ends_the_simulation() {
    let fmu = Fmu::probe();
    let instance = Instance::started(&fmu);
    let mut terminated = 7;
    assert_eq!(unsafe { (fmu.get_boolean_status)(instance.component, TERMINATED, &mut terminated) }, OK);
    assert_eq!(terminated, 0);
}

#[test]
fn what_is_not_offered_says_so() {
    let fmu = Fmu::probe();
    let (r, c) = (&fmu.reference("force"), |i: &Instance| i.component);
    let instance = Instance::started(&fmu);
    let status = unsafe { (fmu.get_directional_derivative)(c(&instance), r, 1, &0, 1, &1.0, &mut 0.0) };
    instance.assert_rejected(status, ERROR, &["fmi2GetDirectionalDerivative", "no directional derivatives"]);
    let instance = Instance::started(&fmu);
    let status = unsafe { (fmu.get_output_derivatives)(c(&instance), r, 1, &1, &mut 0.0) };
    instance.assert_rejected(status, ERROR, &["fmi2GetRealOutputDerivatives", "held between samples"]);
    let instance = Instance::started(&fmu);
    instance.assert_rejected(unsafe { (fmu.cancel_step)(c(&instance)) }, ERROR, &["fmi2CancelStep", "between steps"]);
    for flag in
        ["providesDirectionalDerivative=\"false\"", "maxOutputDerivativeOrder=\"0\"", "canInterpolateInputs=\"true\""]
    {
        assert!(fmu.description.contains(flag), "{flag}");
    }
}

//! NULL, unknown references and wrong types.

use crate::common::*;
use std::ptr::{null, null_mut};

#[test]
fn null_components_are_an_error_everywhere() {
    let fmu = Fmu::probe();
    let c = null_mut();
    let statuses = unsafe {
        (fmu.free_instance)(c);
        [
            (fmu.set_debug_logging)(c, 1, 0, null()),
            (fmu.setup_experiment)(c, 0, 0.0, 0.0, 0, 0.0),
            (fmu.enter_initialization_mode)(c),
            (fmu.exit_initialization_mode)(c),
            (fmu.terminate)(c),
            (fmu.reset)(c),
            (fmu.get_real)(c, null(), 0, null_mut()),
            (fmu.get_integer)(c, null(), 0, null_mut()),
            (fmu.get_boolean)(c, null(), 0, null_mut()),
            (fmu.get_string)(c, null(), 0, null_mut()),
            (fmu.set_real)(c, null(), 0, null()),
            (fmu.set_integer)(c, null(), 0, null()),
            (fmu.set_boolean)(c, null(), 0, null()),
            (fmu.set_string)(c, null(), 0, null()),
            (fmu.get_fmu_state)(c, null_mut()),
            (fmu.set_fmu_state)(c, null_mut()),
            (fmu.free_fmu_state)(c, null_mut()),
            (fmu.serialized_size)(c, null_mut(), null_mut()),
            (fmu.serialize)(c, null_mut(), null_mut(), 0),
            (fmu.deserialize)(c, null(), 0, null_mut()),
            (fmu.get_directional_derivative)(c, null(), 0, null(), 0, null(), null_mut()),
            (fmu.set_input_derivatives)(c, null(), 0, null(), null()),
            (fmu.get_output_derivatives)(c, null(), 0, null(), null_mut()),
            (fmu.do_step)(c, 0.0, 1.0, 1),
            (fmu.cancel_step)(c),
            (fmu.get_status)(c, 0, null_mut()),
            (fmu.get_real_status)(c, 0, null_mut()),
            (fmu.get_integer_status)(c, 0, null_mut()),
            (fmu.get_boolean_status)(c, 0, null_mut()),
            (fmu.get_string_status)(c, 0, null_mut()),
        ]
    };
    assert_eq!(statuses, [ERROR; 30]);
}

/// One call on a fresh instance between steps, which must be rejected with an error.
fn assert_call_rejected(fmu: &Fmu, words: &[&str], call: impl FnOnce(&Fmu, Component) -> Status) {
    let instance = Instance::started(fmu);
    instance.assert_rejected(call(fmu, instance.component), ERROR, words);
    assert_eq!(instance.end_phase(), Phase::Error, "{words:?}");
}

#[test]
fn arrays_longer_than_memory_are_an_error() {
    let fmu = Fmu::probe();
    for count in [usize::MAX, isize::MAX as usize] {
        assert_call_rejected(&fmu, &["fmi2GetReal", "long"], |f, c| unsafe { (f.get_real)(c, &0, count, &mut 0.0) });
        assert_call_rejected(&fmu, &["fmi2SetReal", "long"], |f, c| unsafe { (f.set_real)(c, &0, count, &0.0) });
    }
}

#[test]
#[rustfmt::skip]
fn null_arrays_that_should_hold_something_are_an_error() {
    let fmu = Fmu::probe();
    let r = &0_u32;
    assert_call_rejected(&fmu, &["fmi2GetReal", "NULL"], |f, c| unsafe { (f.get_real)(c, null(), 1, &mut 0.0) });
    assert_call_rejected(&fmu, &["fmi2GetReal", "NULL"], |f, c| unsafe { (f.get_real)(c, r, 1, null_mut()) });
    assert_call_rejected(&fmu, &["fmi2GetInteger", "NULL"], |f, c| unsafe { (f.get_integer)(c, null(), 1, &mut 0) });
    assert_call_rejected(&fmu, &["fmi2GetInteger", "NULL"], |f, c| unsafe { (f.get_integer)(c, r, 1, null_mut()) });
    assert_call_rejected(&fmu, &["fmi2GetBoolean", "NULL"], |f, c| unsafe { (f.get_boolean)(c, null(), 1, &mut 0) });
    assert_call_rejected(&fmu, &["fmi2GetBoolean", "NULL"], |f, c| unsafe { (f.get_boolean)(c, r, 1, null_mut()) });
    assert_call_rejected(&fmu, &["fmi2GetString", "NULL"], |f, c| unsafe { (f.get_string)(c, null(), 1, &mut null()) });
    assert_call_rejected(&fmu, &["fmi2GetString", "NULL"], |f, c| unsafe { (f.get_string)(c, r, 1, null_mut()) });
    assert_call_rejected(&fmu, &["fmi2SetReal", "NULL"], |f, c| unsafe { (f.set_real)(c, null(), 1, &0.0) });
    assert_call_rejected(&fmu, &["fmi2SetReal", "NULL"], |f, c| unsafe { (f.set_real)(c, r, 1, null()) });
    assert_call_rejected(&fmu, &["fmi2SetInteger", "NULL"], |f, c| unsafe { (f.set_integer)(c, null(), 1, &0) });
    assert_call_rejected(&fmu, &["fmi2SetInteger", "NULL"], |f, c| unsafe { (f.set_integer)(c, r, 1, null()) });
    assert_call_rejected(&fmu, &["fmi2SetBoolean", "NULL"], |f, c| unsafe { (f.set_boolean)(c, null(), 1, &0) });
    assert_call_rejected(&fmu, &["fmi2SetBoolean", "NULL"], |f, c| unsafe { (f.set_boolean)(c, r, 1, null()) });
    assert_call_rejected(&fmu, &["fmi2SetString", "NULL"], |f, c| unsafe { (f.set_string)(c, null(), 1, &c"".as_ptr()) });
    assert_call_rejected(&fmu, &["fmi2SetString", "NULL"], |f, c| unsafe { (f.set_string)(c, r, 1, null()) });
    assert_call_rejected(&fmu, &["fmi2SetRealInputDerivatives", "NULL"], |f, c| unsafe { (f.set_input_derivatives)(c, null(), 1, &1, &0.0) });
    assert_call_rejected(&fmu, &["fmi2SetRealInputDerivatives", "NULL"], |f, c| unsafe { (f.set_input_derivatives)(c, r, 1, null(), &0.0) });
    assert_call_rejected(&fmu, &["fmi2SetRealInputDerivatives", "NULL"], |f, c| unsafe { (f.set_input_derivatives)(c, r, 1, &1, null()) });
    assert_call_rejected(&fmu, &["fmi2SetDebugLogging", "NULL"], |f, c| unsafe { (f.set_debug_logging)(c, 1, 1, null()) });
    assert_call_rejected(&fmu, &["fmi2SetDebugLogging", "NULL"], |f, c| unsafe { (f.set_debug_logging)(c, 1, 1, &null()) });
}

#[test]
fn strings_are_neither_null_nor_broken() {
    let fmu = Fmu::probe();
    for broken in [null(), c"\xff".as_ptr()] {
        let instance = Instance::in_phase(&fmu, Phase::Initialization);
        let status = unsafe { (fmu.set_string)(instance.component, &fmu.reference("label"), 1, &broken) };
        instance.assert_rejected(status, ERROR, &["fmi2SetString", "NULL or not UTF-8"]);
        assert_eq!(instance.text("label"), "100 % <probe>");
    }
}

#[test]
#[rustfmt::skip]
fn references_that_do_not_exist_are_named() {
    let fmu = Fmu::probe();
    for reference in [fmu.count(), fmu.count() + 1, 1 << 31, u32::MAX] {
        let (name, last) = (reference.to_string(), format!("0 .. {}", fmu.count() - 1));
        let r = &reference;
        assert_call_rejected(&fmu, &["fmi2GetReal", &name, &last], |f, c| unsafe { (f.get_real)(c, r, 1, &mut 0.0) });
        assert_call_rejected(&fmu, &["fmi2GetInteger", &name, &last], |f, c| unsafe { (f.get_integer)(c, r, 1, &mut 0) });
        assert_call_rejected(&fmu, &["fmi2GetBoolean", &name, &last], |f, c| unsafe { (f.get_boolean)(c, r, 1, &mut 0) });
        assert_call_rejected(&fmu, &["fmi2GetString", &name, &last], |f, c| unsafe { (f.get_string)(c, r, 1, &mut null()) });
        assert_call_rejected(&fmu, &["fmi2SetReal", &name, &last], |f, c| unsafe { (f.set_real)(c, r, 1, &0.0) });
        assert_call_rejected(&fmu, &["fmi2SetInteger", &name, &last], |f, c| unsafe { (f.set_integer)(c, r, 1, &0) });
        assert_call_rejected(&fmu, &["fmi2SetBoolean", &name, &last], |f, c| unsafe { (f.set_boolean)(c, r, 1, &0) });
        assert_call_rejected(&fmu, &["fmi2SetString", &name, &last], |f, c| unsafe { (f.set_string)(c, r, 1, &c"".as_ptr()) });
        assert_call_rejected(&fmu, &["fmi2SetRealInputDerivatives", &name, &last], |f, c| unsafe { (f.set_input_derivatives)(c, r, 1, &1, &0.0) });
    }
}

/// One variable of each type, and the name of the functions that fit.
const TYPED: [(&str, &str); 5] =
    [("position", "Real"), ("count", "Integer"), ("enable", "Boolean"), ("label", "String"), ("mode", "Integer")];

#[test]
fn wrong_types_are_rejected_with_the_right_function() {
    let fmu = Fmu::probe();
    for (name, fitting) in TYPED {
        let r = &fmu.reference(name);
        for used in ["Real", "Integer", "Boolean", "String"] {
            if used == fitting {
                continue;
            }
            let quoted = format!("`{name}`");
            let hint = format!("fmi2Get{fitting}");
            assert_call_rejected(&fmu, &[&format!("fmi2Get{used}"), &quoted, &hint], |f, c| unsafe {
                match used {
                    "Real" => (f.get_real)(c, r, 1, &mut 0.0),
                    "Integer" => (f.get_integer)(c, r, 1, &mut 0),
                    "Boolean" => (f.get_boolean)(c, r, 1, &mut 0),
                    _ => (f.get_string)(c, r, 1, &mut null()),
                }
            });
            assert_call_rejected(&fmu, &[&format!("fmi2Set{used}"), &quoted, &hint], |f, c| unsafe {
                match used {
                    "Real" => (f.set_real)(c, r, 1, &0.0),
                    "Integer" => (f.set_integer)(c, r, 1, &1),
                    "Boolean" => (f.set_boolean)(c, r, 1, &0),
                    _ => (f.set_string)(c, r, 1, &c"".as_ptr()),
                }
            });
        }
    }
}

#[test]
fn null_result_pointers_are_an_error() {
    let fmu = Fmu::probe();
    assert_call_rejected(&fmu, &["fmi2GetFMUstate", "NULL"], |f, c| unsafe { (f.get_fmu_state)(c, null_mut()) });
    assert_call_rejected(&fmu, &["fmi2SetFMUstate", "NULL"], |f, c| unsafe { (f.set_fmu_state)(c, null_mut()) });
    assert_call_rejected(&fmu, &["fmi2SerializedFMUstateSize", "NULL"], |f, c| unsafe {
        (f.serialized_size)(c, null_mut(), &mut 0)
    });
    assert_call_rejected(&fmu, &["fmi2SerializeFMUstate", "NULL"], |f, c| unsafe {
        (f.serialize)(c, null_mut(), [0; 8].as_mut_ptr(), 8)
    });
    assert_call_rejected(&fmu, &["fmi2DeSerializeFMUstate", "NULL"], |f, c| unsafe {
        (f.deserialize)(c, [0; 8].as_ptr(), 8, null_mut())
    });
    assert_call_rejected(&fmu, &["fmi2DeSerializeFMUstate", "NULL"], |f, c| unsafe {
        (f.deserialize)(c, null(), 8, &mut null_mut())
    });
    assert_call_rejected(&fmu, &["fmi2GetRealStatus", "NULL"], |f, c| unsafe {
        (f.get_real_status)(c, LAST_SUCCESSFUL_TIME, null_mut())
    });
    assert_call_rejected(&fmu, &["fmi2GetBooleanStatus", "NULL"], |f, c| unsafe {
        (f.get_boolean_status)(c, TERMINATED, null_mut())
    });
    let instance = Instance::started(&fmu);
    unsafe {
        assert_eq!((fmu.free_fmu_state)(instance.component, null_mut()), OK);
        assert_eq!((fmu.free_fmu_state)(instance.component, &mut null_mut()), OK);
    }
}

#[test]
fn a_vector_is_given_whole_or_not_at_all() {
    let fmu = Fmu::probe();
    let instance = Instance::started(&fmu);
    let references = [fmu.reference("gain"), fmu.reference("count")];
    let mut reals = [7.0; 2];
    let status = unsafe { (fmu.get_real)(instance.component, references.as_ptr(), 2, reals.as_mut_ptr()) };
    instance.assert_rejected(status, ERROR, &["fmi2GetReal", "`count`"]);
    assert_eq!(reals, [7.0; 2]);
    let (references, mut numbers) = ([fmu.reference("order"), fmu.count()], [7; 2]);
    let status = unsafe { (fmu.get_integer)(instance.component, references.as_ptr(), 2, numbers.as_mut_ptr()) };
    instance.assert_rejected(status, ERROR, &["fmi2GetInteger"]);
    assert_eq!(numbers, [7; 2]);
}

#[test]
fn states_that_are_none_are_found() {
    let fmu = Fmu::probe();
    let nowhere = std::ptr::without_provenance_mut(12_345_678);
    let words = |function| [function, "not a state of this FMU", "hint:"];
    assert_call_rejected(&fmu, &words("fmi2SetFMUstate"), |f, c| unsafe { (f.set_fmu_state)(c, nowhere) });
    assert_call_rejected(&fmu, &words("fmi2SerializedFMUstateSize"), |f, c| unsafe {
        (f.serialized_size)(c, nowhere, &mut 0)
    });
    assert_call_rejected(&fmu, &words("fmi2GetFMUstate"), |f, c| unsafe { (f.get_fmu_state)(c, &mut nowhere.clone()) });
    assert_call_rejected(&fmu, &words("fmi2FreeFMUstate"), |f, c| unsafe {
        (f.free_fmu_state)(c, &mut nowhere.clone())
    });
    // twice freed
    let instance = Instance::started(&fmu);
    let state = instance.take_state();
    instance.free_state(state);
    instance.assert_rejected(instance.put_state(state), ERROR, &words("fmi2SetFMUstate"));
}

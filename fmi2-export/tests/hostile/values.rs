//! Values that are not taken: not finite, out of range, fixed, calculated; all or nothing.

use crate::common::*;
use std::ffi::{CStr, CString};

/// The functions that reach a phase in which parameters and inputs may be set.
const SETTABLE: [Phase; 3] = [Phase::Instantiated, Phase::Initialization, Phase::StepComplete];

#[test]
fn numbers_that_are_not_finite_are_an_error_with_the_name() {
    let fmu = Fmu::probe();
    for value in [f64::NAN, f64::INFINITY, f64::NEG_INFINITY] {
        for name in ["position", "gain", "bias[2]"] {
            for phase in SETTABLE {
                let instance = Instance::in_phase(&fmu, phase);
                let words = ["fmi2SetReal", &format!("`{name}` = {value}"), "not finite"];
                instance.assert_rejected(instance.set_real(name, value), ERROR, &words);
                assert_eq!(instance.end_phase(), Phase::Error);
            }
        }
    }
}

#[test]
fn an_input_that_accepts_nan_takes_every_number() {
    let fmu = Fmu::probe();
    let instance = Instance::started(&fmu);
    for value in [f64::NAN, f64::INFINITY, f64::NEG_INFINITY, -0.0, f64::MIN_POSITIVE / 2.0] {
        assert_eq!(instance.set_real("sensor", value), OK);
        assert_eq!(instance.real("sensor").to_bits(), value.to_bits());
    }
    assert_eq!(instance.step(0.0, 1e-3), OK);
}

#[test]
fn values_out_of_range_are_discarded_and_the_old_one_stays() {
    let fmu = Fmu::probe();
    for (name, value, limits) in [
        ("gain", -1.0, "0.0 .. 1000000.0 N/m"),
        ("gain", 1_000_001.0, "0.0 .. 1000000.0 N/m"),
        ("gain", f64::MAX, "0.0 .. 1000000.0 N/m"),
        ("gain", -f64::from_bits(1), "0.0 .. 1000000.0 N/m"),
    ] {
        for phase in [Phase::Initialization, Phase::StepComplete] {
            let instance = Instance::in_phase(&fmu, phase);
            let words = ["fmi2SetReal", &format!("`{name}` = {value:?}"), limits];
            instance.assert_rejected(instance.set_real(name, value), DISCARD, &words);
            assert_eq!(instance.real(name), 2.0);
            assert_eq!(instance.end_phase(), phase);
        }
    }
    for (name, value, words) in [
        ("order", 0, ["`order` = 0", "1 .. 5"]),
        ("order", 6, ["`order` = 6", "1 .. 5"]),
        ("mode", 0, ["`mode` = 0", "1 Off, 2 Hold, 3 Follow"]),
        ("mode", 4, ["`mode` = 4", "1 Off, 2 Hold, 3 Follow"]),
        ("mode", i32::MIN, ["`mode` = -2147483648", "`Mode`"]),
        ("failure", 6, ["`failure` = 6", "`Failure`"]),
    ] {
        let instance = Instance::in_phase(&fmu, Phase::Initialization);
        let before = instance.integer(name);
        instance.assert_rejected(instance.set_integer(name, value), DISCARD, &words);
        assert_eq!(instance.integer(name), before);
        assert_eq!(instance.end_phase(), Phase::Initialization);
    }
}

#[test]
fn the_limits_themselves_are_taken() {
    let fmu = Fmu::probe();
    let instance = Instance::in_phase(&fmu, Phase::Initialization);
    for value in [0.0, 1e6] {
        assert_eq!((instance.set_real("gain", value), instance.real("gain")), (OK, value));
    }
    for value in [1, 5] {
        assert_eq!((instance.set_integer("order", value), instance.integer("order")), (OK, value));
    }
    for value in [1, 2, 3] {
        assert_eq!((instance.set_integer("mode", value), instance.integer("mode")), (OK, value));
    }
}

#[test]
fn a_vector_is_taken_whole_or_not_at_all() {
    let fmu = Fmu::probe();
    for (last, value, status) in [
        ("gain", -1.0, DISCARD),
        ("position", f64::NAN, ERROR),
        ("natural_frequency", 1.0, ERROR),
        ("count", 1.0, ERROR),
    ] {
        let instance = Instance::in_phase(&fmu, Phase::Initialization);
        let answer = instance.set_reals(&["bias[1]", "bias[3]", last], &[5.0, 6.0, value]);
        instance.assert_rejected(answer, status, &[last]);
        assert_eq!((instance.real("bias[1]"), instance.real("bias[3]")), (0.0, 1.0), "{last}");
    }
    let instance = Instance::in_phase(&fmu, Phase::Initialization);
    instance.assert_rejected(instance.set_integers(&["count", "order"], &[7, 9]), DISCARD, &["`order` = 9"]);
    assert_eq!(instance.integer("count"), 0);
    instance.assert_rejected(instance.set_texts(&["label", "mode"], &[c"new", c"new"]), ERROR, &["`mode`"]);
    assert_eq!(instance.text("label"), "100 % <probe>");
}

#[test]
fn the_last_of_two_values_for_one_variable_counts() {
    let fmu = Fmu::probe();
    let instance = Instance::in_phase(&fmu, Phase::Initialization);
    assert_eq!(instance.set_reals(&["gain", "gain"], &[3.0, 4.0]), OK);
    assert_eq!(instance.real("gain"), 4.0);
}

#[test]
fn fixed_parameters_are_fixed_after_initialization_but_take_their_own_value() {
    let fmu = Fmu::probe();
    type Call = fn(&Instance, bool) -> Status;
    let calls: [(&str, &str, Call); 3] = [
        ("fmi2SetReal", "limits.high", |i, same| i.set_real("limits.high", if same { 10.0 } else { 11.0 })),
        ("fmi2SetInteger", "order", |i, same| i.set_integer("order", if same { 2 } else { 3 })),
        ("fmi2SetString", "label", |i, same| i.set_texts(&["label"], &[if same { c"100 % <probe>" } else { c"x" }])),
    ];
    for (function, name, call) in calls {
        let instance = Instance::started(&fmu);
        assert_eq!(call(&instance, true), OK, "{name}");
        instance.assert_rejected(
            call(&instance, false),
            ERROR,
            &[function, &format!("`{name}`"), "fixed after initialization"],
        );
        assert_eq!(instance.end_phase(), Phase::Error);
        for phase in [Phase::Instantiated, Phase::Initialization] {
            assert_eq!(call(&Instance::in_phase(&fmu, phase), false), OK, "{name}");
        }
    }
}

#[test]
fn the_value_that_was_rejected_is_reported() {
    let fmu = Fmu::probe();
    let instance = Instance::started(&fmu);
    instance.assert_rejected(instance.set_real("limits.high", 11.25), ERROR, &["`limits.high` = 11.25"]);
    let instance = Instance::started(&fmu);
    instance.assert_rejected(instance.set_real("force", 11.25), ERROR, &["`force` = 11.25"]);
    let instance = Instance::started(&fmu);
    instance.assert_rejected(instance.set_real("natural_frequency", 11.25), ERROR, &["`natural_frequency` = 11.25"]);
}

#[test]
fn tunables_work_from_the_next_sample_on() {
    let fmu = Fmu::probe();
    let instance = Instance::started(&fmu);
    assert_eq!(instance.set_real("position", 1.0), OK);
    assert_eq!(instance.step(0.0, 1e-3), OK);
    assert_eq!(instance.real("force"), 3.5);
    assert_eq!(instance.set_reals(&["gain", "bias[1]"], &[4.0, 0.25]), OK);
    assert_eq!(instance.real("force"), 3.5);
    assert_eq!(instance.step(1e-3, 1e-3), OK);
    assert_eq!(instance.real("force"), 5.75);
    assert_eq!(instance.set_integer("mode", 1), OK);
    assert_eq!(instance.step(2e-3, 1e-3), OK);
    assert_eq!((instance.real("force"), instance.integer("active_mode")), (0.0, 1));
}

#[test]
fn a_calculated_parameter_follows_and_cannot_be_set() {
    let fmu = Fmu::probe();
    let instance = Instance::in_phase(&fmu, Phase::Initialization);
    assert_eq!(instance.real("natural_frequency"), 2.0_f64.sqrt());
    assert_eq!(instance.set_real("gain", 9.0), OK);
    assert_eq!(instance.real("natural_frequency"), 3.0);
    assert_eq!(instance.exit(), OK);
    assert_eq!(instance.set_real("gain", 16.0), OK);
    assert_eq!(instance.real("natural_frequency"), 4.0);
    for phase in SETTABLE {
        let instance = Instance::in_phase(&fmu, phase);
        let words = ["`natural_frequency`", "calculated from other parameters"];
        instance.assert_rejected(instance.set_real("natural_frequency", 1.0), ERROR, &words);
    }
}

#[test]
fn outputs_take_a_start_value_until_the_fmu_writes_them() {
    let fmu = Fmu::probe();
    let instance = Instance::in_phase(&fmu, Phase::Initialization);
    assert_eq!(instance.set_real("force", 0.5), OK);
    assert_eq!((instance.exit(), instance.real("force")), (OK, 0.5));
    for name in ["force", "sum"] {
        let instance = Instance::started(&fmu);
        instance.assert_rejected(instance.set_real(name, 1.0), ERROR, &[&format!("`{name}`"), "written by the FMU"]);
    }
}

#[test]
fn every_type_of_value_arrives() {
    let fmu = Fmu::probe();
    let instance = Instance::in_phase(&fmu, Phase::Initialization);
    let label = "\u{b5}m 100 % \"<&>\" \u{1f529}";
    assert_eq!(instance.set_texts(&["label"], &[&CString::new(label).unwrap()]), OK);
    assert_eq!((instance.text("label").as_str(), instance.exit()), (label, OK));
    assert_eq!(instance.set_integer("count", i32::MAX), OK);
    assert_eq!(instance.step(0.0, 1e-3), OK);
    assert_eq!(instance.integer("counted"), i32::MAX);
    assert_eq!(instance.text("text"), format!("{label} at 0 s"));
    // every number but zero is true, as in C
    for (number, expected) in [(0, 0), (1, 1), (7, 1), (-1, 1)] {
        assert_eq!(instance.set_integer("count", 0), OK);
        assert_eq!(instance.set_booleans(&["enable"], &[number]), OK);
        assert_eq!(instance.boolean("enable"), expected);
    }
}

#[test]
fn strings_live_until_the_next_call_for_strings() {
    let fmu = Fmu::probe();
    let instance = Instance::in_phase(&fmu, Phase::Initialization);
    let (reference, mut first) = (fmu.reference("label"), std::ptr::null());
    let text = unsafe {
        assert_eq!((fmu.get_string)(instance.component, &reference, 1, &mut first), OK);
        assert_eq!(instance.set_texts(&["label"], &[c"something much longer than the old text"]), OK);
        assert_eq!(instance.set_real("gain", 3.0), OK);
        CStr::from_ptr(first)
    };
    assert_eq!(text, c"100 % <probe>");
}

//! `law = Paper` gives the values of the paper to what the importer has not set, and to nothing else.

mod common;

use common::*;

const PAPER: i32 = 2;

/// Force at the position 1, and the label, after a step from `time` on.
fn step(instance: &Instance, time: f64) -> (f64, String) {
    assert_eq!(instance.set_real("position", 1.0), OK);
    assert_eq!(instance.step(time, 1e-3), OK);
    let text = instance.text("text");
    (instance.real("force"), text.split(" at ").next().unwrap().to_owned())
}

/// An instance with wide limits that has begun, after `set`.
fn begun<'a>(fmu: &'a Fmu, set: impl FnOnce(&Instance)) -> Instance<'a> {
    let instance = Instance::new(fmu);
    assert_eq!(instance.set_real("limits.high", 100.0), OK);
    set(&instance);
    assert_eq!((instance.setup(0.0, None), instance.enter(), instance.exit()), (OK, OK, OK));
    instance
}

#[test]
fn one_parameter_brings_the_paper_into_force_and_the_parameters_read_as_they_were_set() {
    let fmu = Fmu::probe();
    let instance = begun(&fmu, |instance| assert_eq!(instance.set_integer("law", PAPER), OK));
    assert_eq!(step(&instance, 0.0), (3.0 + 15.0, "probe of the paper".to_owned()));
    assert_eq!(instance.real("natural_frequency"), 3.0_f64.sqrt());
    assert_eq!((instance.real("gain"), instance.text("label")), (2.0, "100 % <probe>".to_owned()));
}

#[test]
fn what_was_set_stays_also_where_it_is_the_start_value() {
    let fmu = Fmu::probe();
    let set = |instance: &Instance| {
        assert_eq!(instance.set_reals(&["gain", "bias[2]"], &[2.0, 0.5]), OK);
        assert_eq!(instance.set_texts(&["label"], &[c"100 % <probe>"]), OK);
    };
    let before = begun(&fmu, |instance| {
        set(instance);
        assert_eq!(instance.set_integer("law", PAPER), OK);
    });
    let after = begun(&fmu, |instance| {
        assert_eq!(instance.set_integer("law", PAPER), OK);
        set(instance);
    });
    // of the array the third element alone is the paper's
    for instance in [before, after] {
        assert_eq!(step(&instance, 0.0), (2.0 + 0.5 + 10.0, "100 % <probe>".to_owned()));
    }
}

#[test]
fn while_running_a_tunable_parameter_counts_as_set_and_a_fixed_one_does_not() {
    let fmu = Fmu::probe();
    let instance = begun(&fmu, |instance| assert_eq!(instance.set_integer("law", PAPER), OK));
    assert_eq!(step(&instance, 0.0).0, 18.0);
    assert_eq!(instance.set_real("gain", 2.0), OK);
    // some importers write fixed parameters again, as they read them
    assert_eq!(instance.set_texts(&["label"], &[c"100 % <probe>"]), OK);
    assert_eq!(step(&instance, 1e-3), (17.0, "probe of the paper".to_owned()));
}

#[test]
fn what_was_set_belongs_to_the_state_and_ends_with_a_reset() {
    let fmu = Fmu::probe();
    let instance = begun(&fmu, |instance| {
        assert_eq!(instance.set_real("gain", 2.0), OK);
        assert_eq!(instance.set_integer("law", PAPER), OK);
    });
    let other = Instance::new(&fmu);
    other.restore(&instance.bytes());
    assert_eq!((step(&instance, 0.0).0, step(&other, 0.0).0), (17.0, 17.0));
    assert_eq!((instance.reset(), instance.set_integer("law", PAPER)), (OK, OK));
    assert_eq!(instance.set_real("limits.high", 100.0), OK);
    assert_eq!((instance.setup(0.0, None), instance.enter(), instance.exit()), (OK, OK, OK));
    assert_eq!(step(&instance, 0.0).0, 18.0);
}

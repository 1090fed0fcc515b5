//! Real inputs with derivatives: extrapolated inside the step, gone after it.

use crate::common::*;

/// Gain 2, biases 0.5 + 1 and samples of 1 ms: the force at a position.
fn force(position: f64) -> f64 {
    2.0 * position + 1.5
}

fn close(a: f64, b: f64) -> bool {
    (a - b).abs() <= 1e-12 * b.abs().max(1.0)
}

/// After a step of 10 ms from `position` on, the input is what the master has set, and the next step holds it.
fn holds(instance: &Instance, position: f64) {
    assert_eq!(instance.real("position"), position);
    assert_eq!(instance.step(1e-2, 1e-2), OK);
    assert!(close(instance.real("force"), force(position)));
}

#[test]
fn ten_samples_of_a_ramp_match_the_closed_form() {
    let fmu = Fmu::probe();
    let instance = Instance::started(&fmu);
    assert_eq!(instance.set_real("position", 0.1), OK);
    assert_eq!(instance.set_derivatives(&["position"], &[1], &[30.0]), OK);
    assert_eq!(instance.step(0.0, 1e-2), OK);
    let last = force(0.1 + 30.0 * 9e-3);
    assert!(close(instance.real("force"), last));
    assert!(close(instance.real("sum"), 10.0 * (force(0.1) + last) / 2.0));
    holds(&instance, 0.1);
}

#[test]
fn derivatives_of_any_order_add_up_to_a_taylor_sum() {
    let fmu = Fmu::probe();
    let instance = Instance::started(&fmu);
    assert_eq!(instance.set_real("position", 0.1), OK);
    // in any order, the later one of two counts
    let (orders, values) = ([3, 1, 2, 2], [6e6, 30.0, 7.0, 4000.0]);
    assert_eq!(instance.set_derivatives(&["position"; 4], &orders, &values), OK);
    assert_eq!(instance.step(0.0, 1e-2), OK);
    let t = 9e-3_f64;
    assert!(close(instance.real("force"), force(0.1 + 30.0 * t + 2000.0 * t.powi(2) + 1e6 * t.powi(3))));
    holds(&instance, 0.1);
}

#[test]
fn extrapolation_counts_from_the_communication_point_not_from_the_sample() {
    let fmu = Fmu::probe();
    let instance = Instance::started(&fmu);
    assert_eq!(instance.step(0.0, 0.25e-3), OK);
    assert_eq!(instance.set_derivatives(&["position"], &[1], &[1000.0]), OK);
    assert_eq!(instance.step(0.25e-3, 1e-3), OK);
    assert_eq!(instance.integer("ticks"), 2);
    assert!(close(instance.real("force"), force(1000.0 * 0.75e-3)), "{}", instance.real("force"));
}

#[test]
fn the_last_derivative_counts_and_belongs_to_the_state() {
    let fmu = Fmu::probe();
    let instance = Instance::in_phase(&fmu, Phase::Initialization);
    assert_eq!(instance.set_derivatives(&["position"], &[1], &[5.0]), OK);
    assert_eq!(instance.set_derivatives(&["position"], &[1], &[10.0]), OK);
    assert_eq!(instance.exit(), OK);
    let bytes = instance.bytes();
    let fresh = Instance::new(&fmu);
    fresh.restore(&bytes);
    for instance in [&instance, &fresh] {
        assert_eq!(instance.step(0.0, 2e-3), OK);
        assert!(close(instance.real("force"), force(10.0 * 1e-3)));
    }
}

#[test]
fn what_cannot_be_extrapolated_is_rejected_whole() {
    let fmu = Fmu::probe();
    for (name, order, value, words) in [
        ("sensor", 0, 1.0, ["`sensor`", "order 0"]),
        ("sensor", -1, 1.0, ["`sensor`", "order -1"]),
        ("sensor", 1, f64::NAN, ["`sensor`", "NaN"]),
        ("sensor", 1, f64::INFINITY, ["`sensor`", "inf"]),
        ("gain", 1, 1.0, ["`gain`", "no Real input"]),
        ("force", 1, 1.0, ["`force`", "no Real input"]),
        ("count", 1, 1.0, ["`count`", "no Real input"]),
    ] {
        let instance = Instance::started(&fmu);
        let state = instance.take_state();
        let status = instance.set_derivatives(&["position", name], &[1, order], &[1.0, value]);
        instance.assert_rejected(status, ERROR, &[&["fmi2SetRealInputDerivatives"][..], &words[..]].concat());
        // the valid derivative in the same call was not taken
        let after = instance.bytes();
        assert_eq!(instance.put_state(state), OK);
        let before = instance.bytes();
        assert_eq!(before.len(), after.len());
        assert_eq!(instance.step(0.0, 1e-2), OK);
        assert!(close(instance.real("force"), force(0.0)));
        instance.free_state(state);
    }
}

#[test]
fn a_ramp_that_leaves_the_numbers_does_not_leave_the_fmu() {
    let fmu = Fmu::probe();
    let instance = Instance::started(&fmu);
    assert_eq!(instance.set_real("position", f64::MAX), OK);
    assert_eq!(instance.set_derivatives(&["position"], &[1], &[f64::MAX]), OK);
    // 10 samples lie in it, and the second already has no number
    let words = ["`position` = inf at t = 0.001 s", "(order 1)", "hint:"];
    instance.assert_rejected(instance.step(0.0, 0.01), ERROR, &words);
    for name in ["position", "force", "sum"] {
        assert!(instance.real(name).is_finite(), "{name} = {}", instance.real(name));
    }
}

#[test]
fn a_sensor_that_has_failed_is_not_extrapolated() {
    let fmu = Fmu::probe();
    let instance = Instance::started(&fmu);
    assert_eq!(instance.set_real("sensor", f64::INFINITY), OK);
    assert_eq!(instance.set_derivatives(&["sensor"], &[1], &[-1.0]), OK);
    assert_eq!(instance.step(0.0, 0.01), OK);
    assert_eq!(instance.real("sensor"), f64::INFINITY);
}

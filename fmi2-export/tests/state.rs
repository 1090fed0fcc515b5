//! Taken states and state bytes reproduce a run bit for bit, in other instances and processes too.
#![allow(clippy::undocumented_unsafe_blocks, reason = "each is one call of the C API with pointers that live")]

mod common;

use common::*;
use std::io::{Read, Write};
use std::process::{Command, Stdio};

/// All outputs after each of 50 steps of odd length from `time` on, with inputs that keep changing.
fn go_on(instance: &Instance, mut time: f64) -> Vec<(Vec<u64>, Vec<i32>, String)> {
    let run = (0..50_u32).map(|k| {
        let step = 0.3e-3 * f64::from(1 + k % 7);
        assert_eq!(instance.set_real("position", (f64::from(k) * 0.37).sin()), OK);
        assert_eq!(instance.set_integer("count", k as i32), OK);
        assert_eq!(instance.set_booleans(&["enable"], &[(k % 2) as i32]), OK);
        if k % 5 == 0 {
            assert_eq!(instance.set_derivatives(&["position"], &[1], &[f64::from(k)]), OK);
        }
        assert_eq!(instance.step(time, step), OK);
        time += step;
        instance.outputs()
    });
    run.collect()
}

/// An instance in the middle of a run at 0.0123 s, with parameters that are not the start values.
fn halfway(fmu: &Fmu) -> Instance<'_> {
    let instance = Instance::new(fmu);
    assert_eq!(instance.set_reals(&["sample_period", "bias[2]"], &[0.7e-3, -0.3]), OK);
    assert_eq!(instance.set_texts(&["label"], &[c"a label \u{b5}"]), OK);
    assert_eq!((instance.setup(0.0, Some(10.0)), instance.enter(), instance.exit()), (OK, OK, OK));
    assert_eq!(instance.set_real("position", 0.1), OK);
    assert_eq!(instance.step(0.0, 0.0123), OK);
    instance
}

const HALFWAY: f64 = 0.0123;

#[test]
fn a_rollback_repeats_the_run() {
    let fmu = Fmu::probe();
    let instance = halfway(&fmu);
    let state = instance.take_state();
    let first = go_on(&instance, HALFWAY);
    for _ in 0..3 {
        assert_eq!(instance.put_state(state), OK);
        assert_eq!(go_on(&instance, HALFWAY), first);
    }
    assert!(first.first() != first.last());
    instance.free_state(state);
}

#[test]
fn a_state_moves_to_another_instance_and_leaves_the_first_alone() {
    let fmu = Fmu::probe();
    let (one, other) = (halfway(&fmu), Instance::new(&fmu));
    let state = one.take_state();
    assert_eq!(other.put_state(state), OK);
    one.free_state(state);
    assert_eq!(go_on(&one, HALFWAY), go_on(&other, HALFWAY));
}

#[test]
fn a_state_ends_with_the_instance_that_made_it() {
    let fmu = Fmu::probe();
    let (one, other) = (halfway(&fmu), Instance::new(&fmu));
    let state = one.take_state();
    drop(one);
    other.assert_rejected(other.put_state(state), ERROR, &["fmi2SetFMUstate", "freed"]);
}

#[test]
fn a_pointer_that_holds_a_state_is_used_again() {
    let fmu = Fmu::probe();
    let instance = halfway(&fmu);
    let mut state = instance.take_state();
    let old = state;
    go_on(&instance, HALFWAY);
    let later = instance.outputs();
    assert_eq!(unsafe { (fmu.get_fmu_state)(instance.component, &mut state) }, OK);
    assert_eq!(state, old);
    assert_eq!(instance.reset(), OK);
    assert_eq!(instance.put_state(state), OK);
    assert_eq!(instance.outputs(), later);
    instance.free_state(state);
}

#[test]
fn bytes_in_a_fresh_instance_go_on_as_the_old_one() {
    let fmu = Fmu::probe();
    let instance = halfway(&fmu);
    let bytes = instance.bytes();
    let first = go_on(&instance, HALFWAY);
    let fresh = Instance::new(&fmu);
    fresh.restore(&bytes);
    assert_eq!(fresh.bytes(), bytes);
    assert_eq!(go_on(&fresh, HALFWAY), first);
}

#[test]
fn every_phase_survives_as_bytes() {
    let fmu = Fmu::probe();
    for phase in PHASES {
        let fresh = Instance::new(&fmu);
        fresh.restore(&Instance::in_phase(&fmu, phase).bytes());
        assert_eq!(fresh.end_phase(), phase);
    }
}

#[test]
fn bytes_keep_their_size_over_a_run() {
    let fmu = Fmu::probe();
    let instance = halfway(&fmu);
    let size = instance.bytes().len();
    assert_eq!(size % 256, 0);
    go_on(&instance, HALFWAY);
    assert_eq!(instance.bytes().len(), size);
}

/// Name of the variable that makes this test program the second process.
const SECOND: &str = "FMI2_EXPORT_SECOND_PROCESS";

#[test]
fn bytes_go_on_in_another_process() {
    let fmu = Fmu::probe();
    let instance = halfway(&fmu);
    let bytes = instance.bytes();
    let first = format!("{:?}", go_on(&instance, HALFWAY));
    let mut child = Command::new(std::env::current_exe().unwrap())
        .args(["--exact", "second_process", "--nocapture"])
        .env(SECOND, "1")
        .stdin(Stdio::piped())
        .stdout(Stdio::piped())
        .spawn()
        .unwrap();
    child.stdin.take().unwrap().write_all(&bytes).unwrap();
    let output = child.wait_with_output().unwrap();
    let text = String::from_utf8(output.stdout).unwrap();
    assert!(output.status.success(), "{text}");
    assert_eq!(between(&text, "<<", ">>"), first);
}

/// The other half of [`bytes_go_on_in_another_process`]; alone it has nothing to do.
#[test]
fn second_process() {
    if std::env::var_os(SECOND).is_none() {
        return;
    }
    let mut bytes = Vec::new();
    std::io::stdin().read_to_end(&mut bytes).unwrap();
    let fmu = Fmu::probe();
    let instance = Instance::new(&fmu);
    instance.restore(&bytes);
    println!("<<{:?}>>", go_on(&instance, HALFWAY));
}

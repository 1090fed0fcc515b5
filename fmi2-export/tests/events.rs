//! Time events and steps are two ways to the same samples.

mod common;

use common::*;

/// A position that no two samples share.
fn position(k: u32) -> f64 {
    (f64::from(k) * 0.37).sin()
}

/// The outputs of 200 samples from `start` on, by time events.
fn by_events(instance: &Instance, start: f64, period: f64) -> Vec<(Vec<u64>, Vec<i32>, String)> {
    assert_eq!(instance.set_real("sample_period", period), OK);
    assert_eq!((instance.setup(start, None), instance.enter(), instance.exit()), (OK, OK, OK));
    let mut next = start;
    let run = (0..200).map(|k| {
        // as an integrator does: ahead, back, and then to the event
        if k > 0 {
            assert_eq!((instance.set_time(next + 0.3 * period), instance.set_real("position", 99.0)), (OK, OK));
            assert_eq!((instance.set_time(next), instance.enter_event_mode()), (OK, OK));
        }
        assert_eq!((instance.set_real("position", position(k)), instance.set_integer("count", k as i32)), (OK, OK));
        let (status, next_event) = instance.new_discrete_states();
        assert_eq!((status, next_event), (OK, start + f64::from(k + 1) * period));
        // another round at the same instant changes nothing
        let outputs = instance.outputs();
        assert_eq!((instance.new_discrete_states(), instance.outputs()), ((OK, next_event), outputs.clone()));
        assert_eq!(instance.enter_continuous_time_mode(), OK);
        next = next_event;
        outputs
    });
    run.collect()
}

fn by_steps(instance: &Instance, start: f64, period: f64) -> Vec<(Vec<u64>, Vec<i32>, String)> {
    assert_eq!(instance.set_real("sample_period", period), OK);
    assert_eq!((instance.setup(start, None), instance.enter(), instance.exit()), (OK, OK, OK));
    let run = (0..200).map(|k| {
        assert_eq!((instance.set_real("position", position(k)), instance.set_integer("count", k as i32)), (OK, OK));
        assert_eq!(instance.step(start + f64::from(k) * period, period), OK);
        instance.outputs()
    });
    run.collect()
}

#[test]
fn events_give_the_samples_of_steps_bit_for_bit() {
    let fmu = Fmu::probe();
    for (start, period) in [(0.0, 1e-3), (0.1, 1e-4), (-2.0, 1.0 / 3.0), (1e6, 0.7e-3)] {
        let (events, steps) = (Instance::of_type(&fmu, MODEL_EXCHANGE), Instance::new(&fmu));
        let outputs = by_events(&events, start, period);
        assert_eq!(outputs, by_steps(&steps, start, period));
        assert!(outputs.windows(2).all(|pair| pair[0] != pair[1]));
    }
}

#[test]
fn a_state_taken_between_events_goes_on_bit_for_bit() {
    let fmu = Fmu::probe();
    let instance = Instance::at_first_event(&fmu);
    assert_eq!((instance.new_discrete_states(), instance.enter_continuous_time_mode()), ((OK, 1e-3), OK));
    for k in 1..20 {
        assert_eq!(instance.set_real("position", position(k)), OK);
        instance.event(f64::from(k) * 1e-3);
    }
    assert_eq!(instance.set_time(19.4e-3), OK);
    let (state, bytes) = (instance.take_state(), instance.bytes());
    let go_on = |instance: &Instance| {
        let run = (20..60).map(|k| {
            assert_eq!(instance.set_real("position", position(k)), OK);
            instance.event(f64::from(k) * 1e-3);
            instance.outputs()
        });
        run.collect::<Vec<_>>()
    };
    let first = go_on(&instance);
    assert_eq!(instance.put_state(state), OK);
    assert_eq!(go_on(&instance), first);
    instance.free_state(state);
    let fresh = Instance::of_type(&fmu, MODEL_EXCHANGE);
    fresh.restore(&bytes);
    assert_eq!(go_on(&fresh), first);
}

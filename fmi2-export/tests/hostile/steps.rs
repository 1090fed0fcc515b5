//! Communication points, step sizes, start and stop times that make no sense.

use crate::common::*;

#[test]
fn step_sizes_that_make_no_sense_are_an_error() {
    let fmu = Fmu::probe();
    for step in [0.0, -0.0, -1e-3, f64::NAN, f64::INFINITY, f64::NEG_INFINITY, f64::MIN] {
        let instance = Instance::started(&fmu);
        instance.assert_rejected(
            instance.step(0.0, step),
            ERROR,
            &["fmi2DoStep", &format!("{step} s"), "not positive"],
        );
        assert_eq!(instance.end_phase(), Phase::Error);
    }
    // so long that the call would not return
    for step in [2e6, 1e300, f64::MAX] {
        let instance = Instance::started(&fmu);
        instance.assert_rejected(
            instance.step(0.0, step),
            ERROR,
            &["fmi2DoStep", &format!("{step} s"), "sample periods"],
        );
        assert_eq!(instance.integer("ticks"), 0);
    }
}

#[test]
fn a_communication_point_away_from_the_last_step_is_an_error() {
    let fmu = Fmu::probe();
    for time in [1e-3, -1e-3, 1.0, 1e300, f64::NAN, f64::INFINITY, f64::NEG_INFINITY] {
        let instance = Instance::started(&fmu);
        instance.assert_rejected(
            instance.step(time, 1e-3),
            ERROR,
            &["fmi2DoStep", &format!("{time} s"), "end of the last step"],
        );
        assert_eq!(instance.integer("ticks"), 0);
    }
    let instance = Instance::started(&fmu);
    assert_eq!(instance.step(0.0, 1e-3), OK);
    instance.assert_rejected(instance.step(0.0, 1e-3), ERROR, &["0 s", "0.001 s"]);
}

#[test]
fn accumulated_rounding_of_time_is_taken() {
    let fmu = Fmu::probe();
    let instance = Instance::in_phase(&fmu, Phase::Initialization);
    assert_eq!(instance.exit(), OK);
    let (step, mut time) = (1e-3, 0.0);
    for _ in 0..100_000 {
        assert_eq!(instance.step(time, step), OK, "{time}");
        time += step;
    }
    assert!(time != 100.0, "this sum was chosen because it is rounded");
    assert_eq!(instance.integer("ticks"), 100_000);
    // a master that computes k h continues where one that adds has arrived
    assert_eq!(instance.step(100.0, step), OK);
}

#[test]
fn a_master_whose_time_runs_away_from_the_clock_is_reported() {
    let fmu = Fmu::probe();
    for (rate, limit) in [(1.009, 3), (0.991, 3), (1.0001, 200), (1.0 + 1e-6, 20_000)] {
        let instance = Instance::started(&fmu);
        let assert_rejected = (0..limit).find(|k| instance.step(f64::from(*k) * 1e-3 * rate, 1e-3) != OK);
        let assert_rejected = assert_rejected.unwrap_or_else(|| panic!("{limit} steps at the rate {rate} were taken"));
        let [message] = &instance.messages()[..] else { panic!("one message expected") };
        assert!(message.text.contains("is not the end of the last step"), "{}", message.text);
        assert_eq!(instance.integer("ticks"), assert_rejected);
    }
}

#[test]
fn the_stop_time_is_kept_with_a_tolerance_for_rounding() {
    let fmu = Fmu::probe();
    let started = || {
        let instance = Instance::new(&fmu);
        assert_eq!((instance.setup(0.0, Some(0.01)), instance.enter(), instance.exit()), (OK, OK, OK));
        (0..9).for_each(|k| assert_eq!(instance.step(f64::from(k) * 1e-3, 1e-3), OK));
        instance
    };
    for last in [1e-3, 1e-3 * (1.0 + 1e-9), 1e-3 * (1.0 - 1e-9), 0.5e-3] {
        assert_eq!(started().step(9e-3, last), OK, "{last}");
    }
    for last in [1.001e-3, 1e-2, 1.0] {
        let instance = started();
        let words = ["fmi2DoStep", "0.009 s", &format!("{last} s"), "stop time 0.01 s"];
        instance.assert_rejected(instance.step(9e-3, last), ERROR, &words);
        assert_eq!((instance.integer("ticks"), instance.end_phase()), (9, Phase::Error));
    }
}

#[test]
fn without_a_stop_time_its_value_is_not_read() {
    let fmu = Fmu::probe();
    let instance = Instance::new(&fmu);
    assert_eq!(unsafe { (fmu.setup_experiment)(instance.component, 0, 0.0, 0.0, 0, -1.0) }, OK);
    assert_eq!((instance.enter(), instance.exit(), instance.step(0.0, 1.0)), (OK, OK, OK));
}

#[test]
fn experiments_that_make_no_sense_are_an_error() {
    let fmu = Fmu::probe();
    for (start, stop, words) in [
        (f64::NAN, None, "start time NaN"),
        (f64::INFINITY, None, "start time inf"),
        (0.0, Some(f64::NAN), "stop time NaN"),
        (1.0, Some(0.5), "stop time 0.5"),
        (0.0, Some(f64::NEG_INFINITY), "stop time -inf"),
    ] {
        let instance = Instance::new(&fmu);
        instance.assert_rejected(instance.setup(start, stop), ERROR, &["fmi2SetupExperiment", words]);
    }
    // a stop time that never comes is one
    assert_eq!(Instance::new(&fmu).setup(0.0, Some(f64::INFINITY)), OK);
}

#[test]
fn a_step_too_long_for_a_closed_loop_is_reported_once_and_done() {
    let fmu = Fmu::probe();
    // the probe works up to a million of its sample periods of 1 us
    let started = |instance: &Instance| {
        assert_eq!(instance.set_real("sample_period", 1e-6), OK);
        assert_eq!((instance.setup(0.0, None), instance.enter(), instance.exit()), (OK, OK, OK));
    };
    let instance = Instance::new(&fmu);
    started(&instance);
    assert_eq!((instance.step(0.0, 1.0 + 1e-13), instance.messages().len()), (OK, 0));
    let before = instance.take_state();
    let words = ["t = 1 s", "`1.5 s`", "1500000 sample periods of `0.000001 s`", "up to 1000000", "\nhint: set"];
    instance.assert_rejected(instance.step(1.0, 1.5), WARNING, &words);
    assert_eq!(instance.integer("ticks"), 2_500_000);
    assert_eq!((instance.step(2.5, 1.5), instance.messages().len()), (OK, 0));
    // a master that moves back already received the warning; a reset makes a new instance
    assert_eq!((instance.put_state(before), instance.step(1.0, 1.5), instance.messages().len()), (OK, OK, 0));
    instance.free_state(before);
    assert_eq!(instance.reset(), OK);
    started(&instance);
    instance.assert_rejected(instance.step(0.0, 1.5), WARNING, &words[1..]);
}

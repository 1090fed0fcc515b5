//! What would be silent without a monitor, on the default law: a broken encoder, a late job, a second fault.

use fmu_centering::interface::{Fault, Input, Parameters, State};

use crate::ring::{AT_PUSHER, Ring};
use crate::run::{Loop, running};

const P: Parameters = Parameters::START;

/// Steps with changed inputs to a fault within 10 s; the ring must neither be called centred nor be moved outwards.
fn faulted(mut run: Loop, fault: Fault, change: impl Fn(u32, &mut Input)) -> Loop {
    let begin = run.ring.eccentricity();
    for k in 0..10_000 {
        run.step_with(|input| change(k, input));
        assert!(run.output.state != State::Centred, "{:?}", run.output);
        assert!(run.ring.eccentricity() < begin + 1e-6, "{k}: {begin} m, {:?} {:?}", run.output, run.ring.centre);
        if run.output.state == State::Fault {
            assert_eq!(run.output.fault, fault, "{:?}", run.output);
            return run;
        }
    }
    panic!("{:?}", run.output);
}

#[test]
fn the_default_law_centres() {
    for (seed, eccentricity, sense) in [(1, 2e-4, 1.0), (2, 5e-4, -1.0), (3, 3e-3, 1.0)] {
        let mut ring = Ring::new(seed, eccentricity, 0.5);
        ring.speed *= sense;
        let mut run = Loop::new(&P, ring);
        assert!(run.run_to(State::Centred, 20.0), "{:?}", run.output);
        assert!(run.ring.eccentricity() < P.tolerance, "{} m", run.ring.eccentricity());
        assert!((run.output.monitor.probe_share - 1.0).abs() < 0.01 && run.output.drive_enable);
    }
}

#[test]
fn a_jammed_probe_is_never_a_centred_ring_however_coarse_it_is() {
    for bit in [0.0, 5e-8, 1e-6, 5e-6] {
        for state in [State::Follow, State::Collect, State::Wait, State::Settle] {
            let run = running(&P, state);
            let jammed = AT_PUSHER - run.output.pusher_gap;
            faulted(run, Fault::FrozenReading, |k, input| {
                input.probe_position = jammed + if k % 2 == 0 { bit } else { 0.0 };
            });
        }
    }
}

#[test]
fn a_probe_with_another_scale_pushes_nothing() {
    for scale in [0.7, 1.4] {
        let mut run = Loop::new(&P, Ring::new(1, 5e-4, 0.5));
        (0..5).for_each(|_| run.step());
        faulted(run, Fault::FrozenReading, |_, input| input.probe_position *= scale);
    }
}

#[test]
fn an_encoder_of_the_slide_that_stands_ends_a_stroke_before_the_ring() {
    let run = running(&P, State::Push);
    let stands = run.output.slide.position_setpoint;
    let run = faulted(run, Fault::LostReading, |_, input| input.slide_position = stands);
    assert!(!run.output.drive_enable && run.ring.gap() > 5e-3, "{} m", run.ring.gap());
}

#[test]
fn a_centring_that_is_too_long_ends_with_a_name() {
    let mut p = P;
    p.limits.job_time = 2.0;
    let mut run = Loop::new(&p, Ring::new(1, 5e-4, 0.5));
    assert!(run.run_to(State::Fault, 5.0), "{:?}", run.output);
    assert_eq!(run.output.fault, Fault::NoProgress);
    assert!((2.0..2.003).contains(&run.output.monitor.job_time), "{}", run.output.monitor.job_time);
}

#[test]
fn a_second_fault_on_the_way_back_switches_the_drive_off_and_a_lighter_one_does_not_take_that_back() {
    let mut run = running(&P, State::Wait);
    run.step_with(|input| input.probe_position = f64::NAN);
    (0..50).for_each(|_| run.step());
    assert!(run.output.fault == Fault::InvalidInput && run.output.drive_enable);
    run.step_with(|input| input.slide_position = f64::NAN);
    let lost = |run: &Loop| run.output.fault == Fault::LostReading && !run.output.drive_enable;
    assert!(lost(&run), "{:?}", run.output);
    run.step_with(|input| input.probe_position = f64::NAN);
    assert!(lost(&run), "{:?}", run.output);
    // the setpoint goes with the slide, so the drive comes back without a step
    (0..200).for_each(|_| run.step());
    assert!((run.output.slide.position_setpoint - run.ring.slide()).abs() < 1e-6);
    run.step_with(|input| input.reset_fault = true);
    assert!(run.output.state == State::Idle && run.output.drive_enable, "{:?}", run.output);
}

#[test]
fn an_enable_that_stands_from_the_first_sample_on_begins_nothing() {
    let mut run = Loop::new(&P, Ring::new(1, 5e-4, 0.5));
    (0..100).for_each(|_| run.step_with(|input| input.enable = true));
    assert_eq!((run.output.state, run.output.slide.position_setpoint), (State::Idle, 0.0));
}

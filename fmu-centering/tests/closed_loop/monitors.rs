//! Faults that only monitors detect, with the default control law: a broken encoder, a late cycle, a second fault.

use fmu_centering::interface::{Fault, Input, Parameters, State};

use crate::ring::{AT_PUSHER, NOMINAL, Ring, Servo};
use crate::run::{Loop, running};

const P: Parameters = Parameters::START;

/// Steps with changed inputs to a fault within 10 s; the ring must neither be called centered nor be moved outwards.
fn faulted(mut run: Loop, fault: Fault, change: impl Fn(u32, &mut Input)) -> Loop {
    let begin = run.ring.eccentricity();
    for k in 0..10_000 {
        run.step_with(|input| change(k, input));
        assert!(run.output.state != State::Centered, "{:?}", run.output);
        assert!(run.ring.eccentricity() < begin + 1e-6, "{k}: {begin} m, {:?} {:?}", run.output, run.ring.center);
        if run.output.state == State::Fault {
            assert_eq!(run.output.fault, fault, "{:?}", run.output);
            return run;
        }
    }
    panic!("{:?}", run.output);
}

#[test]
fn the_default_law_centers() {
    for (seed, eccentricity, sense) in [(1, 2e-4, 1.0), (2, 5e-4, -1.0), (3, 3e-3, 1.0)] {
        let mut ring = Ring::new(seed, eccentricity, 0.5);
        ring.speed *= sense;
        let mut run = Loop::new(&P, ring);
        assert!(run.run_to(State::Centered, 20.0), "{:?}", run.output);
        assert!(run.ring.eccentricity() < P.tolerance, "{} m", run.ring.eccentricity());
        assert!((run.output.monitor.probe_gain_ratio - 1.0).abs() < 0.01 && run.output.drive_enable);
    }
}

#[test]
fn a_jammed_probe_is_never_a_centered_ring_however_coarse_it_is() {
    for state in [State::Follow, State::Collect, State::Wait, State::Settle] {
        let run = running(&P, state);
        let jammed = AT_PUSHER - run.output.pusher_gap;
        for bit in [0.0, 5e-8, 1e-6, 5e-6] {
            faulted(run.clone(), Fault::ProbeFrozen, |k, input| {
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
        faulted(run, Fault::ProbeFrozen, |_, input| input.probe_position *= scale);
    }
}

/// Centers at 45 rpm with a probe signal that is delayed by `late` samples from `state` on; returns the fault, if any,
/// and the eccentricity at the end, m.
fn with_late_probe(late: usize, state: State) -> (Fault, f64) {
    let mut ring = Ring::new(1, 5e-4, 0.5);
    ring.speed = 4.71;
    let mut run = Loop::new(&P, ring);
    assert!(run.run_to(state, 10.0), "{:?}", run.output);
    let mut delayed = std::collections::VecDeque::new();
    while !matches!(run.output.state, State::Fault | State::Centered) {
        run.step_with(|input| {
            delayed.push_front(input.probe_position);
            delayed.truncate(late + 1);
            input.probe_position = *delayed.back().unwrap();
        });
        assert!(run.time() < 30.0, "{:?}", run.output);
    }
    (run.output.fault, run.ring.eccentricity())
}

#[test]
fn a_probe_that_is_late_is_named_before_and_after_a_push() {
    for (late, state) in [(5, State::Approach), (5, State::Push), (10, State::Push)] {
        let (fault, eccentricity) = with_late_probe(late, state);
        assert_eq!(fault, Fault::ProbeDelayed, "{late} {state:?}");
        assert!(eccentricity < 5.1e-4, "{eccentricity} m");
    }
    assert_eq!(with_late_probe(0, State::Approach).0, Fault::None);
}

#[test]
fn a_slide_that_is_late_is_named() {
    let mut ring = Ring::new(1, 5e-4, 0.5);
    ring.speed = 4.71;
    let mut run = Loop::new(&P, ring);
    assert!(run.run_to(State::Approach, 10.0), "{:?}", run.output);
    let mut delayed = std::collections::VecDeque::new();
    while run.output.state != State::Fault {
        run.step_with(|input| {
            delayed.push_front(input.slide_position);
            delayed.truncate(6);
            input.slide_position = *delayed.back().unwrap();
        });
        assert!(run.time() < 30.0 && run.output.state != State::Centered, "{:?}", run.output);
    }
    assert_eq!(run.output.fault, Fault::PositionDelayed);
    assert!((run.output.numbers.probe_delay + 5e-3).abs() < 1e-4, "{:?}", run.output.numbers);
}

#[test]
fn a_pusher_that_meets_the_ring_too_early_is_named_with_its_position() {
    // from there on the ring runs ahead of the slide as fast as that follows
    let met = 0.016;
    let run = running(&P, State::Push);
    let run = faulted(run, Fault::EarlyContact, |_, input| {
        input.probe_position = input.probe_position.min(2.0 * met - input.probe_position);
    });
    assert!((run.output.numbers.met - met).abs() < 2e-4, "{:?}", run.output.numbers);
}

#[test]
fn a_frozen_slide_encoder_ends_a_stroke_before_the_ring() {
    let run = running(&P, State::Push);
    let position = run.output.slide.position_setpoint;
    let run = faulted(run, Fault::PositionFrozen, |_, input| input.slide_position = position);
    assert!(!run.output.drive_enable && run.ring.gap() > 5e-3, "{} m", run.ring.gap());
}

#[test]
fn a_centering_that_is_too_long_ends_with_a_name() {
    let mut p = P;
    p.limits.cycle_time = 2.0;
    let mut run = Loop::new(&p, Ring::new(1, 5e-4, 0.5));
    assert!(run.run_to(State::Fault, 5.0), "{:?}", run.output);
    assert_eq!(run.output.fault, Fault::NoProgress);
    assert!((2.0..2.003).contains(&run.output.monitor.cycle_time), "{}", run.output.monitor.cycle_time);
}

#[test]
fn a_second_fault_during_the_retract_switches_the_drive_off_and_a_less_severe_one_does_not_revert_that() {
    let mut run = running(&P, State::Wait);
    run.spoil(|input| input.probe_position = f64::NAN);
    (0..50).for_each(|_| run.step());
    assert!(run.output.fault == Fault::ProbeLost && run.output.drive_enable);
    run.spoil(|input| input.slide_position = f64::NAN);
    let lost = |run: &Loop| run.output.fault == Fault::PositionLost && !run.output.drive_enable;
    assert!(lost(&run), "{:?}", run.output);
    run.spoil(|input| input.probe_position = f64::NAN);
    assert!(lost(&run), "{:?}", run.output);
    // the setpoint follows the slide, so the drive is enabled again without a step
    (0..200).for_each(|_| run.step());
    assert!((run.output.slide.position_setpoint - run.ring.slide()).abs() < 1e-6);
    run.step_with(|input| input.reset_fault = true);
    assert!(run.output.state == State::Idle && run.output.drive_enable, "{:?}", run.output);
}

#[test]
fn during_the_retract_from_a_failed_probe_the_drive_is_monitored() {
    let spoilt = || {
        let mut run = running(&P, State::Wait);
        run.spoil(|input| input.probe_position = f64::NAN);
        assert_eq!(run.output.fault, Fault::ProbeLost);
        run
    };
    // a good slide retracts, with a probe without signal during the retract and after it responds again
    for dead in [100, 2000] {
        let mut run = spoilt();
        (0..dead).for_each(|_| run.step_with(|input| input.probe_position = f64::NAN));
        (0..2000).for_each(|_| run.step());
        assert_eq!(run.output.fault, Fault::ProbeLost, "{:?}", run.output);
        assert!(run.output.slide.position_setpoint.abs() < 1e-6);
    }
    // one at rest does not
    let mut run = spoilt();
    let position = run.ring.slide();
    let frozen_slide = |input: &mut Input| (input.probe_position, input.slide_position) = (f64::NAN, position);
    (0..100).for_each(|_| run.step_with(frozen_slide));
    assert!(run.output.fault == Fault::PositionFrozen && !run.output.drive_enable, "{:?}", run.output);
}

#[test]
fn a_probe_that_is_off_for_good_after_a_model_has_a_name_before_the_next_push() {
    // the pusher of the published control law is half a millimeter before the ring
    let near = [2e-4, -2e-4, 4e-4, 3e-3, -3e-3];
    let far = [2e-4, -2e-4, 8e-4, -8e-4, 3e-3, -3e-3];
    for (p, offsets) in [(P, &far[..]), (Parameters::PAPER, &near[..])] {
        // the ring is known, and is measured again after a push
        let mut run = running(&p, State::Settle);
        assert!(run.run_to(State::Collect, run.time() + 1.0));
        for &offset in offsets {
            faulted(run.clone(), Fault::ProbeJump, |_, input| input.probe_position += offset);
        }
    }
}

#[test]
fn a_probe_that_loses_the_ring_in_a_stroke_ends_it_and_the_ring_is_centered_later() {
    let push = running(&P, State::Push);
    for (after, free) in [(5, 10), (5, 80), (60, 30), (150, 6), (150, 50)] {
        let mut run = push.clone();
        (0..after).for_each(|_| run.step());
        let mut before = run.output.slide;
        for _ in 0..free {
            run.step_with(|input| input.probe_position = 0.0);
            let step = run.output.slide.velocity_setpoint - before.velocity_setpoint;
            // what is fed back of the surface may change faster
            assert!(step.abs() <= 5e-3, "{after}, {free}: velocity jumps by {step} m/s");
            before = run.output.slide;
        }
        assert_eq!(run.output.state, State::Settle, "{after}, {free}");
        assert!(run.run_to(State::Centered, run.time() + 20.0), "{:?}", run.output);
        assert!(run.ring.eccentricity() < P.tolerance);
    }
}

#[test]
fn a_ring_that_turns_fast_spoils_no_test_of_the_probe() {
    let mut p = P;
    p.tolerance = 5e-4;
    for phase in [0.5, 2.0, 3.5, 5.0] {
        let mut ring = Ring::new(1, 3e-4, phase);
        ring.speed *= 5.0;
        let mut run = Loop::new(&p, ring);
        assert!(run.run_to(State::Centered, 20.0), "{:?}", run.output);
        assert!((run.output.monitor.probe_gain_ratio - 1.0).abs() < 0.05, "{}", run.output.monitor.probe_gain_ratio);
    }
}

#[test]
fn a_probe_that_answers_seven_tenths_of_its_test_is_not_accepted() {
    let run = running(&P, State::Confirm);
    let rest = AT_PUSHER - run.output.pusher_gap;
    let answers = |_, input: &mut Input| input.probe_position = rest + 0.7 * (input.probe_position - rest);
    let run = faulted(run, Fault::ProbeFrozen, answers);
    assert!((run.output.monitor.probe_gain_ratio - 0.7).abs() < 0.02, "{}", run.output.monitor.probe_gain_ratio);
}

#[test]
fn a_servo_that_is_too_slow_has_a_name_where_it_is_learned() {
    let none = Fault::None;
    for (frequency, learned, fault) in [(12.0, true, Fault::SlowServo), (12.0, false, none), (40.0, true, none)] {
        let mut p = P;
        p.learn.servo = learned;
        let mut ring = Ring::new(1, 5e-4, 0.5);
        ring.servo = Some(Servo { frequency, ..NOMINAL });
        let mut run = Loop::new(&p, ring);
        assert_eq!(run.run_to(State::Collect, 5.0), fault == none, "{:?}", run.output);
        assert_eq!(run.output.fault, fault, "{frequency} Hz, learned: {learned}");
    }
}

#[test]
fn a_coarse_probe_that_is_frozen_as_it_touches_does_not_let_the_pusher_meet_the_ring() {
    for frozen in [0.9e-3, 1.05e-3, 1.2e-3, 1.45e-3] {
        let mut run = Loop::new(&P, Ring::new(1, 5e-4, 0.5));
        while AT_PUSHER - run.ring.gap() < frozen {
            run.step_with(|input| input.probe_position = (input.probe_position / 5e-6).round() * 5e-6);
        }
        let run = faulted(run, Fault::ProbeFrozen, |_, input| input.probe_position = frozen);
        assert!(run.ring.gap() > 5e-3, "{} m", run.ring.gap());
    }
}

#[test]
fn an_enable_set_from_the_first_sample_on_starts_nothing() {
    let mut run = Loop::new(&P, Ring::new(1, 5e-4, 0.5));
    (0..100).for_each(|_| run.step_with(|input| input.enable = true));
    assert_eq!((run.output.state, run.output.slide.position_setpoint), (State::Idle, 0.0));
}

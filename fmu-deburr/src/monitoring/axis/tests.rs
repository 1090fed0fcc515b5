use super::*;

/// Axis 3 on a path of constant speed (m/s): what the monitor says, and after how many samples of it.
struct Bench {
    p: Parameters,
    monitor: AxisMonitor,
    drive: LoopState,
    nominal: Nominal,
    sent: control_blocks::SentCommands,
    reference: f64,
    position: f64,
}

impl Bench {
    fn new() -> Self {
        let p = Parameters::START;
        let (mut monitor, nominal) = (AxisMonitor::new(&p, 2), Nominal::new(&p, 2));
        monitor.restart(0.0, p.axis[2].pulse);
        let sent = control_blocks::SentCommands::default();
        Self { p, monitor, drive: LoopState::default(), nominal, sent, reference: 0.0, position: 0.0 }
    }

    /// One sample; `bends` makes of commanded motion and position (counts) what the machine does and what is read.
    fn step(&mut self, speed: f64, expected: Expectation, bends: impl Fn(f64, f64) -> (f64, f64)) -> Outcome {
        let pulse = self.p.axis[2].pulse;
        let commanded = self.sent.before(1) * self.p.sample_period;
        let (moved, seen) = bends(commanded / pulse, self.position);
        // the drive follows its command immediately
        self.position += moved;
        let read = seen + moved;
        let error = self.reference - read;
        let motion = Motion { position: read.floor() * pulse, commanded, error: error * pulse };
        let outcome = self.monitor.look(&self.p, 2, &motion, expected);
        self.reference += speed * self.p.sample_period / pulse;
        let velocity = 13.0 * pulse * (self.reference - read);
        self.sent.send(velocity);
        self.nominal.step(&mut self.drive, self.reference);
        self.monitor.command(&self.p, 2, self.reference.round(), 0.0, velocity);
        outcome
    }

    fn faulted(&mut self, bends: impl Fn(f64, f64) -> (f64, f64)) -> Option<(usize, Finding)> {
        for _ in 0..150 {
            assert_eq!(self.step(0.1, Expectation::Bare, |moved, at| (moved, at)), Outcome::Good);
        }
        (0..300).find_map(|k| match self.step(0.1, Expectation::Bare, &bends) {
            Outcome::Wrong(finding) => Some((k, finding)),
            _ => None,
        })
    }
}

#[test]
fn a_good_axis_is_good_at_any_speed_and_when_it_stops() {
    let mut bench = Bench::new();
    for speed in [0.0, 0.02, 0.5, -0.5, 0.1, 0.0] {
        for _ in 0..100 {
            assert_eq!(bench.step(speed, Expectation::Bare, |moved, at| (moved, at)), Outcome::Good);
        }
    }
}

#[test]
fn drives_within_a_fifth_of_their_gain_are_good() {
    for gain in [0.8, 1.2] {
        assert_eq!(Bench::new().faulted(|moved, at| (gain * moved, at)), None);
    }
}

#[test]
fn a_drive_of_seven_tenths_of_its_gain_is_good_in_a_quick_motion_and_after_it() {
    for gain in [0.7, 2.0] {
        let mut bench = Bench::new();
        for k in 0..300 {
            // 0.22 m in 1.5 s, as to the start of the path, and rest
            let fraction = (f64::from(k) / 150.0).min(1.0);
            let speed = 0.22 / 1.5 * 30.0 * (fraction * (1.0 - fraction)).powi(2);
            let outcome = bench.step(speed, Expectation::Bare, |moved, at| (gain * moved, at));
            assert_eq!(outcome, Outcome::Good, "{gain}, sample {k}");
        }
    }
}

#[test]
fn the_cause_is_named_before_the_consequence() {
    let (k, finding) = Bench::new().faulted(|moved, at| (-moved, at)).unwrap();
    assert_eq!((finding.fault, finding.numbers.axis), (Fault::DriveSign, 3));
    assert!(k < 20, "{k}: {finding:?}");
    let (_, finding) = Bench::new().faulted(|moved, at| (0.3 * moved, at)).unwrap();
    assert_eq!(finding.fault, Fault::WeakDrive);
    assert!((finding.numbers.ratio.unwrap() - 0.3).abs() < 0.05, "{finding:?}");
    let (k, finding) = Bench::new().faulted(|_, at| (0.0, at)).unwrap();
    assert_eq!(finding.fault, Fault::PositionFrozen);
    assert!(k < 8, "{k}: {finding:?}");
}

#[test]
fn what_the_commands_do_not_explain_is_a_following_error() {
    // something pushes with 60 mm/s against the motion
    let (_, finding) = Bench::new().faulted(|moved, at| (moved - 240.0, at)).unwrap();
    assert!(finding.numbers.value > finding.numbers.limit, "{finding:?}");
    assert!(matches!(finding.fault, Fault::FollowingError | Fault::WeakDrive), "{finding:?}");
}

#[test]
fn a_drive_with_an_offset_rests_where_its_command_cancels_it() {
    // 1 and 2 mm/s of 1 m/s, for a minute after a motion
    for offset in [2.0, -2.0, 4.0] {
        let mut bench = Bench::new();
        for k in 0..6000 {
            let speed = if (200..400).contains(&k) { 0.02 } else { 0.0 };
            let outcome = bench.step(speed, Expectation::Bare, |moved, at| (moved + offset, at));
            assert_eq!(outcome, Outcome::Good, "{offset}, sample {k}");
        }
        // and its encoder freezes still
        let outcome = (0..100).map(|_| bench.step(0.02, Expectation::Bare, |_, at| (0.0, at)));
        let Some(Outcome::Wrong(finding)) = outcome.into_iter().find(|outcome| *outcome != Outcome::Good) else {
            panic!()
        };
        assert_eq!(finding.fault, Fault::PositionFrozen);
    }
}

#[test]
fn a_reading_that_freezes_just_before_the_rest_is_reported_before_the_axis_has_crept_a_millimetre() {
    // 0.5 to 0.05 mm are left
    for left in [100.0, 50.0, 10.0] {
        let mut bench = Bench::new();
        for _ in 0..50 {
            bench.step(0.0, Expectation::Bare, |moved, at| (moved, at));
        }
        bench.reference += left;
        let mut crept = 0.0;
        let outcome = (0..4000).map(|_| {
            crept += bench.sent.before(1) * bench.p.sample_period;
            bench.step(0.0, Expectation::Bare, |_, at| (0.0, at))
        });
        let Some(Outcome::Wrong(finding)) = outcome.into_iter().find(|outcome| *outcome != Outcome::Good) else {
            panic!("{left}")
        };
        assert_eq!(finding.fault, Fault::PositionFrozen);
        assert!(crept < 1.6e-3, "{left}: {crept}");
    }
}

#[test]
fn what_no_gain_explains_is_not_the_pattern() {
    let mut bench = Bench::new();
    for _ in 0..50 {
        assert_eq!(bench.step(0.0, Expectation::Compensated, |moved, at| (moved, at)), Outcome::Good);
    }
    // pushed by 10 mm/s at rest: 0.77 mm, more than a pattern leaves and less than `error_max`
    let outcome = (0..200).map(|_| bench.step(0.0, Expectation::Compensated, |moved, at| (moved + 20.0, at)));
    let Some(Outcome::Wrong(finding)) = outcome.into_iter().find(|outcome| *outcome != Outcome::Good) else { panic!() };
    // retracting would move an axis that is not under control
    assert_eq!(finding.fault.reaction(), control_blocks::Reaction::DriveOff, "{finding:?}");
}

#[test]
fn only_what_should_be_compensated_has_the_narrow_limit() {
    let run = |expected| {
        let mut bench = Bench::new();
        (0..100).map(|_| bench.step(0.05, expected, |moved, at| (moved, at))).find(|outcome| *outcome != Outcome::Good)
    };
    assert_eq!(run(Expectation::Bare), None);
    let Some(Outcome::Wrong(finding)) = run(Expectation::Compensated) else { panic!("nothing was found") };
    assert_eq!((finding.fault, finding.numbers.limit), (Fault::PatternMismatch, 5e-4));
}

/// Samples consecutive with a motion until something is said, and what; counted from 1.
fn outcome(expected: Expectation, motion: Motion) -> Option<(usize, Outcome)> {
    let p = Parameters::START;
    let mut monitor = AxisMonitor::new(&p, 2);
    monitor.restart(0.0, p.axis[2].pulse);
    (1..20).map(|k| (k, monitor.look(&p, 2, &motion, expected))).find(|(_, outcome)| *outcome != Outcome::Good)
}

#[test]
fn what_is_wrong_for_the_samples_that_are_bridged_and_one_more_is_reported() {
    let [bare, learned, compensated] = [Expectation::Bare, Expectation::Learned, Expectation::Compensated];
    let motion = |position: f64, error: f64| Motion { position, commanded: 0.0, error };
    for (expected, motion) in [
        (bare, motion(1.1e-3, 0.0)),
        (bare, motion(-1.1e-3, 0.0)),
        (bare, motion(0.0, 1.1e-3)),
        (learned, motion(0.0, -1.1e-3)),
        (compensated, motion(0.0, 5.1e-4)),
        (compensated, motion(0.0, -5.1e-4)),
    ] {
        assert_eq!(outcome(expected, motion).map(|outcome| outcome.0), Some(4), "{expected:?} {motion:?}");
    }
    for (expected, motion) in [
        (bare, motion(9.9e-4, 9.9e-4)),
        (learned, motion(-9.9e-4, -9.9e-4)),
        (compensated, motion(9.9e-4, 4.9e-4)),
        // the limit itself is good
        (compensated, motion(0.0, 5e-4)),
        (bare, motion(0.0, 1e-3)),
    ] {
        assert_eq!(outcome(expected, motion), None, "{expected:?} {motion:?}");
    }
}

#[test]
fn the_consequence_says_what_the_error_is_of() {
    let fault =
        |expected, position: f64, error: f64| match outcome(expected, Motion { position, commanded: 0.0, error })
            .unwrap()
            .1
        {
            Outcome::Wrong(finding) => (finding.fault, finding.numbers.value, finding.numbers.limit),
            outcome => panic!("{outcome:?}"),
        };
    assert_eq!(fault(Expectation::Bare, 1.5e-3, 0.0), (Fault::FollowingError, 1.5e-3, 1e-3));
    assert_eq!(fault(Expectation::Bare, 0.0, -1.5e-3), (Fault::FollowingError, 1.5e-3, 1e-3));
    assert_eq!(fault(Expectation::Compensated, 4e-4, 6e-4), (Fault::PatternMismatch, 6e-4, 5e-4));
    assert_eq!(fault(Expectation::Compensated, -6e-4, 6e-4), (Fault::FollowingError, 6e-4, 5e-4));
    let grown = outcome(Expectation::Learned, Motion { position: 0.0, commanded: 0.0, error: 1.1e-3 });
    assert_eq!(grown.unwrap().1, Outcome::Grown);
}

#[test]
fn half_the_lag_may_be_left_in_the_rest_and_the_residual_is_what_the_model_leaves() {
    let p = Parameters::START;
    let (kp, pulse) = (p.servo_gain[2], p.axis[2].pulse);
    let mut monitor = AxisMonitor::new(&p, 2);
    monitor.restart(0.0, pulse);
    // 0.1 m/s for a sample
    monitor.command(&p, 2, 200.0, 0.0, 0.0);
    assert!((monitor.allowance() - 0.5 * 0.1 / kp).abs() < 1e-12);
    assert_eq!(monitor.residual(0.3, pulse), 0.3 - monitor.model.position() * pulse);
}

#[test]
fn a_compensation_moves_the_model_as_the_reference_does() {
    let p = Parameters::START;
    let mut monitor = AxisMonitor::new(&p, 2);
    monitor.restart(0.0, p.axis[2].pulse);
    (0..300).for_each(|_| monitor.command(&p, 2, 100.0, 40.0, 0.0));
    assert!((monitor.model.position() - 140.0).abs() < 1e-6);
}

/// The first thing that is said in half a minute in which an offset (counts in a sample) comes in the sample `begin`,
/// after a motion of 0.1 m/s for this number of samples.
fn fault_of_an_offset(offset: f64, begin: usize, motion: usize) -> Option<Fault> {
    let mut bench = Bench::new();
    let outcome = (0..3000).map(|k| {
        let (speed, shift) = (if k < motion { 0.1 } else { 0.0 }, if k < begin { 0.0 } else { offset });
        bench.step(speed, Expectation::Bare, |moved, at| (moved + shift, at))
    });
    match outcome.into_iter().find(|outcome| *outcome != Outcome::Good) {
        Some(Outcome::Wrong(finding)) => Some(finding.fault),
        _ => None,
    }
}

#[test]
fn an_offset_that_comes_in_motion_is_a_following_error_and_no_frozen_reading() {
    // 1 to 10 mm/s
    for offset in [2.0, -2.0, 10.0, -20.0, 20.0] {
        assert_eq!(fault_of_an_offset(offset, 150, 200), Some(Fault::FollowingError), "{offset}");
    }
    // 0.1 mm/s are hidden by the band of the measurement
    assert_eq!(fault_of_an_offset(0.2, 150, 200), None);
}

#[test]
fn an_offset_that_comes_at_rest_or_with_the_first_sample_is_no_frozen_reading() {
    for (offset, begin) in [(1.0, 0), (4.0, 0), (-10.0, 0), (20.0, 0), (10.0, 100), (-20.0, 100)] {
        let outcome = fault_of_an_offset(offset, begin, 0);
        assert!(matches!(outcome, None | Some(Fault::FollowingError)), "{offset} from {begin}: {outcome:?}");
    }
}

#[test]
fn a_drive_with_a_large_offset_has_neither_the_wrong_sign_nor_too_little_strength() {
    // 20 and 40 mm/s from the first sample on
    for offset in [40.0, -40.0, 80.0] {
        let mut bench = Bench::new();
        let outcome = (0..200).map(|_| bench.step(0.0, Expectation::Bare, |moved, at| (moved + offset, at)));
        let Some(Outcome::Wrong(finding)) = outcome.into_iter().find(|outcome| *outcome != Outcome::Good) else {
            panic!()
        };
        assert_eq!(finding.fault, Fault::FollowingError, "{finding:?}");
    }
}

#[test]
fn a_weak_drive_that_still_creeps_when_its_model_starts_again_has_no_offset() {
    let mut bench = Bench::new();
    let pulse = bench.p.axis[2].pulse;
    // 8 counts before its position, with commands in the delay
    bench.monitor.restart(10.0 * pulse, pulse);
    bench.position = 8.0;
    (0..2).for_each(|_| bench.sent.send(-13.0 * 9.0 * pulse));
    for k in 0..6000 {
        let outcome = bench.step(0.0, Expectation::Bare, |moved, at| (0.72 * moved, at));
        assert_eq!(outcome, Outcome::Good, "{k}");
    }
}

#[test]
fn an_axis_rests_while_its_patterns_go_back_and_forth_by_a_count_and_not_before_it_has_come_to_rest() {
    let p = Parameters::START;
    let mut monitor = AxisMonitor::new(&p, 2);
    monitor.restart(0.0, p.axis[2].pulse);
    let mut rests = |samples: u32, reference: f64, compensation: fn(u32) -> f64| -> Vec<bool> {
        let sample = |k| {
            monitor.command(&p, 2, reference, compensation(k), 0.0);
            monitor.rests(&p, 2)
        };
        (0..samples).map(sample).collect()
    };
    // four time constants of 1/13 s
    let stopped = rests(200, 0.0, |_| 0.0);
    assert_eq!(stopped.iter().position(|rests| *rests), Some(30));
    assert!(rests(200, 0.0, |k| f64::from(k / 8 % 3) - 1.0).iter().all(|rests| *rests));
    // a hundred counts away it continues for some more
    let comes = rests(200, 100.0, |_| 0.0);
    let came = comes.iter().position(|rests| *rests).unwrap();
    assert!((50..75).contains(&came) && comes[came..].iter().all(|rests| *rests), "{came}");
}

use super::*;
use control_blocks::Reaction;

use crate::center::Center;
use crate::limits::surface_velocity;

const P: Parameters = Parameters::PAPER;
const GOOD: Watched = Watched {
    state: State::Collect,
    probe: 0.0195,
    rotation: 2.0944e-3,
    speed: 2.0944,
    surface: 1e-3,
    beyond_travel: false,
    estimate: None,
};

/// The first fault within `ticks`, and its tick.
fn fault(view: Watched, ticks: u32) -> Option<(u32, Fault)> {
    let mut supervisor = Supervisor::default();
    (0..ticks).find_map(|k| Some((k, supervisor.check(&P, &view)?)))
}

fn ring(eccentricity: f64) -> Estimate {
    Estimate { center: Center { x: eccentricity, y: 0.0 }, mean: 0.08, sigma: 0.0 }
}

#[test]
fn a_revolution_has_no_fault_and_more_than_that_has() {
    assert_eq!(fault(GOOD, 3299), None);
    assert_eq!(fault(GOOD, 3400), Some((3299, Fault::NoProgress)));
    assert_eq!(fault(Watched { state: State::Centered, ..GOOD }, 100_000), None);
}

#[test]
fn one_that_reverses_is_distinguished_from_one_that_turns() {
    let mut supervisor = Supervisor::default();
    let found = (0..3400).find_map(|k| {
        let rotation = if k % 1000 < 500 { GOOD.rotation } else { -GOOD.rotation };
        supervisor.check(&P, &Watched { rotation, ..GOOD })
    });
    assert_eq!(found, Some(Fault::SpindleUneven));
}

#[test]
fn no_change_of_state_gives_back_the_turning_since_the_last_push() {
    let mut supervisor = Supervisor::default();
    let mut flip = |k: u32| {
        let state = if k.is_multiple_of(2) { State::Collect } else { State::Wait };
        supervisor.enter(state);
        supervisor.check(&P, &Watched { state, ..GOOD })
    };
    // 3000 samples for a revolution
    let found = (0..20_000).find_map(|k| Some((k, flip(k)?)));
    assert_eq!(found, Some((13_199, Fault::NoProgress)));
    let [revolutions, maximum] = supervisor.endless().unwrap();
    assert!((revolutions - 4.4).abs() < 1e-3 && maximum == 4.4, "{revolutions} of {maximum}");
    supervisor.enter(State::Settle);
    assert_eq!(supervisor.check(&P, &GOOD), None);
}

#[test]
fn only_a_slide_with_a_known_position_retracts() {
    for &fault in Fault::ALL {
        let readings = [Fault::PositionLost, Fault::PositionJump, Fault::PositionFrozen];
        let own = [Fault::FollowingError, Fault::DriveSign, Fault::WeakDrive, Fault::LongStep];
        let end =
            if own.contains(&fault) || readings.contains(&fault) { Reaction::DriveOff } else { Reaction::Retract };
        assert_eq!(fault.reaction(), end, "{fault:?}");
    }
    let found = [None, Some(Fault::NoPart), Some(Fault::DriveSign), Some(Fault::PositionLost)];
    assert_eq!((most_severe(&found), most_severe(&[None])), (Some(Fault::DriveSign), None));
}

#[test]
fn a_standing_spindle_has_a_name_when_rotation_is_needed() {
    let still = Watched { speed: 0.0, rotation: 0.0, ..GOOD };
    assert_eq!(fault(still, 1000), Some((500, Fault::SpindleFrozen)));
    assert_eq!(fault(Watched { state: State::Centered, ..still }, 10_000), None);
}

#[test]
fn a_probe_without_contact_has_lost_the_part() {
    for state in [State::Follow, State::Collect, State::Model, State::Wait, State::Push, State::Settle, State::Centered]
    {
        assert_eq!(fault(Watched { state, probe: 0.0, ..GOOD }, 1000), Some((100, Fault::NoPart)));
    }
    assert_eq!(fault(Watched { state: State::Approach, probe: 0.0, ..GOOD }, 1000), None);
}

#[test]
fn the_pusher_may_touch_in_a_push_only() {
    let pressed = Watched { probe: 0.0201, ..GOOD };
    assert_eq!(fault(pressed, 100), Some((5, Fault::ProbeRange)));
    assert_eq!(fault(Watched { state: State::Push, ..pressed }, 100), None);
    let beyond = Watched { state: State::Push, probe: 0.0251, ..GOOD };
    assert_eq!(fault(beyond, 100), Some((0, Fault::ProbeRange)));
}

#[test]
fn a_probe_that_does_not_settle_has_a_name() {
    // 3 s, 19.5 mm at 20 mm/s and 0.1 s
    assert_eq!(fault(Watched { state: State::Follow, ..GOOD }, 5000), Some((4075, Fault::ProbeRange)));
}

#[test]
fn the_end_of_the_travel_is_no_part() {
    let view = Watched { state: State::Approach, probe: 0.0, beyond_travel: true, ..GOOD };
    assert_eq!(fault(view, 10), Some((0, Fault::NoPart)));
}

#[test]
fn nothing_is_wrong_while_idle() {
    for state in [State::Idle, State::Fault] {
        assert_eq!(fault(Watched { state, probe: 1.0, speed: 0.0, beyond_travel: true, ..GOOD }, 10_000), None);
    }
}

#[test]
fn the_centrifugal_limit_is_that_of_the_paper() {
    // 25 mm: 42.3 rpm
    let (slow, fast) = (42.0 * TAU / 60.0, 42.5 * TAU / 60.0);
    assert!(!too_fast(&P, slow, &ring(0.025)) && too_fast(&P, fast, &ring(0.025)));
    let view = Watched { speed: -fast, estimate: Some(&ring(0.025)), state: State::Centered, ..GOOD };
    assert_eq!(fault(view, 1), Some((0, Fault::Centrifugal)));
}

#[test]
fn a_fast_surface_is_centrifugal_before_there_is_a_model() {
    // 45 rpm: 25 mm are too much for mu 0.05, 22 mm are not
    let speed = 45.0 * TAU / 60.0;
    let shown = |e: f64| Watched { state: State::Follow, speed, surface: -surface_velocity(e, 0.05, speed), ..GOOD };
    assert_eq!(fault(shown(0.025), 100), Some((30, Fault::Centrifugal)));
    assert_eq!(fault(shown(0.022), 100), None);
    assert_eq!(fault(Watched { speed: 0.0, ..shown(0.025) }, 100), None);
}

#[test]
fn a_new_model_is_evaluated() {
    assert_eq!(evaluate(&P, 1.0, 0, 0.06, &ring(0.06)), Some(Fault::RingTooSmall));
    assert_eq!(evaluate(&P, 40.0, 0, 0.001, &ring(0.001)), Some(Fault::Centrifugal));
    assert_eq!(evaluate(&P, 2.0, 25, 1e-4, &ring(1e-5)), Some(Fault::PushBudget));
    assert_eq!(evaluate(&P, 2.0, 25, 1e-4, &ring(2e-6)), None);
    assert_eq!(evaluate(&P, 2.0, 24, 1e-4, &ring(1e-5)), None);
    assert_eq!(evaluate(&P, 2.0, 1, 0.010, &ring(0.0126)), Some(Fault::Divergence));
    assert_eq!(evaluate(&P, 2.0, 1, 0.010, &ring(0.0124)), None);
}

#[test]
fn a_fault_is_logged_with_its_values_and_a_state_without() {
    let mut vars = <Vars as fmi2_export::Interface>::START;
    assert_eq!(numbers(&vars), "");
    vars.output.eccentricity = 12e-6;
    vars.output.state = State::Wait;
    assert_eq!(numbers(&vars), "; eccentricity `12.00 um`");
    vars.output.state = State::Fault;
    let expected = [
        (Fault::SpindleFrozen, ": `0.000 rad/s`, minimum `limits.spindle_speed_min` = `0.1 rad/s`"),
        (Fault::ProbeFrozen, ": probe at `0 m`"),
    ];
    for (fault, expected) in expected {
        vars.output.fault = fault;
        assert_eq!(numbers(&vars), expected);
    }
    vars.output.monitor.probe_gain_ratio = 0.7;
    vars.output.fault = Fault::ProbeFrozen;
    let tested = ": probe at `0 m`, gain ratio in the probe test `0.70`, limits 1 +- `0.2`";
    assert_eq!(numbers(&vars), tested);
    for &fault in Fault::ALL {
        vars.output.fault = fault;
        assert_eq!(numbers(&vars).is_empty(), fault == Fault::None, "{fault:?}");
    }
}

#[test]
fn a_line_that_moves_is_a_jump_of_a_reading() {
    let seen = |mean: f64, sigma: f64, x: f64| Estimate { center: Center { x, y: 0.0 }, mean, sigma };
    let certain = seen(0.08, 1e-6, 1e-5);
    // 0.1 mm and 6 x (1 + 4) um
    for distance in [1.29e-4, -1.29e-4] {
        assert_eq!(line_moved(&P, &certain, &seen(0.08 + distance, 4e-6, 0.0)), None);
        let [moved, limit] = line_moved(&P, &certain, &seen(0.08 + 1.02 * distance, 4e-6, 0.0)).unwrap();
        assert!((moved - 1.02 * distance.abs()).abs() < 1e-9 && (limit - 1.3e-4).abs() < 1e-6, "{moved} {limit}");
    }
    // 20 mm off, a radius that is configured 25 % wrong moves the line by 0.5 mm
    let far = seen(0.08, 0.0, 0.02);
    assert_eq!(line_moved(&P, &far, &seen(0.08059, 0.0, 0.0)), None);
    assert!(line_moved(&P, &far, &seen(0.08061, 0.0, 0.0)).is_some());
}

#[test]
fn a_limit_itself_is_good_except_for_the_end_of_the_stroke_of_the_probe() {
    let never = |view: Watched| assert_eq!(fault(view, 700), None, "{view:?}");
    never(Watched { probe: P.probe.at_pusher, ..GOOD });
    never(Watched { probe: 0.5 * P.probe.contact, ..GOOD });
    never(Watched { speed: P.limits.spindle_speed_min, rotation: 0.0, ..GOOD });
    let push = |probe: f64| Watched { state: State::Push, probe, ..GOOD };
    never(push(P.probe.stroke - 1e-9));
    assert_eq!(fault(push(P.probe.stroke), 1), Some((0, Fault::ProbeRange)));
    let below = |ratio: f64| Watched { probe: ratio * P.probe.contact, ..GOOD };
    assert_eq!(fault(below(0.499), 700), Some((100, Fault::NoPart)));
    let slow = Watched { speed: -0.999 * P.limits.spindle_speed_min, rotation: 0.0, ..GOOD };
    assert_eq!(fault(slow, 700), Some((500, Fault::SpindleFrozen)));
}

#[test]
fn no_ring_flies_off_a_table_so_slow_that_friction_holds_it_everywhere() {
    // 20 rpm: a surface of 0.22 m/s is faster than that of a rim on the axis, and 50 mm off a ring is held
    let shown = Watched { state: State::Follow, surface: 0.22, ..GOOD };
    assert!(shown.surface > surface_velocity(0.05, 0.05, GOOD.speed) && !too_fast(&P, GOOD.speed, &ring(0.05)));
    assert_eq!(fault(shown, 700), None);
}

#[test]
fn a_spindle_signal_restored_after_the_longest_allowed_rotation_raises_no_fault() {
    let mut supervisor = Supervisor::default();
    let mut rotate = |rotation: f64| supervisor.check(&P, &Watched { rotation, ..GOOD });
    let half = 0.5 * REVOLUTIONS_MAX * TAU;
    assert_eq!([half, -half, 1e-9].map(&mut rotate), [None, None, Some(Fault::SpindleUneven)]);
}

#[test]
fn nine_tenths_of_the_turning_forwards_are_no_reversal() {
    // of 100 samples as many go back
    let found = |back: u32| {
        let mut supervisor = Supervisor::default();
        (0..4000).find_map(|k| {
            let rotation = if k % 100 < back { -GOOD.rotation } else { GOOD.rotation };
            supervisor.check(&P, &Watched { rotation, ..GOOD })
        })
    };
    assert_eq!([4, 6].map(found), [Some(Fault::NoProgress), Some(Fault::SpindleUneven)]);
}

#[test]
fn what_was_counted_is_reset_with_the_state_and_the_cycle_with_the_push() {
    let mut supervisor = Supervisor::default();
    (0..3000).for_each(|_| assert_eq!(supervisor.check(&P, &GOOD), None));
    supervisor.enter(State::Wait);
    assert_eq!((supervisor.rotation, supervisor.forward), (0.0, 0.0));
    assert!((supervisor.cycle - 3000.0 * GOOD.rotation).abs() < 1e-6);
    for state in [State::Approach, State::Settle] {
        let mut supervisor = supervisor.clone();
        supervisor.enter(state);
        assert_eq!(supervisor.cycle, 0.0);
    }
}

#[test]
fn the_time_to_settle_is_that_of_the_law() {
    let p = Parameters::START;
    let mut supervisor = Supervisor::default();
    let view = Watched { state: State::Follow, probe: 4e-3, ..GOOD };
    // 3 s, 4.5 mm at 20 mm/s
    let found = (0..5000).find_map(|k| Some((k, supervisor.check(&p, &view)?)));
    assert_eq!(found, Some((3225, Fault::ProbeRange)));
}

#[test]
fn each_evaluation_starts_at_its_limit() {
    let at = |eccentricity: f64, speed: f64, pushes: i32, first: f64| {
        evaluate(&P, speed, pushes, first, &ring(eccentricity))
    };
    assert_eq!(at(P.ring.radius, 0.1, 0, 0.1), Some(Fault::RingTooSmall));
    let fast = speed_limit(P.limits.friction, 0.01);
    assert_eq!(at(0.01, fast, 0, 0.01), Some(Fault::Centrifugal));
    assert_eq!(at(0.01, 0.999 * fast, 0, 0.01), None);
    assert_eq!(at(P.tolerance, 2.0, P.limits.pushes, 1e-4), None);
    assert_eq!(at(P.push.critical_distance, 2.0, 1, 0.0), None);
}

#[test]
fn a_late_probe_or_slide_is_the_cause_of_what_makes_no_sense_of_the_ring_and_of_nothing_else() {
    let renamed = |late: f64, name: Fault| -> Vec<Fault> {
        let of = Fault::ALL.iter().copied().filter(|&fault| fault != name && cause(fault, Some(late)) == name);
        of.collect()
    };
    let of_the_ring = [
        Fault::ProbeRange,
        Fault::Centrifugal,
        Fault::PushBudget,
        Fault::ProbeJump,
        Fault::ProbeFrozen,
        Fault::Divergence,
        Fault::Unresolved,
        Fault::NoProgress,
        Fault::EarlyContact,
    ];
    assert_eq!(renamed(2e-3, Fault::ProbeDelayed), of_the_ring);
    assert_eq!(renamed(-2e-3, Fault::PositionDelayed), of_the_ring);
    assert!(Fault::ALL.iter().all(|fault| cause(*fault, None) == *fault));
}

#[test]
fn each_fault_is_logged_with_its_own_text() {
    let mut vars = <Vars as fmi2_export::Interface>::START;
    (vars.output.eccentricity, vars.output.eccentricity_std) = (12.3456e-6, 2.5e-6);
    (vars.output.spindle_speed, vars.output.push.count) = (2.0944, 7);
    (vars.input.spindle_angle, vars.input.slide_position, vars.input.probe_position) = (1.5, 0.25, 0.0125);
    let monitor = &mut vars.output.monitor;
    (monitor.following_error, monitor.drive_gain_ratio, monitor.cycle_time) = (0.0015, 0.25, 12.34);
    vars.output.numbers = Numbers {
        following_limit: 0.0012,
        forward: 0.5,
        endless: None,
        line: None,
        first: 10.0e-6,
        probe_delay: 2e-3,
        met: 0.017,
    };
    vars.in_force.limits.cycle_time = 10.0;
    vars.output.state = State::Centered;
    assert_eq!(numbers(&vars), "; eccentricity `12.35 um`");
    vars.output.state = State::Fault;
    let drive = "following error `1.500 mm`, limit `1.200 mm`, gain ratio `0.25`";
    let row = "for more than `limits.lost_samples` = `3` samples";
    let expected = [
        (
            Fault::NoPart,
            ": probe at `0.012500 m`, contact from `probe.contact` = `0.0002 m`; slide at `0.250000 m`, \
             `approach.travel_max` = `0.15 m`",
        ),
        (Fault::RingTooSmall, ": r = `0.05 m`, B = `12.35 um`"),
        (
            Fault::ProbeRange,
            ": probe at `0.012500 m`, target `0.004500 m`, `probe.at_pusher` = `0.02 m`, `probe.stroke` = `0.025 m`",
        ),
        (Fault::Centrifugal, ": `2.094 rad/s`, limit `199.295 rad/s` at B = `12.35 um` of the last model"),
        (Fault::PushBudget, ": `7` pushes, `limits.pushes` = `25`, B = `12.35 um`, `tolerance` = `2.50 um`"),
        (
            Fault::Divergence,
            ": `7` pushes, B from `10.00 um` to `12.35 um`, increase limit `expert.push.critical_distance` = `2500.00 um`",
        ),
        (Fault::ProbeLost, &format!(": probe at `0.0125 m` {row}")),
        (Fault::ProbeJump, &format!(": probe at `0.0125 m` {row}")),
        (Fault::ProbeDelayed, ": `2.00 ms` after the slide, `sample_period` = `1.00 ms`"),
        (
            Fault::EarlyContact,
            ": contact with the probe at `0.017000 m`, `probe.at_pusher` = `0.02 m`; probe now at `0.012500 m`",
        ),
        (Fault::SpindleLost, &format!(": spindle at `1.5 rad` {row}")),
        (Fault::SpindleJump, &format!(": spindle at `1.5 rad` {row}")),
        (Fault::PositionLost, &format!(": slide at `0.25 m` {row}")),
        (Fault::PositionJump, &format!(": slide at `0.25 m` {row}")),
        (Fault::PositionFrozen, &format!(": slide at `0.25 m`, {drive}")),
        (Fault::DriveSign, &format!(": {drive}")),
        (Fault::FollowingError, &format!(": {drive}")),
        (
            Fault::NoProgress,
            &format!(
                ": `12.3 s`, limit of a cycle `10.0 s`, of a commissioning run `{:.1} s`, B = `12.35 um`",
                plan::time(&vars.in_force)
            ),
        ),
        (
            Fault::SpindleUneven,
            ": `2.094 rad/s`, ratio of forward rotation `0.50`, minimum `0.9`; `expert.rates.collect` = `66 Hz`",
        ),
        (Fault::Unresolved, ": B = `12.346 um`, standard deviation `2.500 um`, `tolerance` = `2.500 um`"),
    ];
    for (fault, expected) in expected {
        vars.output.fault = fault;
        assert_eq!(numbers(&vars), expected, "{fault:?}");
    }
    (vars.output.fault, vars.output.numbers.probe_delay) = (Fault::PositionDelayed, -3e-3);
    assert_eq!(numbers(&vars), ": `3.00 ms` after the probe, `sample_period` = `1.00 ms`");
    vars.output.numbers.probe_delay = -6e-3;
    assert_eq!(numbers(&vars), ": at least `6.00 ms` after the probe, `sample_period` = `1.00 ms`");
    let measured = &mut vars.output.measured;
    (measured.slide_bandwidth, measured.slide_bandwidth_std, measured.slide_damping) = (188.5, 9.43, 0.284);
    (measured.io_delay, measured.io_delay_std) = (1.254, 0.3127);
    vars.output.fault = Fault::CommissionRejected;
    assert_eq!(
        numbers(&vars),
        ": bandwidth `30.0 Hz`, limits half and twice `slide.bandwidth` = `40.0 Hz`, minimum `13.9 Hz` for \
         `limits.following_error`; its standard deviation `1.50 Hz`, limit `0.02` and `0.0027` of the bandwidth; damping \
         `0.28`, limits `0.32` to `1.41`; delay `1.25` samples, limits `0` to `8`; its standard deviation `0.313`, limit \
         `0.25`; probe at `0.0125 m`, free up to `probe.contact` = `0.0002 m`"
    );
    (vars.output.fault, vars.output.numbers.line) = (Fault::ProbeJump, Some([2e-4, 1.3e-4]));
    assert_eq!(numbers(&vars), ": the line of the centered ring moved by `0.200 mm`, limit `0.130 mm`");
    (vars.output.fault, vars.output.numbers.endless) = (Fault::NoProgress, Some([1.1003, 1.1]));
    assert_eq!(numbers(&vars), ": `1.10` revolutions without a result, limit `1.1`, B = `12.35 um`");
}

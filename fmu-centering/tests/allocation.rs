//! No sample allocates: not in a centering by either law, nor in the next one, nor in any fault and after its reset.

#[expect(dead_code, reason = "the closed loop uses more of it")]
#[path = "closed_loop/ring.rs"]
mod ring;
#[expect(dead_code, reason = "the closed loop uses more of it")]
#[path = "closed_loop/run.rs"]
mod run;

use assert_no_alloc::{AllocDisabler, assert_no_alloc};
use fmu_centering::interface::{Fault, Input, Parameters, State};

use ring::{AT_PUSHER, Ring, SPEED};
use run::Loop;

#[global_allocator]
static ALLOCATOR: AllocDisabler = AllocDisabler;

/// Both control laws.
const LAWS: [Parameters; 2] = [Parameters::PAPER, Parameters::START];

/// One sample of loop and plant, which must not allocate.
fn step(run: &mut Loop, change: impl FnOnce(&mut Input)) {
    assert_no_alloc(|| run.step_with(change));
}

/// Steps until `state`; by number, the states before it.
fn visit(run: &mut Loop, state: State) -> [bool; State::ALL.len()] {
    let mut visited = [false; State::ALL.len()];
    let end = run.time() + 60.0;
    while run.output.state != state {
        assert!(run.time() < end, "{:?}", run.output);
        step(run, |_| ());
        visited[run.output.state as usize - 1] = true;
    }
    visited
}

/// Ends the present cycle, and starts a new one.
fn begin(run: &mut Loop) {
    step(run, |input| input.enable = false);
    step(run, |_| ());
    assert_eq!(run.output.state, State::Approach);
}

#[test]
fn a_centering_of_each_law_and_the_next_one() {
    for p in LAWS {
        let mut run = Loop::new(&p, Ring::new(1, 2e-4, 0.5));
        let visited = visit(&mut run, State::Centered);
        for &state in State::ALL {
            // the default control law has its model at all times
            let passed =
                !matches!(state, State::Fault | State::Commission) && (state != State::Model || p == Parameters::PAPER);
            assert_eq!(visited[state as usize - 1], passed, "{state:?}");
        }
        begin(&mut run);
        visit(&mut run, State::Centered);
    }
}

#[test]
fn a_centering_that_was_copied_or_stored() {
    for p in LAWS {
        let mut run = Loop::new(&p, Ring::new(1, 2e-4, 0.5));
        visit(&mut run, State::Collect);
        (0..100).for_each(|_| step(&mut run, |_| ()));
        run.controller = run.controller.clone();
        visit(&mut run, State::Push);
        let bytes = postcard::to_allocvec(&run.controller).unwrap();
        run.controller = postcard::from_bytes(&bytes).unwrap();
        visit(&mut run, State::Centered);
    }
}

#[test]
fn a_heavy_ring_that_is_tapped() {
    let mut ring = Ring::new(6, 3e-4, 1.0);
    ring.compliance = 1e-4;
    let mut run = Loop::new(&Parameters::START, ring);
    (0..30_000).for_each(|_| step(&mut run, |_| ()));
    assert!(run.output.push.count > 2, "{:?}", run.output);
}

/// Parameters and ring for a fault that is there from the start, or comes with [`disturb`].
fn machine(fault: Fault, mut p: Parameters) -> (Parameters, Ring) {
    let mut ring = Ring::new(4, if fault == Fault::Centrifugal { 3e-3 } else { 2e-4 }, 0.5);
    match fault {
        Fault::RingTooSmall => {
            (p.ring.radius, p.ring.eccentricity_max) = (1e-3, 0.9e-3);
            ring = Ring::new(2, 1.5e-3, 0.0);
        }
        Fault::PushBudget => (p.limits.pushes, ring.compliance) = (1, 5e-3),
        Fault::Divergence => {
            p = Parameters::PAPER;
            ring = Ring::new(4, 0.02, 0.0);
        }
        Fault::Unresolved => p = Parameters { tolerance: 1e-9, ..Parameters::START },
        Fault::NoProgress | Fault::ProbeDelayed | Fault::PositionDelayed => p.limits.cycle_time = 2.0,
        // the published control law follows just before the pusher
        Fault::EarlyContact => p = Parameters::START,
        // the table of the test turns by itself
        Fault::SpindleSpeed => p.spindle_speed = 1.5 * SPEED,
        Fault::SlowServo => {
            p = Parameters::START;
            p.learn.servo = true;
        }
        _ => {}
    }
    (p, ring)
}

/// Steps with a disturbed machine or with disturbed inputs until the fault state, at most 4000 steps.
fn disturb(fault: Fault, run: &mut Loop) {
    match fault {
        Fault::NoPart => run.ring.present = false,
        Fault::LongStep => run.controller.begin_long_step(),
        Fault::SpindleFrozen => run.ring.speed = 0.0,
        Fault::Centrifugal => run.ring.speed = SPEED * 130.0 / 20.0,
        _ => {}
    }
    let mut delayed = [0.0; 6];
    let (mut slow, mut speed) = (run.output.slide.position_setpoint, 0.0);
    let (position, probe) = (run.output.slide.position_setpoint, AT_PUSHER - run.output.pusher_gap);
    for k in 0..4000 {
        if run.output.state == State::Fault {
            return;
        }
        // as fast as the slide may be, and what a slide does that goes the wrong way or not all of it
        if fault == Fault::SpindleUneven {
            // there and back by a radian
            run.ring.speed = 4.0 * SPEED * (8e-3 * f64::from(k)).cos();
        }
        let (fast, moved) = (1e-4 * f64::from(k), run.output.slide.position_setpoint - position);
        // a servo of 8 Hz
        let (target, servo) = (run.output.slide, 50.0);
        speed += 1e-3
            * (servo * servo * (target.position_setpoint - slow) + 1.4 * servo * (target.velocity_setpoint - speed));
        slow += 1e-3 * speed;
        step(run, |input| match fault {
            Fault::SlowServo => input.slide_position = slow,
            Fault::ProbeRange => input.probe_position = probe + fast,
            Fault::ProbeLost => input.probe_position = f64::NAN,
            Fault::ProbeJump => input.probe_position += 5e-3,
            Fault::ProbeDelayed => {
                delayed.rotate_right(1);
                delayed[0] = input.probe_position;
                input.probe_position = delayed[5];
            }
            Fault::PositionDelayed => {
                delayed.rotate_right(1);
                delayed[0] = input.slide_position;
                input.slide_position = delayed[5];
            }
            // a pusher that meets the ring there
            Fault::EarlyContact => input.probe_position = input.probe_position.min(0.032 - input.probe_position),
            Fault::ProbeFrozen => input.probe_position = probe,
            Fault::SpindleLost => input.spindle_angle = f64::NAN,
            Fault::SpindleJump => input.spindle_angle += 1.0,
            Fault::PositionLost => input.slide_position = f64::NAN,
            Fault::PositionJump => input.slide_position += 0.01,
            Fault::PositionFrozen => input.slide_position = position,
            Fault::FollowingError => input.slide_position = position + 0.9 * moved,
            Fault::DriveSign => input.slide_position = position - moved,
            Fault::WeakDrive => input.slide_position = position + 0.3 * moved,
            _ => {}
        });
    }
}

#[test]
fn a_commission_that_is_aborted_rejected_and_used() {
    let mut p = Parameters::START;
    p.commission.apply = true;
    let mut ring = Ring::new(4, 2e-4, 0.5);
    ring.servo = Some(ring::NOMINAL);
    let mut run = Loop::new(&p, ring);
    for touched in [0, 1000, u32::MAX] {
        step(&mut run, |input| input.enable = false);
        let mut k = 0;
        while k == 0 || run.output.state == State::Commission {
            k += 1;
            step(&mut run, |input| {
                (input.enable, input.commission) = (false, k != 500 || touched > 0);
                input.probe_position = if k > touched && touched > 0 { 3e-4 } else { 0.0 };
            });
        }
        let rejected = touched == 1000;
        assert_eq!(run.output.fault == Fault::CommissionRejected, rejected, "{:?}", run.output);
        assert_eq!(run.output.measured.valid, touched == u32::MAX);
        (0..1000).for_each(|_| step(&mut run, |input| input.enable = false));
        step(&mut run, |input| (input.enable, input.reset_fault) = (false, true));
    }
    visit(&mut run, State::Centered);
}

#[test]
fn every_fault_and_what_comes_after_its_reset() {
    for (p, &fault) in LAWS.iter().flat_map(|p| Fault::ALL.iter().map(move |fault| (p, fault))) {
        // a commissioning run has a test of its own
        if matches!(fault, Fault::None | Fault::CommissionRejected) {
            continue;
        }
        let (p, ring) = machine(fault, p.clone());
        let mut run = Loop::new(&p, ring);
        // drive and delay show in the approach
        if ![
            Fault::ProbeDelayed,
            Fault::PositionDelayed,
            Fault::PositionFrozen,
            Fault::FollowingError,
            Fault::DriveSign,
            Fault::WeakDrive,
            Fault::SlowServo,
        ]
        .contains(&fault)
        {
            visit(&mut run, State::Collect);
        }
        disturb(fault, &mut run);
        visit(&mut run, State::Fault);
        assert_eq!(run.output.fault, fault);
        (0..3000).for_each(|_| step(&mut run, |_| ()));
        (run.ring.present, run.ring.speed) = (true, SPEED);
        step(&mut run, |input| input.reset_fault = true);
        assert_eq!(run.output.state, State::Idle, "{fault:?}");
        begin(&mut run);
        visit(&mut run, State::Collect);
    }
}

//! No sample allocates memory: in a whole cycle, with the published control law, and before and after a fault.

mod common;
#[path = "closed_loop/robot.rs"]
mod robot;
#[allow(dead_code, reason = "the loops of `closed_loop` measure more")]
#[path = "closed_loop/run.rs"]
mod run;

use assert_no_alloc::AllocDisabler;
use fmu_polish::axes::Axes;
use fmu_polish::interface::{Fault, Input, Mode, Parameters, State};
use nalgebra::Vector3;
use robot::Build;
use run::Loop;

#[global_allocator]
static ALLOCATOR: AllocDisabler = AllocDisabler;

#[test]
fn no_sample_of_a_cycle_allocates() {
    for p in [Parameters::START, Parameters::PAPER] {
        let mut run = Loop::new(&p, Build::NOMINAL, 400);
        assert!(run.run_to(State::Follow, 5.0) && run.run_to(State::Done, 20.0), "{:?}: {:?}", p.law, run.output.fault);
        run.input.enable = false;
        assert!(run.run_to(State::Idle, 20.0), "{:?}: {:?}", p.law, run.output.state);
    }
}

#[test]
fn no_sample_of_a_commission_that_is_applied_allocates() {
    let mut p = Parameters::START;
    p.commission.apply = true;
    let mut run = Loop::new(&p, Build { drive_gain: 0.8, late: 1, ..Build::NOMINAL }, 402);
    let mut k = 0;
    while !run.output.measured.valid {
        k += 1;
        run.step_with(|input| (input.enable, input.commission) = (false, k > 50));
        assert_eq!(run.output.fault, Fault::None);
    }
    run.step_with(|input| input.enable = false);
    assert_eq!((run.output.state, run.parameters.io_delay), (State::Idle, 2));
}

/// A fault, what is different from the start, and what the inputs say in a state.
type Case = (Fault, fn(&mut Parameters, &mut Build), fn(State, &mut Input));

const CASES: [Case; 32] = [
    (Fault::ForceLimit, |_, _| (), |state, input| set(state == State::Follow, &mut input.force.z, 30.0)),
    (Fault::SettleTimeout, |p, _| p.impedance.damping = 5e6, |_, _| ()),
    (Fault::ContactLost, |_, _| (), |state, input| set(state == State::Follow, &mut input.force, Axes::ZERO)),
    (Fault::InvalidInput, |_, _| (), |state, input| set(state == State::Follow, &mut input.feed_override, f64::NAN)),
    (Fault::InvalidPath, lean, |_, _| ()),
    (Fault::ApproachTimeout, |_, build| build.shift = Vector3::new(0.0, 0.0, -2.1e-3), |_, _| ()),
    (Fault::PositionError, precise, |_, _| ()),
    (Fault::Stroke, |_, _| (), |_, _| ()),
    (Fault::EmergencyStop, |_, _| (), |state, input| set(state == State::Settle, &mut input.estop, true)),
    (Fault::TareRejected, |_, build| build.height = -20e-6, |_, _| ()),
    (Fault::NotAtStart, |_, _| (), |_, input| input.position.x += 1e-3),
    (Fault::SurfaceError, |_, _| (), |_, _| ()),
    (Fault::PositionLost, |_, _| (), |state, input| set(state == State::Follow, &mut input.position.x, f64::NAN)),
    (Fault::ForceLost, |_, _| (), |state, input| set(state == State::Follow, &mut input.force.x, f64::NAN)),
    (Fault::ForceJump, |_, _| (), |state, input| set(state == State::Follow, &mut input.force.x, 90.0)),
    (Fault::PositionJump, |_, _| (), |state, input| set(state == State::Follow, &mut input.position.x, 9e-3)),
    (Fault::PositionFrozen, |_, _| (), |state, input| set(state == State::Approach, &mut input.position.z, 0.7e-3)),
    (Fault::ForceFrozen, |_, _| (), |state, input| set(state == State::Follow, &mut input.force.z, 5.0)),
    (
        Fault::Saturation,
        |p, _| p.sensor_range = 26.0,
        |state, input| set(state == State::Follow, &mut input.force.z, 26.0),
    ),
    (Fault::NoisyForce, |p, _| p.limits.force_noise = 0.02, |_, _| ()),
    (Fault::FollowingError, |p, _| p.limits.following_error = 2e-6, |_, _| ()),
    (Fault::DriveSign, |_, build| build.pulses.z = -1.0, |_, _| ()),
    (Fault::WeakDrive, |_, build| build.pulses.z = 0.3, |_, _| ()),
    (Fault::Oscillation, |p, _| p.impedance.bandwidth = 80.0, |_, _| ()),
    (Fault::ForceError, lags, |_, _| ()),
    (Fault::WrongStiffness, |p, _| p.limits.stiffness_ratio = 1.001, |_, _| ()),
    (Fault::UnstableLoop, |_, _| (), |_, _| ()),
    (
        Fault::UnloadTimeout,
        |p, _| p.limits.frozen_time = 0.0,
        |state, input| set(state == State::Retract, &mut input.force.z, 1.0),
    ),
    (Fault::NoProgress, |p, _| p.limits.cycle_time = 2.0, |_, _| ()),
    (Fault::NoSliding, |p, _| p.stick_slip.half_period = 1, |_, _| ()),
    (Fault::CommissionRejected, |p, _| p.commission.std_max = 1e-4, commission),
    (Fault::LongStep, |_, _| (), |_, _| ()),
];

/// Requests a commissioning run and no cycle.
fn commission(_: State, input: &mut Input) {
    (input.enable, input.commission) = (false, true);
}

fn set<T>(now: bool, slot: &mut T, value: T) {
    if now {
        *slot = value;
    }
}

/// Friction that leans the force far from the normal.
fn lean(p: &mut Parameters, build: &mut Build) {
    (p.limits.force_angle, p.stick_slip.mode, build.friction) = (0.3, Mode::Off, 0.6);
}

/// A limit that no machine keeps.
fn precise(p: &mut Parameters, _: &mut Build) {
    (p.limits.position_error, p.stick_slip.mode) = (1e-6, Mode::Off);
}

/// Slow force control on a mold that is off its path.
fn lags(p: &mut Parameters, build: &mut Build) {
    (p.impedance.adaptive, p.impedance.damping, p.force.integral_time) = (false, 20e3, 0.0);
    (p.misalignment_enable, p.limits.force_error, build.shift.x) = (false, 0.6, 0.25e-3);
}

#[test]
fn no_sample_around_a_fault_allocates() {
    for (fault, change, hostile) in CASES {
        let (mut p, mut build) = (Parameters::START, Build::NOMINAL);
        change(&mut p, &mut build);
        let mut run = Loop::new(&p, build, 401);
        while run.output.state != State::Fault {
            let state = run.output.state;
            match (fault, state) {
                (Fault::UnstableLoop, State::Follow) => run.parameters.impedance.gain = 20.0,
                (Fault::Oscillation, State::Follow) => run.robot.build.stiffness = 540e3,
                (Fault::SurfaceError, State::Settle) => run.parameters.limits.surface_error = 1e-7,
                (Fault::LongStep, State::Follow) => run.controller.begin_long_step(),
                (Fault::Stroke, State::Approach) => run.parameters.stroke = Axes::all(1e-6),
                _ => (),
            }
            let first = run.time() < 0.05;
            run.step_with(|input| {
                hostile(state, input);
                input.commission &= !first;
            });
            assert!(run.time() < 25.0, "{fault:?}: {:?}", run.output);
        }
        assert_eq!(run.output.fault, fault);
        (0..400).for_each(|_| run.step());
        run.step_with(|input| input.reset_fault = true);
        assert_eq!(run.output.state, State::Idle, "{fault:?}");
    }
    assert!(Fault::ALL[1..].iter().all(|fault| CASES.iter().any(|case| case.0 == *fault)));
}

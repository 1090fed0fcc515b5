//! The frequency response in place, against the machine that it is measured on.

use std::f64::consts::TAU;

use fmu_fts::interface::{Fault, Mode, Parameters, State, SurfaceKind};
use fmu_fts::servo::design::design;
use fmu_fts::servo::loop_model::LoopModel;
use nalgebra::Complex;

use crate::machine::{Build, RPM};
use crate::run::Loop;

/// Spindle at rest, no friction, no cut, fine encoders: linear.
const LINEAR: Build =
    Build { coulomb: 0.0, ripple: 0.0, cutting: [0.0; 3], quantised: false, speed: |_| 0.0, ..Build::NOMINAL };

fn parameters(frequencies: &str) -> Parameters {
    let mut p = Parameters::START;
    p.identify.grid = frequencies.parse().unwrap();
    p
}

/// Identifies immediately; the run ends when the response is complete.
fn identified(p: &Parameters, build: &Build) -> Loop {
    let mut run = Loop::new(p, build, 9);
    run.input.mode = Mode::Identify;
    while run.output.identify_progress < 1.0 {
        run.step();
        assert_eq!((run.output.fault, run.output.saturated), (Fault::None, false), "at {} s", run.time());
        assert!(run.time() < 20.0);
    }
    run
}

#[test]
fn the_response_of_a_linear_machine_is_that_of_its_model() {
    let p = parameters("10, 20, 50, 80, 120, 200, 300, 500, 800, 1000");
    let run = identified(&p, &LINEAR);
    let model = LoopModel::new(&p, design(&p).unwrap());
    let response = &run.output.response;
    for i in 0..10 {
        let measured = Complex::from_polar(response.magnitude[i], response.phase[i]);
        let error = (measured / model.closed(response.frequency[i]) - 1.0).norm();
        assert!(error < 2e-3, "{} Hz: {error}", response.frequency[i] / TAU);
    }
    assert!((response.bandwidth / TAU - 230.0).abs() < 0.5, "{}", response.bandwidth / TAU);
    assert!((response.phase_margin.to_degrees() - 43.9).abs() < 0.3, "{}", response.phase_margin.to_degrees());
    assert!((response.sensitivity_peak - 1.586).abs() < 0.01, "{}", response.sensitivity_peak);
}

#[test]
fn a_machine_that_is_not_the_nominal_one_is_seen_as_it_is() {
    let p = parameters("10, 20, 40, 60, 80, 100, 120, 150, 190, 230, 300, 400, 500, 600");
    for (gain, flexure) in [(0.8, 1080.0), (1.2, 1320.0)] {
        let build = Build { gain, flexure, ..LINEAR };
        let run = identified(&p, &build);
        let mut real = p.clone();
        real.servo.inertia = p.servo.inertia / gain;
        real.servo.viscous_friction = p.servo.viscous_friction / gain;
        real.tip.frequency = TAU * flexure;
        let model = LoopModel::new(&real, design(&p).unwrap());
        for (omega, magnitude) in run.output.response.frequency.iter().zip(run.output.response.magnitude).take(14) {
            let error = magnitude / model.closed(*omega).norm() - 1.0;
            assert!(error.abs() < 4e-3, "gain {gain}, {} Hz: {error}", omega / TAU);
        }
    }
}

#[test]
fn the_nominal_response_is_reported_before_any_is_measured() {
    let p = Parameters::START;
    let mut run = Loop::new(&p, &LINEAR, 9);
    run.input.mode = Mode::Idle;
    run.step();
    assert!((run.output.response.bandwidth - p.servo.bandwidth).abs() < 1e-3 * p.servo.bandwidth);
    assert!((run.output.response.frequency[0] - TAU * 10.0).abs() < 1e-9);
    assert_eq!(run.output.identify_progress, 0.0);
}

#[test]
fn feedforward_uses_the_response_immediately() {
    // a fifth more torque per command, which feedforward alone does not know; in air
    let build = Build { gain: 1.2, coulomb: 0.0, ripple: 0.0, ..Build::NOMINAL };
    let p = parameters("10, 20, 40, 60, 80, 120, 160, 240");
    let rms = |mut run: Loop| {
        run.input.mode = Mode::Approach;
        run.input.afc_enable = false;
        let start = run.time();
        run.run_to(start + 0.6);
        assert_eq!(run.output.state, State::Ready);
        run.measure(0.3).rms
    };
    let (nominal, measured) = (rms(Loop::new(&p, &build, 9)), rms(identified(&p, &build)));
    println!("nominal response {nominal:.3} um, measured {measured:.3} um");
    assert!(measured < 0.1 * nominal, "{measured} {nominal}");
}

#[test]
fn aborted_in_an_oscillation_it_continues_smoothly() {
    for (mode, state) in [(Mode::Hold, State::Hold), (Mode::Approach, State::Ready), (Mode::Identify, State::Identify)]
    {
        let p = parameters("20, 40, 80");
        let mut run = Loop::new(&p, &Build { speed: |_| 600.0 * RPM, ..LINEAR }, 9);
        run.input.mode = Mode::Identify;
        run.run_to(0.6123);
        let before = run.output.response;
        run.input.mode = mode;
        run.run_to(1.2);
        assert_eq!((run.output.state, run.output.fault), (state, Fault::None), "{mode:?}");
        assert_eq!(run.output.response, before, "{mode:?}");
    }
}

#[test]
fn state_bytes_continue_in_an_oscillation() {
    let p = parameters("20, 40, 80");
    let mut run = Loop::new(&p, &Build::NOMINAL, 9);
    run.input.mode = Mode::Identify;
    run.run_to(0.7);
    let mut copy = run.reloaded();
    for _ in 0..9000 {
        run.step();
        copy.step();
        assert_eq!(copy.output, run.output);
    }
    assert_eq!(run.output.identify_progress, 1.0);
}

#[test]
fn the_tool_follows_with_an_off_nominal_flexure() {
    // 500 Hz: 10 % off nominal, the tool is off by a twentieth of 50.7 um and the encoder does not show it
    for (gain, flexure, damping) in [(0.8, 1080.0, 0.01), (1.2, 1320.0, 0.03)] {
        let build = Build { gain, flexure, damping, cutting: [0.0; 3], ripple: 0.0, ..Build::NOMINAL };
        let mut p = parameters("20, 80, 230, 360, 430, 500, 570, 640, 720, 800, 900, 1000, 1100, 1150, 1200, 1250");
        p.surface.kind = SurfaceKind::Wave;
        (p.surface.wave_harmonic, p.path.harmonics, p.feedforward_harmonics) = (50, 50, 50);
        p.afc.cancelled = "1-24, 50".parse().unwrap();
        let tip = |mut run: Loop| {
            run.input.mode = Mode::Track;
            run.run_to(run.time() + 1.0);
            assert_eq!(run.output.state, State::Track);
            run.measure(0.3)
        };
        let (nominal, found) = (tip(Loop::new(&p, &build, 9)), identified(&p, &build));
        let response = &found.output.response;
        println!(
            "{:.2} Hz (sigma {:.2}), {:.4}",
            response.tip_frequency / TAU,
            response.tip_frequency_std / TAU,
            response.tip_damping
        );
        assert!((response.tip_frequency / (TAU * flexure) - 1.0).abs() < 5e-3, "{}", response.tip_frequency / TAU);
        assert!(response.tip_frequency_std > 0.0);
        let left = tip(found);
        println!("nominal {nominal:.3?}, found {left:.3?}");
        assert!(nominal.tip > 1.0 && left.tip < 0.2 && left.rms < 0.1, "{nominal:?} {left:?}");
    }
}

#[test]
fn a_held_measurement_has_no_end_and_the_next_task_measures_again() {
    let mut p = parameters("40, 80");
    let mut run = identified(&p, &LINEAR);
    // so long as the measurement takes
    p.limits.cycle_time = run.time() + 0.05;
    run = identified(&p, &LINEAR);
    run.run_to(run.time() + 2.0 * p.limits.cycle_time);
    assert_eq!((run.output.state, run.output.fault, run.output.identify_progress), (State::Identify, Fault::None, 1.0));
    run.input.mode = Mode::Hold;
    run.run_to(run.time() + 0.3);
    run.input.mode = Mode::Identify;
    run.run_to(run.time() + 0.3);
    assert!(run.output.identify_progress < 1.0 && run.output.fault == Fault::None, "{}", run.output.identify_progress);
    run.run_to(run.time() + p.limits.cycle_time - 0.3);
    assert_eq!((run.output.identify_progress, run.output.fault), (1.0, Fault::None));
}

//! Hostile inputs: the named fault, a safe motion, finite outputs.

use fmu_centering::controller::Controller;
use fmu_centering::interface::{Fault, Input, Output, Parameters, State};
use rand::{RngExt, SeedableRng};

use crate::faults::retreats;
use crate::run::{finite, running};

const P: Parameters = Parameters::PAPER;

#[test]
fn nonsense_from_probe_or_spindle_ends_behind_the_way_back() {
    for state in [State::Approach, State::Collect, State::Wait, State::Push, State::Centered] {
        let good = running(&P, state);
        for nonsense in [f64::NAN, f64::INFINITY, f64::NEG_INFINITY, 1e300] {
            let mut run = good.clone();
            run.spoil(|input| input.probe_position = nonsense);
            retreats(run, Fault::ProbeLost, 0.0);
            let mut run = good.clone();
            run.spoil(|input| input.spindle_angle = nonsense);
            retreats(run, Fault::SpindleLost, 0.0);
        }
    }
}

#[test]
fn a_slide_that_does_not_know_where_it_is_loses_its_drive() {
    for state in [State::Approach, State::Push] {
        let mut run = running(&P, state);
        run.spoil(|input| input.slide_position = f64::NAN);
        for k in 0..1000 {
            run.step_with(|input| input.slide_position = f64::NAN);
            assert_eq!((run.output.state, run.output.fault), (State::Fault, Fault::PositionLost), "{k}");
            assert!(finite(&run.output) && !run.output.drive_enable && run.output.slide.velocity_setpoint == 0.0);
        }
    }
}

#[test]
fn one_jump_of_an_encoder_is_bridged_and_a_lasting_one_has_a_name_but_not_while_idle() {
    type Jump = (fn(&mut Input), Fault);
    let jumps: [Jump; 3] = [
        (|input| input.spindle_angle += 2.0, Fault::SpindleJump),
        (|input| input.probe_position -= 0.01, Fault::ProbeJump),
        (|input| input.slide_position += 0.01, Fault::PositionJump),
    ];
    for state in [State::Collect, State::Wait, State::Push, State::Centered] {
        let good = running(&P, state);
        for (jump, fault) in jumps {
            let (mut run, mut calm) = (good.clone(), good.clone());
            run.step_with(jump);
            (0..100).for_each(|_| run.step());
            (0..101).for_each(|_| calm.step());
            let moved = run.output.slide.position_setpoint - calm.output.slide.position_setpoint;
            assert!(run.output.state == calm.output.state && moved.abs() < 1e-5, "{moved} m");
            (0..4).for_each(|_| run.step_with(jump));
            assert_eq!((run.output.state, run.output.fault), (State::Fault, fault));
        }
    }
    let mut controller = Controller::new(&P).unwrap();
    let mut output = Output::START;
    controller.tick(&Input::START, &P, &mut output);
    let elsewhere = Input { slide_position: 0.3, spindle_angle: 2.0, ..Input::START };
    controller.tick(&elsewhere, &P, &mut output);
    assert_eq!((output.state, output.slide.position_setpoint), (State::Idle, 0.3));
}

#[test]
fn nonsense_before_the_first_good_sample_moves_nothing() {
    let mut controller = Controller::new(&P).unwrap();
    let good = Input { slide_position: 0.2, ..Input::START };
    let blind = Input { slide_position: f64::NAN, ..good.clone() };
    let mut output = Output::START;
    (0..4).for_each(|_| controller.tick(&blind, &P, &mut output));
    assert_eq!(output.state, State::Fault);
    for _ in 0..100 {
        controller.tick(&good, &P, &mut output);
        assert_eq!((output.slide.position_setpoint, output.slide.velocity_setpoint), (0.2, 0.0));
    }
}

#[test]
fn bad_inputs_never_give_a_wild_output() {
    let mut random = rand_pcg::Pcg64Mcg::seed_from_u64(7);
    let mut controller = Controller::new(&P).unwrap();
    let wild = [f64::NAN, f64::INFINITY, -1e308, 1e3, -1e3, 100.0, 0.0, 5e-324, 1e-9, 0.02, 0.0195, 3.0];
    let mut output = Output::START;
    let mut seen = [0; State::ALL.len()];
    for k in 0..400_000 {
        let calm = (k / 4000) % 2 == 0;
        let mut pick = |calm_value: f64| if calm { calm_value } else { wild[random.random_range(0..wild.len())] };
        let input = Input {
            spindle_angle: pick(2e-3 * f64::from(k)),
            slide_position: pick(0.08),
            probe_position: pick(0.0195),
            commission: random.random_bool(if calm { 0.999 } else { 0.5 }),
            enable: random.random_bool(if calm { 0.999 } else { 0.5 }),
            reset_fault: random.random_bool(0.5),
        };
        controller.tick(&input, &P, &mut output);
        assert!(finite(&output), "sample {k}: {output:?}");
        assert!(output.slide.velocity_setpoint.abs() <= P.slide.velocity_max + 1e-12);
        seen[output.state as usize - 1] += 1;
    }
    println!("samples in each state: {seen:?}");
    assert!(seen[State::Fault as usize - 1] > 0 && seen[State::Collect as usize - 1] > 0);
}

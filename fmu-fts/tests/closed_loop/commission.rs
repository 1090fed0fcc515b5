use crate::machine::Build;
use crate::run::Loop;
use fmu_fts::interface::{Fault, Input, Mode, Parameters, State};
use rand::{RngExt, SeedableRng};
use std::f64::consts::TAU;

const STANDING: Build = Build { speed: |_| 0.0, cutting: [0.0; 3], ..Build::NOMINAL };

fn ask(input: &mut Input) {
    (input.enable, input.mode, input.commission) = (false, Mode::Idle, true);
}
fn rest(input: &mut Input) {
    (input.enable, input.mode) = (false, Mode::Idle);
}

#[test]
fn explore() {
    let p = {
        let mut p = Parameters::START;
        p.commission.apply = true;
        p
    };
    for seed in 70..82u64 {
        let mut random = rand_pcg::Pcg64Mcg::seed_from_u64(seed);
        let build = Build {
            gain: random.random_range(0.7..1.3) / random.random_range(0.7..1.3),
            flexure: 1200.0 * random.random_range(0.7..1.3),
            damping: 0.02 * random.random_range(0.7..1.3),
            coulomb: 0.01 * random.random_range(0.7..1.3),
            delay: random.random_range(0..3),
            ..STANDING
        };
        let mut run = Loop::new(&p, &build, seed);
        (0..200).for_each(|_| run.step_with(rest));
        run.step_with(ask);
        assert_eq!(run.output.state, State::Commission);
        let (mut most, mut torque, mut tool) = (0.0f64, 0.0f64, 0.0f64);
        let begin = run.machine.tip_depth();
        while run.output.state == State::Commission {
            run.step_with(ask);
            most = most.max(run.output.error.tracking.abs());
            torque = torque.max(run.output.torque.abs());
            tool = tool.max((run.machine.tip_depth() - begin).abs());
            assert!(run.time() < 60.0);
        }
        let m = &run.output.measured;
        println!(
            "{seed} {:.1}s {:?} {:?} err {:.3} mm torque {torque:.2} tool {:.3} mm; J*g {:.4} ({:.4}) b*g {:.4} ({:.4}) F*g/F {:.3} ({:.3}) delay {:.3} of {} ({:.3}) wt {:.4} ({:.4}) z {:.4} of {:.4} ({:.4}) m {:.4} ({:.4}) bw {:.1}",
            run.time(),
            run.output.state,
            run.output.fault,
            1e3 * most,
            1e3 * tool,
            m.inertia / 8e-4 * build.gain,
            m.inertia_deviation / m.inertia,
            m.viscous_friction * build.gain,
            m.viscous_friction_deviation,
            m.dry_friction * build.gain / build.coulomb,
            m.dry_friction_deviation / m.dry_friction,
            m.io_delay,
            build.delay,
            m.io_delay_deviation,
            m.tip_frequency / TAU / build.flexure,
            m.tip_frequency_deviation / m.tip_frequency,
            m.tip_damping,
            build.damping,
            m.tip_damping_deviation,
            m.tip_inertia,
            m.tip_inertia_deviation,
            run.parameters.servo.bandwidth / TAU
        );
    }
}

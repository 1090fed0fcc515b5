//! Whole jobs: default mode, the study's base, the paper's modes.

use fmu_polish::force::ForceMode;
use fmu_polish::machine::{Fault, State};
use fmu_polish::parameters::Parameters;
use fmu_polish::stick_slip::{Mode, Wave};
use nalgebra::Vector3;

use crate::robot::Build;
use crate::run::{Job, Loop};

/// Force by the norm, no integral, no adaptation, no cancellation, no estimate.
fn base() -> Parameters {
    let mut p = Parameters::DEFAULT;
    p.force.mode = ForceMode::Norm;
    p.force.integral_time = 0.0;
    p.impedance.adaptive = false;
    p.ripple.gain = 0.0;
    p.misalignment.enable = false;
    p
}

fn without(mut p: Parameters) -> Parameters {
    p.stick_slip.mode = Mode::Off;
    p
}

fn job(name: &str, p: &Parameters, build: Build, seed: u64) -> Job {
    let mut run = Loop::new(p, build, seed);
    let job = run.job(20.0);
    println!("{name}: {job:?}");
    let end = (run.output.state, run.output.fault, run.output.progress);
    job.unwrap_or_else(|| panic!("{name} ended in {end:?}"))
}

#[test]
fn probe_modes() {
    let k = |stiffness| Build { stiffness, ..Build::NOMINAL };
    job("default", &Parameters::DEFAULT, Build::NOMINAL, 1);
    job("default, none", &without(Parameters::DEFAULT), Build::NOMINAL, 2);
    job("base", &base(), Build::NOMINAL, 3);
    job("base, none", &without(base()), Build::NOMINAL, 4);
    job("paper", &Parameters::PAPER, Build::NOMINAL, 5);
    for stiffness in [95e3, 240e3] {
        job("default k", &Parameters::DEFAULT, k(stiffness), 6);
        job("base k", &base(), k(stiffness), 7);
    }
    for drive_gain in [0.8, 1.2] {
        job("default gain", &Parameters::DEFAULT, Build { drive_gain, ..Build::NOMINAL }, 8);
    }
    for friction in [0.1, 0.4] {
        job("default mu", &Parameters::DEFAULT, Build { friction, ..Build::NOMINAL }, 9);
    }
    let shift = Vector3::new(50e-6, 50e-6, 70e-6);
    job("default shift", &Parameters::DEFAULT, Build { shift, ..Build::NOMINAL }, 10);
    job("base shift", &base(), Build { shift, ..Build::NOMINAL }, 11);
    let mut sine = Parameters::DEFAULT;
    sine.stick_slip.wave = Wave::Sine;
    job("sine", &sine, Build::NOMINAL, 12);
}

//! Stability of the cancellation by the eigenvalues of the whole linear loop.

use fmu_fts::interface::{Afc, Parameters};
use fmu_fts::lists::harmonics::Harmonics;
use fmu_fts::servo::design::design;
use fmu_fts::servo::lead_lag::LeadLag;
use fmu_fts::servo::loop_model::LoopModel;
use fmu_fts::tracking::adaptive::QUICKER;
use fmu_fts::tracking::resonators::gain_of;
use nalgebra::{Complex, DMatrix, DVector, SVector};

use crate::machine::{Build, RPM, STEP, sampled};

/// States before the resonators: arm 5, command in transit 1, errors 3, torques 3.
const FIXED: usize = 12;

/// Spectral radius of one sample of the loop on the arm `build` at a spindle speed (rad/s).
fn spectral_radius(p: &Parameters, build: &Build, speed: f64) -> f64 {
    let compensator = design(p).unwrap();
    let model = LoopModel::new(p, compensator);
    let (transition, input) = sampled(build, STEP);
    let resonators: Vec<(Complex<f64>, Complex<f64>)> = p
        .afc
        .cancelled
        .iter()
        .filter(|n| *n as f64 * speed <= p.afc.frequency_max)
        .map(|n| {
            let omega = n as f64 * speed;
            // on a constant path the feedforward learns like a resonator: alone in the second harmonic, as fast as it can
            let quicker = if p.feedforward_adaptive && n == 2 { 1.0 + QUICKER } else { 1.0 };
            (Complex::from_polar(1.0, omega * STEP), quicker * gain_of(&p.afc, STEP, model.closed(omega)))
        })
        .collect();
    let size = FIXED + 2 * resonators.len();
    let sample = |x: &DVector<f64>| {
        let mut next = DVector::zeros(size);
        // each resonator in the fixed frame: rotate, learn, output
        let (error, mut set_point) = (-x[0], 0.0);
        for (i, (rotation, gain)) in resonators.iter().enumerate() {
            let at = FIXED + 2 * i;
            let state = Complex::new(x[at], x[at + 1]) * rotation + gain * error;
            (next[at], next[at + 1]) = (state.re, state.im);
            set_point += state.re;
        }
        let torque = compensate(&compensator, x, set_point + error);
        let arm =
            transition * SVector::<f64, 5>::from_iterator(x.iter().copied()) + input.column(0) * (build.gain * x[5]);
        next.rows_mut(0, 5).copy_from(&arm);
        next[5] = torque;
        (next[6], next[7], next[8]) = (set_point + error, x[6], x[7]);
        (next[9], next[10], next[11]) = (torque, x[9], x[10]);
        next
    };
    let columns: Vec<DVector<f64>> =
        (0..size).map(|i| sample(&DVector::from_fn(size, |row, _| if row == i { 1.0 } else { 0.0 }))).collect();
    let eigenvalues = DMatrix::from_columns(&columns).complex_eigenvalues();
    eigenvalues.iter().map(|value| value.norm()).fold(0.0, f64::max)
}

fn compensate(k: &LeadLag, x: &DVector<f64>, error: f64) -> f64 {
    let (b, a) = (&k.numerator, &k.denominator);
    b[0] * error + (1..4).map(|i| b[i] * x[5 + i] - a[i] * x[8 + i]).sum::<f64>()
}

/// How fast the slowest disturbance of the loop dies away, 1/s; negative if one grows.
fn decay(p: &Parameters, build: &Build, rpm: f64) -> f64 {
    -spectral_radius(p, build, rpm * RPM).ln() / STEP
}

fn with(harmonics: Harmonics, tau: f64, phase_advance: bool) -> Parameters {
    let afc = Afc { cancelled: harmonics, tau, phase_advance, ..Afc::START };
    Parameters { afc, feedforward_adaptive: false, ..Parameters::START }
}

#[test]
fn every_harmonic_settles_with_tau() {
    for (list, tau) in [(Harmonics::PAPER, 0.2), (Harmonics::DEFAULT, 0.3), (Harmonics::DEFAULT, 1.0)] {
        for rpm in [600.0, 1200.0, 2400.0] {
            let found = decay(&with(list, tau, true), &Build::IDEAL, rpm);
            assert!((found * tau - 1.0).abs() < 0.06, "tau {tau} s, {rpm} rpm: {found} 1/s");
        }
    }
}

#[test]
fn the_default_is_stable_on_arms_that_are_not_the_nominal_one() {
    for gain in [0.8, 1.0, 1.2] {
        for flexure in [1080.0, 1200.0, 1320.0] {
            let build = Build { gain, flexure, ..Build::IDEAL };
            for rpm in [300.0, 600.0, 1200.0, 2400.0, 4000.0] {
                let found = decay(&Parameters::START, &build, rpm);
                assert!(found > 1.0, "gain {gain}, flexure {flexure} Hz, {rpm} rpm: {found} 1/s");
            }
        }
    }
}

#[test]
fn the_shortest_tau_that_is_allowed_is_stable_with_a_feedforward_that_learns() {
    for list in [Harmonics::PAPER, Harmonics::DEFAULT] {
        let tau = 5.0 * (list.iter().count() as f64 + QUICKER) / Parameters::START.servo.bandwidth;
        let p = Parameters { feedforward_adaptive: true, ..with(list, tau, true) };
        // in the second harmonic of a slow spindle, which all others are near
        for rpm in [60.0, 600.0, 2400.0] {
            let found = decay(&p, &Build::IDEAL, rpm);
            println!("tau {tau} s, {rpm} rpm: {found} 1/s");
            assert!(found > 0.0, "tau {tau} s, {rpm} rpm: {found} 1/s");
        }
    }
}

#[test]
fn a_stiffer_loop_with_more_lead_is_as_stable() {
    let mut p = Parameters::START;
    (p.servo.bandwidth, p.servo.lead) = (std::f64::consts::TAU * 300.0, 5.0);
    for gain in [0.8, 1.2] {
        for (flexure, damping) in [(1080.0, 0.01), (1200.0, 0.01), (1320.0, 0.01)] {
            let build = Build { gain, flexure, damping, ..Build::IDEAL };
            for rpm in [300.0, 600.0, 1200.0, 2400.0] {
                let found = decay(&p, &build, rpm);
                assert!(found > 1.0, "gain {gain}, flexure {flexure} Hz, {rpm} rpm: {found} 1/s");
            }
        }
    }
}

#[test]
fn eq_3_as_printed_is_stable_with_five_harmonics_at_600_rpm() {
    assert!(decay(&Parameters::PAPER, &Build::IDEAL, 600.0) > 3.0);
}

#[test]
fn eq_3_as_printed_is_unstable_at_1200_rpm_for_every_tau() {
    for tau in [0.02, 0.05, 0.1, 0.2, 0.5, 1.0, 3.0, 10.0, 100.0] {
        let found = decay(&with(Harmonics::PAPER, tau, false), &Build::IDEAL, 1200.0);
        assert!(found < 0.0, "tau {tau} s: {found} 1/s");
        assert!(decay(&with(Harmonics::PAPER, tau, true), &Build::IDEAL, 1200.0) > 0.0, "tau {tau} s");
    }
}

#[test]
fn eq_3_as_printed_is_unstable_with_24_harmonics() {
    for rpm in [600.0, 1200.0, 2400.0] {
        assert!(decay(&with(Harmonics::DEFAULT, 0.3, false), &Build::IDEAL, rpm) < 0.0, "{rpm} rpm");
    }
}

#[test]
fn fast_learning_of_many_harmonics_is_unstable() {
    // the smallest tau at 600 rpm lies between these
    for (list, unstable, stable) in [(Harmonics::DEFAULT, 0.05, 0.1), (Harmonics::PAPER, 0.01, 0.02)] {
        assert!(decay(&with(list, unstable, true), &Build::IDEAL, 600.0) < 0.0);
        assert!(decay(&with(list, stable, true), &Build::IDEAL, 600.0) > 0.0);
    }
}

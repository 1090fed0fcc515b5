//! Form of a lens: what a probed one asks for, and the path of the next one.

use fmu_fts::interface::{Input, Mode, Parameters, State, Status};
use fmu_fts::path::depth_table::DepthTable;
use fmu_fts::path::kinematics::Arm;
use fmu_fts::path::path_table::PathTable;
use fmu_fts::path::section::contact;
use fmu_fts::tracking::phasors::Phasors;
use rand::{RngExt, SeedableRng};
use rand_pcg::Pcg64Mcg;

use crate::lens::{Bench, LONG, NOISE, Wrong, around};
use crate::machine::Build;
use crate::run::Loop;

#[test]
fn an_arm_of_0_3_mm_more_makes_4_um_and_leaves_nothing_of_it() {
    let mut bench = Bench::new(Parameters::START, LONG, 1);
    let before = bench.form();
    // 1.75 mm at 30 mm, as the square of the distance, times 0.3 / 80
    let expected = 1.75e-3 * (0.0285_f64 / 0.03).powi(2) * 0.3 / 80.0 / 2f64.sqrt();
    assert!((before / expected - 1.0).abs() < 0.05, "{before:e} {expected:e}");
    let form = bench.correct(1e-12);
    assert!((form.error / before - 1.0).abs() < 0.1 && form.largest > before, "{form:?}");
    assert!(bench.form() < 0.02 * before, "{:e}", bench.form());
}

#[test]
fn each_constant_error_of_a_machine_is_corrected() {
    let nothing = Wrong { length: 0.0, offset: 0.0, angle: 0.0, late: 0.0, nose: 0.0 };
    for wrong in [
        Wrong { offset: 5e-5, ..nothing },
        Wrong { angle: 2e-3, ..nothing },
        Wrong { late: 5e-3, ..nothing },
        Wrong { nose: 1e-4, ..nothing },
    ] {
        let mut bench = Bench::new(Parameters::START, wrong, 2);
        let before = bench.form();
        bench.correct(1e-12);
        println!("{:.3} um, then {:.4} um", 1e6 * before, 1e6 * bench.form());
        assert!(before > 2e-7 && bench.form() < 0.03 * before, "{before:e} {:e}", bench.form());
    }
}

#[test]
fn a_good_machine_is_not_made_worse_and_a_second_lens_not_again() {
    let mut random = Pcg64Mcg::seed_from_u64(77);
    for seed in 0..12 {
        let mut draw = |maximum: f64| random.random_range(-maximum..maximum);
        let scale = if seed % 3 == 0 { 0.0 } else { 1.0 };
        let common = draw(3e-4) * scale;
        let wrong = Wrong {
            length: common,
            offset: common + draw(2e-5) * scale,
            angle: draw(1e-3) * scale,
            late: draw(5e-3) * scale,
            nose: draw(1e-6) * scale,
        };
        let mut bench = Bench::new(Parameters::START, wrong, seed);
        let before = bench.form();
        let deviation = bench.correct(NOISE).std;
        let first = bench.form();
        bench.correct(NOISE);
        let second = bench.form();
        println!(
            "{:.3} um, then {:.3}, {:.3} um, reported {:.3} um",
            1e6 * before,
            1e6 * first,
            1e6 * second,
            1e6 * deviation
        );
        assert!(deviation > 0.1 * NOISE && deviation < NOISE);
        assert!(first <= f64::max(0.2 * before, before.min(3.0 * deviation)) + deviation, "{first:e} of {before:e}");
        assert!(second <= first + 2.0 * deviation, "{second:e} after {first:e}");
    }
}

#[test]
fn a_result_that_is_too_large_or_uncertain_corrects_nothing() {
    let mut bench = Bench::new(Parameters::START, Wrong { offset: -6e-4, ..LONG }, 4);
    bench.probe(NOISE);
    assert_eq!(bench.solve(), Status::TooLarge);
    let form = bench.calibration.form();
    assert!(form.largest > bench.p.form.depth_max && bench.calibration.correction().is_none(), "{form:?}");
    let mut bench = Bench::new(Parameters::START, LONG, 5);
    bench.probe(10.0 * NOISE);
    assert_eq!(bench.solve(), Status::Uncertain);
    let form = bench.calibration.form();
    assert!(form.std > bench.p.form.std_max && bench.calibration.correction().is_none(), "{form:?}");
}

#[test]
fn a_probe_of_three_times_the_noise_corrects_within_its_standard_deviation_or_is_uncertain() {
    let mut solved = 0;
    for seed in 200..212 {
        let mut bench = Bench::new(Parameters::START, LONG, seed);
        let before = bench.form();
        bench.probe(3.0 * NOISE);
        let (status, form) = (bench.solve(), bench.calibration.form());
        match bench.calibration.correction() {
            Some(correction) => {
                solved += 1;
                assert_eq!(status, Status::Solved);
                bench.path.correct(Some(correction));
                let after = bench.form();
                assert!(after < 0.2 * before + 3.0 * form.std, "{seed}: {after:e} of {before:e}, {form:?}");
            }
            None => {
                assert_eq!(status, Status::Uncertain, "{seed}");
                assert!(form.std > bench.p.form.std_max, "{form:?}");
            }
        }
    }
    assert!(solved > 0);
}

#[test]
fn every_fit_of_a_lens_is_one_also_with_the_same_result() {
    let mut bench = Bench::new(Parameters::START, LONG, 7);
    for mode in [Mode::CalibrateForm, Mode::CalibrateFlats] {
        bench.input.mode = mode;
        for solve in [false, true, true, false, true, false] {
            let rises = solve && !bench.input.calibration_solve;
            bench.input.calibration_solve = solve;
            bench.step();
            assert_eq!(bench.calibration.lens_fitted(), rises && mode == Mode::CalibrateForm, "{mode:?}");
        }
    }
    (bench.input.mode, bench.input.calibration_solve) = (Mode::CalibrateForm, true);
    bench.step();
    assert!(bench.calibration.lens_fitted() && bench.calibration.status() == Status::TooFewSamples);
    bench.calibration.rest();
    assert!(!bench.calibration.lens_fitted());
}

#[test]
fn with_one_side_the_center_is_as_uncertain_as_the_axis_of_the_probe() {
    for (cusp_std, status) in [(1e-4, Status::Uncertain), (1e-7, Status::Solved)] {
        let mut p = Parameters::START;
        p.probe.cusp_std = cusp_std;
        let mut bench = Bench { scans: 16, ..Bench::new(p, LONG, 9) };
        bench.probe(NOISE);
        assert_eq!(bench.solve(), status, "{cusp_std}");
    }
}

#[test]
fn a_reading_that_cannot_be_one_of_the_lens_is_left_out() {
    let mut bench = Bench::new(Parameters::START, LONG, 6);
    for (lateral, angle, depth, status) in [
        (0.028, f64::NAN, 0.0, Status::InvalidProbe),
        (0.028, 0.0, f64::INFINITY, Status::InvalidProbe),
        (0.06, 0.0, 0.0, Status::OutsidePath),
        (-0.06, 0.0, 0.0, Status::OutsidePath),
    ] {
        bench.read(lateral, angle, depth);
        assert_eq!(bench.calibration.status(), status, "{lateral} {angle} {depth}");
        assert_eq!(bench.calibration.report().samples, 0);
    }
    // a spindle counts its turns
    bench.read(0.028, 1e4, 0.0);
    assert_eq!(bench.calibration.report().samples, 1);
    assert_eq!(bench.solve(), Status::TooFewSamples);
    for _ in 0..600 {
        bench.read(0.028, 0.0, 0.0);
    }
    assert_eq!((bench.calibration.status(), bench.calibration.report().samples), (Status::Full, 512));
}

/// A machine that has cut its lens 3 um too deep twice per revolution, and has probed it.
fn probed(p: &Parameters) -> Loop {
    let mut run = Loop::new(p, &Build::NOMINAL, 8);
    run.input.mode = Mode::CalibrateForm;
    run.run_to(0.4);
    probe(&mut run, 3e-6);
    assert!(!run.output.form.corrected, "before the next cut nothing changes");
    run
}

/// Probes a lens that is too deep by `excess` (m) twice per revolution, and requests the next.
fn probe(run: &mut Loop, excess: f64) {
    run.input.mode = Mode::CalibrateForm;
    let p = &run.parameters;
    let path = PathTable::new(Arm::new(p), &DepthTable::of_surface(p).unwrap(), 24);
    for (k, i) in (0..24).flat_map(|k| (0..20).map(move |i| (k, i))) {
        let (distance, (side, angle)) = (0.028 + 2e-4 * f64::from(i), around(k));
        let form = contact(&path, [2e-3, 1.5e-3], distance, Phasors::new(angle, 64).from_zero()).unwrap();
        let input = &mut run.input;
        // both sides of the axis are alike for an excess twice per revolution
        (input.probe_lateral, input.probe_angle) = (side * distance, angle);
        input.probe_depth = form.depth + excess * (2.0 * angle).cos();
        for capture in [true, false] {
            run.input.probe_capture = capture;
            run.step();
        }
    }
    run.input.calibration_solve = true;
    run.step();
    assert_eq!(run.output.calibration.status, Status::Solved);
    run.input.calibration_solve = false;
    run.input.mode = Mode::Track;
}

/// Largest deviation of the path from one that is deeper than nominal by `added` (m) twice per revolution, m.
fn next_to(run: &mut Loop, added: f64) -> f64 {
    let p = &run.parameters;
    let path = PathTable::new(Arm::new(p), &DepthTable::of_surface(p).unwrap(), 24);
    let mut maximum: f64 = 0.0;
    for _ in 0..1000 {
        run.step();
        let Input { spindle_angle, slide_position, .. } = run.input;
        let [nominal, _] = path.nominal_depth(slide_position, Phasors::new(spindle_angle, 64).from_zero());
        maximum = maximum.max((run.output.reference.depth - nominal - added * (2.0 * spindle_angle).cos()).abs());
    }
    maximum
}

#[test]
fn what_the_lens_asks_for_is_the_next_path_where_it_may() {
    for apply in [true, false] {
        let mut p = Parameters::START;
        p.form.apply = apply;
        let mut run = probed(&p);
        let until = run.time() + 1.0;
        run.run_to(until);
        assert_eq!(run.output.form.corrected, apply);
        let (with, without) = (next_to(&mut run, -3e-6), next_to(&mut run, 0.0));
        assert_eq!(with < 2e-7, apply, "{with:e}");
        assert_eq!(without < 2e-7, !apply, "{without:e}");
        // and the arm follows it as any other
        assert!(run.measure(0.5).rms < 0.6);
    }
}

#[test]
fn a_saved_state_holds_readings_and_correction() {
    let mut p = Parameters::START;
    p.form.apply = true;
    let mut run = probed(&p);
    for time in [0.01, 0.8] {
        let until = run.time() + time;
        run.run_to(until);
        let mut copy = run.reloaded();
        for _ in 0..3000 {
            run.step();
            copy.step();
            assert_eq!(copy.output, run.output);
        }
    }
    assert!(run.output.form.corrected);
}

#[test]
fn a_path_that_was_joined_but_not_followed_has_cut_no_lens() {
    let mut p = Parameters::START;
    p.form.apply = true;
    let mut run = probed(&p);
    while run.output.state != State::Approach {
        run.step();
    }
    assert!(run.output.form.corrected);
    // no: the same lens once more
    run.input.mode = Mode::CalibrateForm;
    let until = run.time() + 0.5;
    run.run_to(until);
    let again = |run: &mut Loop, excess: f64| {
        *run = run.reloaded();
        probe(run, excess);
        let until = run.time() + 1.0;
        run.run_to(until);
        assert_eq!((run.output.state, run.output.form.corrected), (State::Track, true));
        let maximum = next_to(run, -3e-6);
        assert!(maximum < 2e-7, "{maximum:e}");
    };
    again(&mut run, 3e-6);
    // the lens that was cut with the correction is good, and so is the correction
    run.input.mode = Mode::CalibrateForm;
    let until = run.time() + 0.5;
    run.run_to(until);
    again(&mut run, 0.0);
}

#[test]
fn a_path_that_is_left_is_not_bent() {
    let mut p = Parameters::START;
    p.form.apply = true;
    let mut run = Loop::new(&p, &Build::NOMINAL, 8);
    run.run_to(0.6);
    // probed and back before the arm has left the path: it is the one that was
    probe(&mut run, 3e-6);
    let until = run.time() + 0.5;
    run.run_to(until);
    assert_eq!((run.output.state, run.output.form.corrected), (State::Track, false));
    run.input.mode = Mode::Hold;
    run.run_to(until + 0.5);
    run.input.mode = Mode::Track;
    run.run_to(until + 1.0);
    assert_eq!((run.output.state, run.output.form.corrected), (State::Track, true));
}

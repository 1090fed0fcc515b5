//! Calibration as the FMU does it: cut, probe, solve, with parts of ideal geometry.

use fmu_fts::calibration::calibrator::Calibrator;
use fmu_fts::calibration::cut::Moment;
use fmu_fts::interface::{Input, Mode, Parameters, Status};
use fmu_fts::path::depth_table::DepthTable;
use fmu_fts::path::kinematics::Arm;
use fmu_fts::path::path_table::PathTable;
use rand::{RngExt, SeedableRng};
use rand_pcg::Pcg64Mcg;

/// Ground truth of the machine: arm length, m.
const LENGTH: f64 = 0.080_02;
/// Cross-slide offset, m.
const OFFSET: f64 = 0.150_3;
/// Arm zero, rad.
const ZERO: f64 = 0.052;
/// Slide position while the tool cuts, m.
const SLIDE: f64 = 0.075;

/// The calibration with its inputs and what the machine does.
struct Bench {
    p: Parameters,
    calibration: Calibrator,
    path: PathTable,
    input: Input,
    now: Moment,
    /// Ground truth of the arm zero, rad.
    zero: f64,
}

impl Bench {
    fn new(p: Parameters, mode: Mode) -> Self {
        let calibration = Calibrator::new(&p);
        let now = Moment { arm_angle: 0.5, torque: 0.1, slide_position: SLIDE };
        let path = PathTable::new(Arm::new(&p), &DepthTable::of_surface(&p).unwrap(), 24);
        Self { p, calibration, path, input: Input { mode, ..Input::START }, now, zero: ZERO }
    }

    fn step(&mut self) {
        self.calibration.step(&self.p, &self.input, self.now, &self.path);
    }

    /// Cuts for ten samples with the machine at rest.
    fn cut(&mut self) {
        self.input.calibration_cut = true;
        (0..10).for_each(|_| self.step());
        self.input.calibration_cut = false;
        self.step();
    }

    /// A cut in which `change` moves the machine gives no sample.
    fn assert_moved(&mut self, change: impl FnOnce(&mut Moment)) {
        self.input.calibration_cut = true;
        self.step();
        change(&mut self.now);
        self.step();
        self.input.calibration_cut = false;
        self.capture(0.01, 0.05);
        assert_eq!(self.calibration.status(), Status::Moved);
    }

    /// One sample by a rising edge.
    fn capture(&mut self, lateral: f64, depth: f64) {
        (self.input.probe_lateral, self.input.probe_depth) = (lateral, depth);
        for capture in [true, false] {
            self.input.probe_capture = capture;
            self.step();
        }
    }

    fn solve(&mut self) -> Status {
        for solve in [true, false] {
            self.input.calibration_solve = solve;
            self.step();
        }
        self.calibration.status()
    }

    /// A toroid from 30 to 60 degrees, read on both sides of a cusp that lies at 20 um.
    fn toroid(&mut self) {
        let nose = self.p.tool.nose_radius[self.p.tool.index()];
        let radius = LENGTH + nose - self.p.probe.radius;
        for side in [1.0, -1.0] {
            for k in 0..60 {
                let phi = (30.5 + 0.5 * f64::from(k)).to_radians();
                let lateral = side * (OFFSET - SLIDE - radius * phi.cos()) + 2e-5;
                self.capture(lateral, radius * phi.sin() - 0.03);
            }
        }
    }

    /// A flat with the arm at `phi` (rad), with a thrust that bends the arm.
    fn flat(&mut self, phi: f64) {
        let torque = 2.0 * LENGTH * phi.cos();
        let stiffness = self.p.tip.inertia * self.p.servo.inertia * self.p.tip.frequency.powi(2);
        self.now.arm_angle = phi - self.zero;
        self.now.torque = torque;
        self.cut();
        self.capture(0.02, LENGTH * (phi - torque / stiffness).sin() + 0.01);
    }
}

#[test]
fn a_toroid_gives_arm_length_and_offset() {
    for selected in [1, 2] {
        let mut p = Parameters::START;
        p.tool.selected = selected;
        p.tool.nose_radius = [0.002, 0.0031];
        let mut bench = Bench::new(p, Mode::CalibrateToroid);
        bench.cut();
        bench.toroid();
        assert_eq!(bench.solve(), Status::Solved);
        let found = bench.calibration.report();
        assert!((found.arm_length - LENGTH).abs() < 1e-10, "{:e}", found.arm_length - LENGTH);
        assert!((found.center_offset - OFFSET).abs() < 1e-10, "{:e}", found.center_offset - OFFSET);
        assert_eq!(found.samples, 120);
        // the two radii and the fit
        assert!(found.arm_length_std > 1.4e-7 && found.arm_length_std < 1e-6, "{:e}", found.arm_length_std);
        assert!(found.center_offset_std > 3e-8 && found.center_offset_std < 1e-6);
    }
}

#[test]
fn flats_give_the_arm_zero_and_use_the_toroid_before() {
    // the second tool is at the other end of the arm
    for (selected, zero) in [(1, ZERO), (2, ZERO - std::f64::consts::PI)] {
        let mut p = Parameters::START;
        p.tool.selected = selected;
        let mut bench = Bench { zero, ..Bench::new(p, Mode::CalibrateToroid) };
        bench.cut();
        bench.toroid();
        assert_eq!(bench.solve(), Status::Solved);
        let toroid = bench.calibration.report();
        bench.input.mode = Mode::CalibrateFlats;
        (0..11).for_each(|k| bench.flat((30.0 + 3.0 * f64::from(k)).to_radians()));
        assert_eq!(bench.solve(), Status::Solved);
        let flats = bench.calibration.report();
        assert!((flats.arm_zero - zero).abs() < 1e-8, "{:e}", flats.arm_zero - zero);
        assert!(flats.arm_zero_std > 1e-6 && flats.arm_zero_std < 1e-5, "{:e}", flats.arm_zero_std);
        assert!((flats.arm_length - LENGTH).abs() < 1e-9 && flats.arm_length_std <= toroid.arm_length_std);
        assert_eq!((flats.center_offset, flats.samples), (toroid.center_offset, 11));
    }
}

#[test]
fn readings_on_one_flat_are_one_sample() {
    let mut bench = Bench::new(Parameters::START, Mode::CalibrateFlats);
    bench.cut();
    bench.input.probe_capture = true;
    for k in 0..1000 {
        (bench.input.probe_lateral, bench.input.probe_depth) = (0.02 + 1e-6 * f64::from(k), 0.05);
        bench.step();
    }
    assert_eq!(bench.calibration.report().samples, 1);
    bench.input.probe_capture = false;
    bench.step();
    bench.capture(0.02, 0.05);
    assert_eq!(bench.calibration.report().samples, 1);
    bench.cut();
    bench.capture(0.02, 0.06);
    assert_eq!(bench.calibration.report().samples, 2);
}

#[test]
fn a_flat_is_at_the_mean_of_its_readings_and_a_rigid_arm_does_not_bend() {
    let mut p = Parameters::START;
    p.tip.frequency = 0.0;
    let mut bench = Bench::new(p, Mode::CalibrateFlats);
    for k in 0..11 {
        let phi = (30.0 + 3.0 * f64::from(k)).to_radians();
        bench.now.arm_angle = phi - ZERO;
        bench.cut();
        // the nominal length, which flats alone are fitted with
        for off in [4e-5, -1e-5, -3e-5] {
            // more on some than on others, or the depth of all would take it
            bench.capture(0.02, 0.08 * phi.sin() + off * f64::from(k - 3));
        }
    }
    assert_eq!(bench.solve(), Status::Solved);
    let found = bench.calibration.report();
    assert_eq!(found.samples, 11);
    assert!((found.arm_zero - ZERO).abs() < 1e-8, "{:e}", found.arm_zero - ZERO);
}

#[test]
fn another_calibration_in_between_begins_with_nothing() {
    let mut bench = Bench::new(Parameters::START, Mode::CalibrateToroid);
    bench.cut();
    bench.toroid();
    bench.input.mode = Mode::CalibrateFlats;
    bench.step();
    assert_eq!((bench.calibration.status(), bench.calibration.report().samples), (Status::None, 0));
    bench.capture(0.02, 0.05);
    assert_eq!(bench.calibration.status(), Status::NoCut);
}

#[test]
fn a_capture_that_stays_reads_once_every_pitch() {
    let mut bench = Bench::new(Parameters::START, Mode::CalibrateToroid);
    bench.cut();
    bench.input.probe_capture = true;
    for k in 0..=1000 {
        bench.input.probe_lateral = 0.03 - 1e-6 * f64::from(k);
        bench.step();
    }
    // 1 mm with 0.1 mm of pitch, less what rounding leaves
    let samples = bench.calibration.report().samples;
    assert!((10..=11).contains(&samples), "{samples}");
}

#[test]
fn samples_that_cannot_be_used_are_left_out_and_say_why() {
    let mut bench = Bench::new(Parameters::START, Mode::CalibrateToroid);
    bench.capture(0.01, 0.05);
    assert_eq!(bench.calibration.status(), Status::NoCut);
    bench.assert_moved(|now| now.slide_position += 2e-5);
    bench.cut();
    for nonsense in [f64::NAN, f64::INFINITY, -1e9] {
        bench.capture(nonsense, 0.05);
        assert_eq!(bench.calibration.status(), Status::InvalidProbe);
        bench.capture(0.01, nonsense);
        assert_eq!(bench.calibration.status(), Status::InvalidProbe);
    }
    assert_eq!(bench.calibration.report().samples, 0);
    (0..600).for_each(|k| bench.capture(1e-4 * f64::from(k), 0.05));
    assert_eq!((bench.calibration.status(), bench.calibration.report().samples), (Status::Full, 512));
}

#[test]
fn an_arm_that_oscillates_cuts_no_flat() {
    let mut bench = Bench::new(Parameters::START, Mode::CalibrateFlats);
    bench.assert_moved(|now| now.arm_angle += 2e-3);
}

#[test]
fn a_fit_that_fails_says_why_and_keeps_the_record() {
    for mode in [Mode::CalibrateToroid, Mode::CalibrateFlats] {
        let mut bench = Bench::new(Parameters::START, mode);
        let before = bench.calibration.report();
        assert_ne!(bench.solve(), Status::Solved);
        bench.cut();
        bench.capture(0.01, 0.05);
        assert_ne!(bench.solve(), Status::Solved);
        // the same position repeatedly
        (0..30).for_each(|_| {
            bench.cut();
            bench.capture(0.01, 0.05);
        });
        assert_eq!(bench.solve(), Status::NotObservable, "{mode:?}");
        let after = bench.calibration.report();
        assert_eq!((after.arm_length, after.arm_zero, after.center_offset), (0.08, 0.0523, 0.15));
        assert_eq!(after.arm_length_std, before.arm_length_std);
    }
}

#[test]
fn each_calibration_begins_with_nothing() {
    let mut bench = Bench::new(Parameters::START, Mode::CalibrateToroid);
    bench.cut();
    bench.toroid();
    assert_eq!(bench.solve(), Status::Solved);
    bench.calibration.rest();
    bench.step();
    assert_eq!((bench.calibration.status(), bench.calibration.report().samples), (Status::None, 0));
    bench.capture(0.01, 0.05);
    assert_eq!(bench.calibration.status(), Status::NoCut);
    // what was found stays
    assert!((bench.calibration.report().arm_length - LENGTH).abs() < 1e-10);
}

#[test]
fn whatever_comes_in_the_record_stays_finite() {
    let mut random = Pcg64Mcg::seed_from_u64(3);
    for mode in [Mode::CalibrateToroid, Mode::CalibrateFlats] {
        let mut bench = Bench::new(Parameters::START, mode);
        for _ in 0..30_000 {
            let mut wild = || match random.random_range(0..40) {
                0 => f64::NAN,
                1 => f64::INFINITY,
                2 => -1e308,
                3 => 0.0,
                4 => 1e-300,
                _ => random.random_range(-0.1..0.1),
            };
            (bench.input.probe_lateral, bench.input.probe_depth) = (wild(), wild());
            bench.now = Moment { arm_angle: 1e-3 * wild().clamp(-1.0, 1.0), torque: wild(), slide_position: SLIDE };
            if !bench.now.arm_angle.is_finite() || !bench.now.torque.is_finite() {
                bench.now = Moment { arm_angle: 0.5, torque: 0.1, slide_position: SLIDE };
            }
            bench.input.calibration_cut = random.random_bool(0.3);
            bench.input.probe_capture = random.random_bool(0.5);
            bench.input.calibration_solve = random.random_bool(0.02);
            bench.step();
            let found = bench.calibration.report();
            let all = [found.arm_length, found.center_offset, found.arm_zero, found.residual];
            let sigmas = [found.arm_length_std, found.center_offset_std, found.arm_zero_std];
            assert!(all.iter().chain(&sigmas).all(|x| x.is_finite()), "{found:?}");
        }
    }
}

//! A lens of ideal geometry: cut by an off-nominal arm, probed, corrected, cut again.

use std::f64::consts::{PI, TAU};

use fmu_fts::calibration::calibrator::Calibrator;
use fmu_fts::calibration::cut::Moment;
use fmu_fts::interface::{FormOutput, Input, Mode, Parameters, Status};
use fmu_fts::path::depth_table::DepthTable;
use fmu_fts::path::kinematics::Arm;
use fmu_fts::path::path_table::PathTable;
use fmu_fts::path::section::contact;
use fmu_fts::tracking::phasors::Phasors;
use rand::SeedableRng;
use rand_distr::{Distribution, Normal};
use rand_pcg::Pcg64Mcg;

/// Distances from the spindle axis (m) at which the lens is probed and evaluated.
const ZONE: [f64; 2] = [0.0275, 0.0295];
/// Noise of a sample: residual of the cut and noise of the probe, m.
pub const NOISE: f64 = 2e-7;

/// Differences of the machine from its configured geometry.
#[derive(Clone, Copy)]
pub struct Wrong {
    /// Arm length, m.
    pub length: f64,
    /// Cross-slide offset, m.
    pub offset: f64,
    /// Angle of the arm, wind-up and all, rad.
    pub angle: f64,
    /// Angle by which the spindle is read late, rad.
    pub late: f64,
    /// Nose radius, m.
    pub nose: f64,
}

/// The arm of 0.3 mm: the offset was found by turning to the axis, and errs as the length does.
pub const LONG: Wrong = Wrong { length: 3e-4, offset: 3e-4, angle: 0.0, late: 0.0, nose: 0.0 };

/// The lens and its controller.
pub struct Bench {
    pub p: Parameters,
    pub wrong: Wrong,
    pub path: PathTable,
    pub calibration: Calibrator,
    pub random: Pcg64Mcg,
    pub input: Input,
    /// Scans along a radius.
    pub scans: i32,
}

/// Side of the axis and angle (rad) of scan `k`: sixteen on the near side, then eight on the far one.
pub fn around(k: i32) -> (f64, f64) {
    if k < 16 { (1.0, f64::from(k) * PI / 8.0) } else { (-1.0, f64::from(k) * PI / 4.0) }
}

impl Bench {
    pub fn new(p: Parameters, wrong: Wrong, seed: u64) -> Self {
        let path = PathTable::new(Arm::new(&p), &DepthTable::of_surface(&p).unwrap(), 24);
        let input = Input { mode: Mode::CalibrateForm, ..Input::START };
        Self {
            calibration: Calibrator::new(&p),
            p,
            wrong,
            path,
            random: Pcg64Mcg::seed_from_u64(seed),
            input,
            scans: 24,
        }
    }

    /// Actual center of the nose: distance and depth, m.
    fn nose(&self, slide_position: f64, angle: f64) -> [f64; 2] {
        let Wrong { length, offset, angle: bent, late, .. } = self.wrong;
        let (nominal, mut row) = (self.path.arm(), self.path.row());
        self.path.interpolate(slide_position, &mut row);
        let depth = row.depth(Phasors::new(angle - late, 64).from_zero()).value;
        let (phi, length) = (nominal.angle(depth) + nominal.zero + bent, nominal.length + length);
        [nominal.center_offset + offset - slide_position - length * phi.cos(), length * phi.sin()]
    }

    /// Lowest point of a ball on the cut section, m.
    fn depth(&self, ball: f64, distance: f64, angle: f64) -> f64 {
        let nose_offset = self.p.tool.nose_radius[0] + self.wrong.nose - ball;
        let mut x = self.path.arm().slide_position(distance, 0.0);
        for _ in 0..20 {
            let [before, here, after] = [-1e-6, 0.0, 1e-6].map(|dx| self.nose(x + dx, angle));
            let slope = (after[1] - before[1]) / (after[0] - before[0]);
            let miss = here[0] - nose_offset * slope / slope.hypot(1.0) - distance;
            // a correction ends with a bend
            if miss.abs() < 1e-9 {
                return here[1] + nose_offset / slope.hypot(1.0) + ball;
            }
            x += miss;
        }
        panic!("no contact at {distance}");
    }

    /// Form of the lens against what is asked for, root mean square without its mean, m.
    pub fn form(&self) -> f64 {
        let radius = self.p.tool.nose_radius[0];
        let mut errors = Vec::new();
        for (k, i) in (0..12).flat_map(|k| (0..48).map(move |i| (k, i))) {
            let (distance, angle) = (ZONE[0] + (ZONE[1] - ZONE[0]) * f64::from(k) / 11.0, f64::from(i) * TAU / 48.0);
            let nominal = contact(&self.path, [radius, 0.0], distance, Phasors::new(angle, 64).from_zero()).unwrap();
            errors.push(self.depth(0.0, distance, angle) - nominal.depth);
        }
        let mean = errors.iter().sum::<f64>() / errors.len() as f64;
        (errors.iter().map(|error| (error - mean).powi(2)).sum::<f64>() / errors.len() as f64).sqrt()
    }

    pub fn step(&mut self) {
        self.calibration.step(&self.p, &self.input, Moment::default(), &self.path);
    }

    pub fn read(&mut self, lateral: f64, angle: f64, depth: f64) {
        (self.input.probe_lateral, self.input.probe_depth, self.input.probe_angle) = (lateral, depth, angle);
        for capture in [true, false] {
            self.input.probe_capture = capture;
            self.step();
        }
    }

    /// All scans, the axis 15 um off the zero of the scale.
    pub fn probe(&mut self, noise: f64) {
        let normal = Normal::new(0.0, noise).unwrap();
        for k in 0..self.scans {
            let (side, angle) = around(k);
            for i in 0..20 {
                let distance = ZONE[0] + (ZONE[1] - ZONE[0]) * f64::from(i) / 19.0;
                let at = if side < 0.0 { angle + PI } else { angle };
                let depth = self.depth(self.p.probe.radius, distance, at) + normal.sample(&mut self.random) - 5e-3;
                self.read(side * distance + 1.5e-5, angle, depth);
            }
        }
    }

    pub fn solve(&mut self) -> Status {
        for solve in [true, false] {
            self.input.calibration_solve = solve;
            self.step();
        }
        self.calibration.status()
    }

    /// Probes the lens, and cuts the next one with what it asks for.
    pub fn correct(&mut self, noise: f64) -> FormOutput {
        self.probe(noise);
        assert_eq!(self.solve(), Status::Solved);
        self.path.correct(self.calibration.correction());
        self.calibration.cut_lens(&self.path);
        self.calibration.rest();
        self.calibration.form()
    }
}

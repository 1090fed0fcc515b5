//! A turning machine with a rotary fast tool servo: the plant of the closed loops, natively in Rust.
//!
//! Two inertias with a flexure downstream of a current loop, sampled exactly at 20 us; Coulomb friction on the hub,
//! thrust of the part on the arm, ripple in step with the spindle, encoders with their resolution. The values were
//! chosen like those of the nominal arm; the ripple leaves 1.2 um at the twelfth harmonic.

use std::collections::VecDeque;
use std::f64::consts::TAU;

use nalgebra::{Matrix5, SMatrix, SVector};
use rand::SeedableRng;
use rand_distr::{Distribution, StandardNormal, Uniform};
use rand_pcg::Pcg64Mcg;

/// Communication step, s.
pub const STEP: f64 = 1e-4;
/// rad/s of one revolution per minute.
pub const RPM: f64 = TAU / 60.0;

const SUBSTEPS: usize = 5;
const DT: f64 = STEP / SUBSTEPS as f64;
const ARM_LENGTH: f64 = 0.08;
const ARM_ZERO: f64 = 0.0523;
const TORQUE_MAX: f64 = 7.0;

/// Properties of the simulated machine that a test can set.
#[derive(Clone, Debug)]
pub struct Build {
    /// Torque per commanded torque.
    pub gain: f64,
    /// Natural frequency of the arm on the locked hub, Hz.
    pub flexure: f64,
    /// Damping ratio of it.
    pub damping: f64,
    /// Coulomb friction, N.m.
    pub coulomb: f64,
    /// Ripple torque at the twelfth harmonic of the spindle, N.m.
    pub ripple: f64,
    /// Torque at 120 Hz whatever the spindle does, N.m.
    pub hum: f64,
    /// Thrust on the tool, mean, twice per revolution, noise, N.
    pub cutting: [f64; 3],
    /// Speed ripple of the spindle, rad/s, once and twelve times per revolution.
    pub spindle_ripple: [f64; 2],
    /// Spindle speed over the time, rad/s.
    pub speed: fn(f64) -> f64,
    /// Distance from the spindle axis, m.
    pub radius: f64,
    /// Samples between a command and its action.
    pub delay: usize,
    /// Samples by which the arm is read late.
    pub arm_delay: usize,
    /// Encoders with their resolution.
    pub quantised: bool,
}

impl Build {
    /// The machine at 600 rpm and 30 mm.
    pub const NOMINAL: Self = Self {
        gain: 1.0,
        flexure: 1200.0,
        damping: 0.02,
        coulomb: 0.01,
        ripple: 6e-3,
        hum: 0.0,
        cutting: [2.0, 0.1, 0.03],
        spindle_ripple: [6e-3, 2.5e-3],
        speed: |_| 600.0 * RPM,
        radius: 0.03,
        delay: 1,
        arm_delay: 0,
        quantised: true,
    };

    /// Without friction, cutting and ripple, with ideal encoders.
    pub const IDEAL: Self = Self {
        coulomb: 0.0,
        ripple: 0.0,
        cutting: [0.0; 3],
        spindle_ripple: [0.0; 2],
        quantised: false,
        ..Self::NOMINAL
    };
}

/// The machine at one instant.
#[derive(Clone)]
pub struct Machine {
    build: Build,
    random: Pcg64Mcg,
    phases: [f64; 4],
    transition: Matrix5<f64>,
    /// from command, torque on the hub and torque on the arm
    input: SMatrix<f64, 5, 3>,
    /// angles of hub and arm, their velocities, torque
    state: SVector<f64, 5>,
    pending: Vec<f64>,
    /// arm angles in transit
    seen: VecDeque<f64>,
    noise: f64,
    time: f64,
    spindle: f64,
    slide: f64,
    /// The tool is in the part.
    pub in_part: bool,
    /// Speed of the slide in addition to 10 um per revolution, m/s.
    pub feed: f64,
}

impl Machine {
    /// The machine with the arm along the slide; phases and noise from `seed`.
    pub fn new(build: &Build, seed: u64) -> Self {
        let mut random = Pcg64Mcg::seed_from_u64(seed);
        let angle = Uniform::new(0.0, TAU).unwrap();
        let phases = [0; 4].map(|_| angle.sample(&mut random));
        let spindle = angle.sample(&mut random);
        let (transition, input) = sampled(build, DT);
        Self {
            random,
            phases,
            transition,
            input,
            state: SVector::zeros(),
            pending: vec![0.0; build.delay],
            seen: vec![0.0; build.arm_delay + 1].into(),
            noise: 0.0,
            time: 0.0,
            spindle,
            slide: 0.15 - ARM_LENGTH - build.radius,
            in_part: false,
            feed: 0.0,
            build: build.clone(),
        }
    }

    /// Measured arm (rad), spindle (rad) and slide (m).
    pub fn read(&self) -> [f64; 3] {
        let round = |x: f64, quantum: f64| if self.build.quantised { (x / quantum).round() * quantum } else { x };
        [round(self.seen[0], TAU / 8_388_608.0), round(self.spindle, TAU / 1_048_576.0), round(self.slide, 1e-7)]
    }

    /// From now on the drive has another gain.
    pub fn set_gain(&mut self, gain: f64) {
        self.build.gain = gain;
    }

    /// True depth of the tool, m.
    pub fn tip_depth(&self) -> f64 {
        ARM_LENGTH * (ARM_ZERO + self.state[1]).sin()
    }

    /// One communication step with a command (N.m).
    pub fn advance(&mut self, command: f64) {
        self.pending.push(command);
        let commanded = self.pending.remove(0).clamp(-TORQUE_MAX, TORQUE_MAX);
        let commanded = self.build.gain * (commanded / (TORQUE_MAX / 32_768.0)).round() * (TORQUE_MAX / 32_768.0);
        for _ in 0..SUBSTEPS {
            self.substep(commanded);
        }
        self.seen.pop_front();
        self.seen.push_back(self.state[0]);
    }

    fn substep(&mut self, commanded: f64) {
        let Build { cutting: [mean, twice, sigma], ripple, hum, .. } = self.build;
        let keep = (-TAU * 800.0 * DT).exp();
        let normal: f64 = StandardNormal.sample(&mut self.random);
        self.noise = keep * self.noise + sigma * (1.0 - keep * keep).sqrt() * normal;
        let thrust = if self.in_part { mean + twice * (2.0 * self.spindle).cos() + self.noise } else { 0.0 };
        let hub = ripple * (12.0 * self.spindle + self.phases[0]).sin()
            + hum * (TAU * 120.0 * self.time + self.phases[1]).sin();
        let arm = -thrust * ARM_LENGTH * (ARM_ZERO + self.state[1]).cos();
        self.state = self.transition * self.state + self.input * SVector::from([commanded, hub, arm]);
        // dry friction takes speed from the hub, never turns it
        let loss = self.build.coulomb * DT / HUB;
        self.state[2] -= self.state[2].clamp(-loss, loss);
        let speed = (self.build.speed)(self.time)
            + self.build.spindle_ripple[0] * (self.spindle + self.phases[2]).sin()
            + self.build.spindle_ripple[1] * (12.0 * self.spindle + self.phases[3]).sin();
        self.spindle += speed * DT;
        self.slide += (1e-5 * speed / TAU + self.feed) * DT;
        self.time += DT;
    }
}

const HUB: f64 = 4.5e-4;
const TOOL: f64 = 3.5e-4;

/// The linear part over a time (s) with held inputs: transition and input matrix.
///
/// States are the angles of hub and arm, their velocities and the torque; inputs are the command and the torques on hub
/// and arm.
pub fn sampled(build: &Build, dt: f64) -> (Matrix5<f64>, SMatrix<f64, 5, 3>) {
    let (locked, current) = (TAU * build.flexure, TAU * 2000.0);
    let (stiffness, damping) = (TOOL * locked * locked, 2.0 * build.damping * TOOL * locked);
    let mut a = SMatrix::<f64, 8, 8>::zeros();
    a[(0, 2)] = 1.0;
    a[(1, 3)] = 1.0;
    for (row, sign, inertia) in [(2, -1.0, HUB), (3, 1.0, TOOL)] {
        a[(row, 0)] = sign * stiffness / inertia;
        a[(row, 1)] = -sign * stiffness / inertia;
        a[(row, 2)] = sign * damping / inertia;
        a[(row, 3)] = -sign * damping / inertia;
    }
    a[(2, 2)] -= 2e-3 / HUB;
    a[(2, 4)] = 1.0 / HUB;
    a[(4, 4)] = -current;
    a[(4, 5)] = current;
    a[(2, 6)] = 1.0 / HUB;
    a[(3, 7)] = 1.0 / TOOL;
    let sampled = (a * dt).exp();
    (sampled.fixed_view::<5, 5>(0, 0).into(), sampled.fixed_view::<5, 3>(0, 5).into())
}

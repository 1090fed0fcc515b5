//! A slide with a shaft motor, a spindle and a two-flute tool: the plant of the statistics, natively in Rust.
//!
//! Values are typical of small ultra-precision machines; the motor and the mass are 3 to 4 % off the
//! nominal ones of the controller on purpose.

use std::f64::consts::{PI, TAU};

use control_blocks::SentCommands;
use rand::SeedableRng;
use rand_distr::{Distribution, StandardNormal, Uniform};
use rand_pcg::Pcg64Mcg;

/// Communication step, s.
pub const STEP: f64 = 1e-4;
/// Spindle speed, rad/s: 30 000 rpm.
pub const SPINDLE_SPEED: f64 = 1000.0 * PI;

const SUBSTEPS: usize = 2;
const DT: f64 = STEP / SUBSTEPS as f64;
const MASS: f64 = 10.4;
const DAMPING: f64 = 10.0;
const FORCE_CONSTANT: f64 = 19.4;
const RIPPLE: f64 = 0.01;
const POLE_PITCH: f64 = 0.03;
const COGGING: [f64; 2] = [0.2, 0.05];
const BALANCER_SIGMA: f64 = 0.02;
const BALANCER_TIME: f64 = 0.5;
const AIR_SIGMA: f64 = 1e-3;
const AIR_BANDWIDTH: f64 = TAU * 500.0;
const SPINDLE_FORCE: [f64; 2] = [0.02, 0.01];
const ENCODER_NOISE: f64 = 0.5e-9;
const ENCODER_STEP: f64 = 1e-9;
const AMPLIFIER_NOISE: f64 = 50e-6;
const CURRENT_BANDWIDTH: f64 = TAU * 1000.0;
const STIFFNESS: f64 = 2e5;
const TILT: f64 = 50e-9;
const SECOND_FLUTE: f64 = 100e-9;

/// The slide at one instant.
#[derive(Clone)]
pub struct Slide {
    random: Pcg64Mcg,
    surface: f64,
    position: f64,
    velocity: f64,
    current: f64,
    sent: SentCommands,
    angle: f64,
    residual: f64,
    balancer: f64,
    air: f64,
    /// Travel past the first possible touch, largest so far, m.
    pub depth: f64,
    /// Position at the first real touch, m.
    pub touch: Option<f64>,
    /// Extra force against the stage, N.
    pub push: f64,
    /// Contact force of the last substep, N.
    pub contact_force: f64,
    /// Fraction of the thrust that the drive supplies.
    pub strength: f64,
    /// Stiffness of the work at each flute, N/m.
    pub stiffness: f64,
    /// Moving mass, kg.
    pub mass: f64,
    /// Samples between a command and its action.
    pub delay: usize,
    /// Noise of encoder, amplifier, air and balancer, over the usual one.
    pub noise: f64,
    /// Bandwidth of the current loop over the usual one.
    pub loop_speed: f64,
    /// Relative ripple of the thrust where it begins.
    pub ripple: f64,
}

impl Slide {
    /// At rest at 0, the workpiece at `surface` m; all noise from `seed`.
    pub fn new(seed: u64, surface: f64) -> Self {
        let mut random = Pcg64Mcg::seed_from_u64(seed);
        let residual = Uniform::new(-0.5, 0.5).unwrap().sample(&mut random);
        let angle = Uniform::new(0.0, TAU).unwrap().sample(&mut random);
        Self {
            random,
            surface,
            position: 0.0,
            velocity: 0.0,
            current: 0.0,
            sent: SentCommands::default(),
            angle,
            residual,
            balancer: 0.0,
            air: 0.0,
            depth: f64::NEG_INFINITY,
            touch: None,
            push: 0.0,
            contact_force: 0.0,
            stiffness: STIFFNESS,
            strength: 1.0,
            mass: MASS,
            delay: 1,
            noise: 1.0,
            loop_speed: 1.0,
            ripple: 0.0,
        }
    }

    /// Samples the encoder: position with noise, rounded to a step of the encoder, m.
    pub fn encoder(&mut self) -> f64 {
        let noisy = self.position + self.noise * ENCODER_NOISE * self.normal();
        (noisy / ENCODER_STEP).round() * ENCODER_STEP
    }

    /// Where it is, m.
    pub fn position(&self) -> f64 {
        self.position
    }

    /// One communication step; the command (A) acts `delay` steps later.
    pub fn advance(&mut self, command: f64) {
        self.sent.send(command);
        let sent = self.sent.before(self.delay) + self.noise * AMPLIFIER_NOISE * self.normal();
        self.balancer = coloured(self.balancer, self.noise * BALANCER_SIGMA, 1.0 / BALANCER_TIME, self.normal());
        self.air = coloured(self.air, self.noise * AIR_SIGMA, AIR_BANDWIDTH, self.normal());
        for _ in 0..SUBSTEPS {
            self.substep(sent);
        }
    }

    fn substep(&mut self, sent: f64) {
        self.current = sent + (self.current - sent) * (-CURRENT_BANDWIDTH * self.loop_speed * DT).exp();
        let phase = TAU * self.position / POLE_PITCH;
        let motor = self.strength * FORCE_CONSTANT * (1.0 + self.ripple + RIPPLE * phase.sin()) * self.current;
        let cogging = COGGING[0] * phase.sin() + COGGING[1] * (2.0 * phase).sin();
        let spindle = SPINDLE_FORCE[0] * self.angle.sin() + SPINDLE_FORCE[1] * (2.0 * self.angle).cos();
        let disturbance = self.residual + self.balancer + self.air + cogging + spindle + self.push;
        self.contact_force = self.flute(0.0, 0.0) + self.flute(SECOND_FLUTE, PI);
        let force = motor - DAMPING * self.velocity - disturbance - self.contact_force;
        self.velocity += DT * force / self.mass;
        self.position += DT * self.velocity;
        self.angle = (self.angle + SPINDLE_SPEED * DT) % TAU;
        self.depth = self.depth.max(self.position - self.surface);
        if self.contact_force > 0.0 && self.touch.is_none() {
            self.touch = Some(self.position);
        }
    }

    /// Force of the flute that is shorter by `short` m, at `phase` rad; the tilt lifts it once per revolution.
    fn flute(&self, short: f64, phase: f64) -> f64 {
        let lift = short + TILT * (1.0 - (self.angle + phase).cos());
        self.stiffness * (self.position - self.surface - lift).max(0.0)
    }

    fn normal(&mut self) -> f64 {
        StandardNormal.sample(&mut self.random)
    }
}

/// Next value of exponentially correlated noise.
fn coloured(x: f64, sigma: f64, bandwidth: f64, normal: f64) -> f64 {
    let keep = (-bandwidth * STEP).exp();
    keep * x + sigma * (1.0 - keep * keep).sqrt() * normal
}

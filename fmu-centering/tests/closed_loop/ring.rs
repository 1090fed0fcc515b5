//! A ring on a spindle, a probe, a pusher and a slide: the plant of the integration tests, natively in Rust.
//!
//! Quasi-static: the ring is at rest on the table except while the pusher moves it, and stays where the pusher leaves it.
//! The table turns under the contact, the pusher drags the ring sideways by its own friction, and the slide yields
//! by the friction of the ring before the ring moves. All values are typical, of the size in the paper.

use std::f64::consts::TAU;

use rand::SeedableRng;
use rand_distr::{Distribution, StandardNormal};
use rand_pcg::Pcg64Mcg;

/// Communication step, s.
pub const STEP: f64 = 1e-3;
/// 20 rpm, rad/s.
pub const SPEED: f64 = TAU / 3.0;

const SUBSTEPS: u32 = 10;
const DT: f64 = STEP / SUBSTEPS as f64;
/// Time constant of the servo, s.
const SERVO_TIME: f64 = 4e-3;
/// Probe deflection at which the pusher touches, m.
pub const AT_PUSHER: f64 = 0.020;
/// Distance of the pusher from a centered ring at the start, m.
const START_GAP: f64 = 0.070;
const SLIDE_STEP: f64 = 20e-9;
const PROBE_STEP: f64 = 50e-9;
const PROBE_NOISE: f64 = 0.03e-6;
const SPINDLE_STEP: f64 = TAU / 4000.0;
/// Amplitudes of two and three lobes, m.
const LOBES: [f64; 2] = [2e-6, 1e-6];

/// A servo of the slide with mass, in place of a lag.
#[derive(Clone, Copy, Debug)]
pub struct Servo {
    /// Natural frequency, Hz.
    pub frequency: f64,
    /// Damping ratio.
    pub damping: f64,
    /// Integral action: reciprocal of the integral time, 1/s.
    pub integral: f64,
    /// Samples between a setpoint and its action, at most 3.
    pub delay: usize,
    /// Gain of the motion relative to the setpoint.
    pub ratio: f64,
    /// Its own steps in 0.1 ms.
    pub steps: u32,
}

/// A servo of 40 Hz as configured in the controller.
pub const NOMINAL: Servo = Servo { frequency: 40.0, damping: 0.7, integral: 0.0, delay: 1, ratio: 1.0, steps: 20 };

/// The machine at one instant.
#[derive(Clone)]
pub struct Ring {
    random: Pcg64Mcg,
    /// Outer radius, m.
    pub radius: f64,
    /// Center in the table frame, m.
    pub center: [f64; 2],
    /// Whether there is a ring.
    pub present: bool,
    /// Speed of the spindle, rad/s.
    pub speed: f64,
    /// Angle of the spindle, rad.
    pub angle: f64,
    /// Where the three lobes are on the ring, rad.
    pub lobe_phase: f64,
    /// Friction between pusher and ring.
    pub pusher_friction: f64,
    /// How far the slide yields before the ring moves, m.
    pub compliance: f64,
    /// Servo of the slide; none: a lag without mass.
    pub servo: Option<Servo>,
    /// Velocity of a slide with mass (m/s) and integral of its error, m.
    moving: [f64; 2],
    free_slide: f64,
    deflection: f64,
    /// Setpoints, the newest first.
    pending: [[f64; 2]; 4],
}

impl Ring {
    /// A ring of 50 mm, `eccentricity` m off in the direction `phase` rad, at 20 rpm.
    pub fn new(seed: u64, eccentricity: f64, phase: f64) -> Self {
        Self {
            random: Pcg64Mcg::seed_from_u64(seed),
            radius: 0.05,
            center: [eccentricity * phase.cos(), eccentricity * phase.sin()],
            present: true,
            speed: SPEED,
            angle: 0.0,
            lobe_phase: 1.0,
            pusher_friction: 0.12,
            compliance: 4e-6,
            servo: None,
            moving: [0.0; 2],
            free_slide: 0.0,
            deflection: 0.0,
            pending: [[0.0; 2]; 4],
        }
    }

    /// Distance of the ring's center from the spindle axis, m.
    pub fn eccentricity(&self) -> f64 {
        self.center[0].hypot(self.center[1])
    }

    /// Gap between pusher and ring, negative where they overlap, m.
    pub fn gap(&self) -> f64 {
        self.pusher() - self.surface()
    }

    /// Measurements with noise and resolution: spindle angle (wrapped, rad), slide and probe positions (m).
    pub fn read(&mut self) -> [f64; 3] {
        let noise: f64 = StandardNormal.sample(&mut self.random);
        let collapse = (AT_PUSHER - self.gap()).max(0.0);
        let probe = if collapse > 0.0 { collapse + PROBE_NOISE * noise } else { 0.0 };
        let angle = rounded(self.angle, SPINDLE_STEP).rem_euclid(TAU);
        [angle, rounded(self.slide(), SLIDE_STEP), rounded(probe, PROBE_STEP)]
    }

    /// One communication step; the setpoint (m, m/s) acts from the next step on, or after the delay of the servo.
    pub fn advance(&mut self, position: f64, velocity: f64) {
        self.pending.rotate_right(1);
        self.pending[0] = [position, velocity];
        let [position, velocity] = self.pending[self.servo.map_or(1, |servo| servo.delay)];
        for k in 0..SUBSTEPS {
            let setpoint = position + velocity * DT * f64::from(k);
            match self.servo {
                Some(servo) => self.accelerate(&servo, setpoint, velocity),
                None => self.free_slide += DT * (velocity + (setpoint - self.free_slide) / SERVO_TIME),
            }
            self.angle += DT * self.speed;
            self.push();
        }
    }

    /// A step of a slide with mass, in finer ones.
    fn accelerate(&mut self, servo: &Servo, setpoint: f64, velocity: f64) {
        let (w, dt) = (TAU * servo.frequency, DT / f64::from(servo.steps));
        for k in 0..servo.steps {
            let [speed, sum] = self.moving;
            let error = servo.ratio * (setpoint + velocity * dt * f64::from(k)) - self.free_slide;
            let force = w * w * (error + sum) + 2.0 * servo.damping * w * (servo.ratio * velocity - speed);
            self.moving = [speed + dt * force, sum + dt * servo.integral * error];
            self.free_slide += dt * self.moving[0];
        }
    }

    /// The slide yields up to its compliance; what is left moves the ring.
    fn push(&mut self) {
        self.deflection = 0.0;
        let overlap = -self.gap();
        self.deflection = overlap.clamp(0.0, self.compliance);
        let distance = overlap - self.deflection;
        if distance > 0.0 {
            let [x, y] = self.world();
            // along the normal of the contact, and across it against the turning
            let (sine, drag) = (y / self.radius, self.speed.signum() * self.pusher_friction);
            let cosine = (1.0 - sine * sine).sqrt();
            let [along, across] = [-cosine - drag * sine, sine - drag * cosine];
            let ratio = distance / (across * sine / cosine - along);
            self.center = rotated([x + ratio * along, y + ratio * across], -self.angle);
        }
    }

    /// Position of the slide, m.
    pub fn slide(&self) -> f64 {
        self.free_slide - self.deflection
    }

    fn pusher(&self) -> f64 {
        self.radius + START_GAP - self.slide()
    }

    fn world(&self) -> [f64; 2] {
        rotated(self.center, self.angle)
    }

    /// Place of the surface on the line of the slide, m; far away without a ring.
    fn surface(&self) -> f64 {
        let [x, y] = self.world();
        if !self.present || y.abs() >= self.radius {
            return -1.0;
        }
        let phi = (-y / self.radius).asin() - self.angle;
        let form = LOBES[0] * (2.0 * phi).cos() + LOBES[1] * (3.0 * phi + self.lobe_phase).cos();
        x + (self.radius * self.radius - y * y).sqrt() + form
    }
}

fn rotated([x, y]: [f64; 2], angle: f64) -> [f64; 2] {
    let (sine, cosine) = angle.sin_cos();
    [x * cosine - y * sine, x * sine + y * cosine]
}

fn rounded(x: f64, step: f64) -> f64 {
    (x / step).round() * step
}

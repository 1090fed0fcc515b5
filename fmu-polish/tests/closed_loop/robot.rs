//! Three axes with servos, a tip that bends, friction, a force sensor and a spherical hollow, natively in Rust.
//!
//! Values are those of the plant `orthogonal_robot`; tip and contact are springs without mass.

use fmu_polish::interface::Parameters;
use nalgebra::Vector3;
use rand::SeedableRng;
use rand_distr::{Distribution, StandardNormal};
use rand_pcg::Pcg64Mcg;

use crate::common::HOLLOW;

/// Communication step, s.
pub const STEP: f64 = 1e-3;

const SUBSTEPS: usize = 10;
const DT: f64 = STEP / SUBSTEPS as f64;
const MASS: f64 = 20.0;
const SENSOR_NOISE: f64 = 0.05;
const SENSOR_STEP: f64 = 0.178;
const SENSOR_BANDWIDTH: f64 = 1256.6;
const WEIGHT: Vector3<f64> = Vector3::new(0.0, 0.0, -0.098);
/// Travel in which the rolling friction of a guide reverses, m.
const ROLLING_DISTANCE: f64 = 20e-6;
const TOOL_RADIUS: f64 = 0.5e-3;

/// Properties in which robots differ.
#[derive(Clone, Copy, Debug)]
pub struct Build {
    /// Stiffness of tip and contact along the normal, N/m.
    pub stiffness: f64,
    /// Stiffness of the tip across it, N/m.
    pub lateral: f64,
    /// Friction of tool on mold.
    pub friction: f64,
    /// Friction of a drive, N.
    pub drive_friction: f64,
    /// Factor of the gains of the drives.
    pub drive_gain: f64,
    /// Shift of the mold, m.
    pub shift: Vector3<f64>,
    /// Height of the ball above the start of the path, m.
    pub height: f64,
    /// Ratio of executed to commanded pulses of each axis: 0 for a dead drive, -1 for a reversed one.
    pub pulses: Vector3<f64>,
    /// Samples by which pulses act later than one.
    pub late: usize,
    /// Fraction of the velocity that the drives feed forward.
    pub feedforward: f64,
    /// Angle about z by which the force sensor is turned, rad.
    pub rotation: f64,
    /// Signs of the axes of the sensor: 1, or -1 for a reversed axis.
    pub signs: Vector3<f64>,
}

impl Build {
    /// The nominal robot.
    pub const NOMINAL: Self = Self {
        stiffness: 178e3,
        lateral: 209e3,
        friction: 0.2,
        drive_friction: 2.0,
        drive_gain: 1.0,
        shift: Vector3::new(0.0, 0.0, 0.0),
        height: 0.2e-3,
        pulses: Vector3::new(1.0, 1.0, 1.0),
        late: 0,
        feedforward: 0.8,
        rotation: 0.0,
        signs: Vector3::new(1.0, 1.0, 1.0),
    };
}

/// One axis with its servo.
#[derive(Clone, Copy, Debug, Default)]
struct Axis {
    reference: f64,
    ahead: f64,
    integral: f64,
    position: f64,
    velocity: f64,
    roll: f64,
}

impl Axis {
    fn substep(&mut self, build: &Build, commanded: Option<f64>, load: f64) {
        let push = if let Some(commanded) = commanded { self.servo(build, commanded) } else { self.off() };
        self.roll = (self.roll + self.velocity * DT) / (1.0 + self.velocity.abs() * DT / ROLLING_DISTANCE);
        let friction = build.drive_friction * self.roll / ROLLING_DISTANCE;
        self.velocity += DT * (push + (load - friction) / MASS);
        self.position += DT * self.velocity;
    }

    /// No force, and nothing to go back to.
    fn off(&mut self) -> f64 {
        (self.reference, self.ahead, self.integral) = (self.position, 0.0, 0.0);
        0.0
    }

    /// Acceleration by the loops, m/s2.
    fn servo(&mut self, build: &Build, commanded: f64) -> f64 {
        let drive = Parameters::START.drive;
        self.reference += commanded * DT;
        self.ahead += (commanded - self.ahead) * DT * drive.feedforward_bandwidth;
        let target =
            build.drive_gain * drive.position_gain * (self.reference - self.position) + build.feedforward * self.ahead;
        let lag = target - self.velocity;
        self.integral += drive.velocity_integral * lag * DT;
        build.drive_gain * drive.velocity_bandwidth * (lag + self.integral)
    }
}

/// The robot at one instant.
#[derive(Clone)]
pub struct Robot {
    random: Pcg64Mcg,
    axes: [Axis; 3],
    /// pulses that have not acted, the newest first
    pending: [Vector3<i32>; 3],
    /// lateral deflection of the tip, m
    bend: Vector3<f64>,
    filtered: Vector3<f64>,
    /// Properties of the robot; may change during a run.
    pub build: Build,
    /// True normal force, N.
    pub normal_force: f64,
    /// Travel that the ball slid, m.
    pub slid: f64,
}

impl Robot {
    /// At rest above `start`; all noise from `seed`.
    pub fn new(build: Build, start: Vector3<f64>, seed: u64) -> Self {
        let axis = |x| Axis { reference: x, position: x, ..Axis::default() };
        Self {
            random: Pcg64Mcg::seed_from_u64(seed),
            axes: [axis(start.x), axis(start.y), axis(start.z)],
            pending: [Vector3::zeros(); 3],
            bend: Vector3::zeros(),
            filtered: WEIGHT,
            build,
            normal_force: 0.0,
            slid: 0.0,
        }
    }

    /// Encoder positions, rounded to 1 um, m.
    pub fn position(&self) -> Vector3<f64> {
        self.actual().map(|x| (x * 1e6).round() * 1e-6)
    }

    /// Samples the force sensor: filtered force in the axes of the sensor, with noise, rounded to a step, N.
    pub fn force(&mut self) -> Vector3<f64> {
        let f = self.filtered;
        let (sin, cos) = self.build.rotation.sin_cos();
        let shown = Vector3::new(f.x * cos + f.y * sin, f.y * cos - f.x * sin, f.z).component_mul(&self.build.signs);
        let noisy = shown + Vector3::from_fn(|_, _| SENSOR_NOISE * self.normal());
        noisy.map(|f| (f / SENSOR_STEP).round() * SENSOR_STEP)
    }

    /// One communication step; the pulses act from the next step on. Without `enable` the motors give no force.
    pub fn advance(&mut self, pulses: Vector3<i32>, enable: bool) {
        let commanded = self.pending[self.build.late].map(|count| 1e-6 * f64::from(count) / STEP);
        self.pending.rotate_right(1);
        self.pending[0] = pulses;
        let commanded = commanded.component_mul(&self.build.pulses);
        for _ in 0..SUBSTEPS {
            let load = self.contact();
            for i in 0..3 {
                self.axes[i].substep(&self.build, enable.then_some(commanded[i]), load[i]);
            }
            self.filtered += (load + WEIGHT - self.filtered) * (1.0 - (-SENSOR_BANDWIDTH * DT).exp());
        }
    }

    fn actual(&self) -> Vector3<f64> {
        Vector3::from_fn(|i, _| self.axes[i].position)
    }

    /// Force of the mold on the tool, N; moves the sliding tip.
    fn contact(&mut self) -> Vector3<f64> {
        let middle = self.build.shift + Vector3::new(0.0, 0.0, HOLLOW);
        let away = self.actual() - middle;
        let depth = away.norm() - (HOLLOW - TOOL_RADIUS);
        self.normal_force = self.build.stiffness * depth.max(0.0);
        let normal = -away.normalize();
        let velocity = Vector3::from_fn(|i, _| self.axes[i].velocity);
        let bend = self.bend - velocity * DT;
        let bend = bend - normal * normal.dot(&bend);
        let maximum = self.build.friction * self.normal_force / self.build.lateral;
        self.bend = if bend.norm() > maximum { bend * (maximum / bend.norm()) } else { bend };
        if depth > 0.0 {
            self.slid += (bend - self.bend).norm();
        }
        normal * self.normal_force + self.bend * self.build.lateral
    }

    fn normal(&mut self) -> f64 {
        StandardNormal.sample(&mut self.random)
    }
}

//! Six axes with ideal velocity drives, eq. 1, and encoders: the plant of the closed loops, natively in Rust.

use fmu_deburr::interface::Parameters;
use fmu_deburr::path::{AXES, Joints};
use nalgebra::{Matrix3, Matrix4, Vector3};
use rand::SeedableRng;
use rand_distr::{Distribution, StandardNormal};

/// Communication step, s.
pub const STEP: f64 = 0.01;

/// Properties of the simulated robot that a test can set; all drives are alike.
#[derive(Clone, Copy, Debug)]
pub struct Build {
    /// Velocity over commanded velocity.
    pub gain: f64,
    /// Natural frequency of the drives over that of eq. 1.
    pub dynamics: f64,
    /// Damping ratio over that of eq. 1.
    pub damping: f64,
    /// Samples between a command and its action.
    pub delay: usize,
    /// Noise of the encoders, standard deviation in pulses.
    pub noise: f64,
    /// Distance at the tip by which Coulomb friction holds a drive back, F/(m wn^2), m.
    pub friction: f64,
}

impl Build {
    /// The robot of the paper.
    pub const NOMINAL: Self = Self { gain: 1.0, dynamics: 1.0, damping: 1.0, delay: 1, noise: 0.0, friction: 0.0 };
}

/// Levers of the axes at the tip, m/rad or 1.
pub const LEVERS: Joints = [0.7, 1.0, 1.0, 0.2, 0.2, 0.1];
/// Steps of a drive with friction in a step of the robot.
const SUBSTEPS: u32 = 200;

/// Drive of an axis with Coulomb friction.
#[derive(Clone, Copy)]
struct Rubbing {
    wn: f64,
    zeta: f64,
    held: f64,
    /// place to which the drive is sent
    sent: f64,
}

impl Rubbing {
    /// One step with a velocity; `axis` is position, velocity and its derivative.
    fn advance(&mut self, axis: &mut Vector3<f64>, velocity: f64) {
        let dt = STEP / f64::from(SUBSTEPS);
        for _ in 0..SUBSTEPS {
            self.sent += velocity * dt;
            let (free, rubs) = (self.wn * self.wn * (self.sent - axis[0]), self.wn * self.wn * self.held);
            // sticks within its friction, and reverses through standstill
            let side = if axis[1] == 0.0 { free.clamp(-rubs, rubs) } else { rubs * axis[1].signum() };
            let next = axis[1] + (free - side - 2.0 * self.zeta * self.wn * axis[1]) * dt;
            axis[1] = if axis[1] * next < 0.0 { 0.0 } else { next };
            axis[0] += axis[1] * dt;
        }
    }
}

/// The robot: sampled exactly, except drives with friction.
#[derive(Clone)]
pub struct Robot {
    a: Matrix3<f64>,
    b: Vector3<f64>,
    /// position, velocity, its derivative
    axes: [Vector3<f64>; AXES],
    rubbing: Option<[Rubbing; AXES]>,
    sent: Vec<Joints>,
    pulses: Joints,
    /// Velocity over commanded velocity.
    pub gain: f64,
    /// Noise of the encoders, standard deviation in pulses.
    pub noise: f64,
    random: rand_pcg::Pcg64Mcg,
}

impl Robot {
    /// At rest at `joints`.
    pub fn new(build: &Build, joints: &Joints) -> Self {
        let (wn, zeta) = (280.0 * build.dynamics, 0.52 * build.damping);
        let rubbing = |i: usize| Rubbing { wn, zeta, held: build.friction / LEVERS[i], sent: joints[i] };
        let mut continuous = Matrix4::zeros();
        (continuous[(0, 1)], continuous[(1, 2)]) = (STEP, STEP);
        (continuous[(2, 1)], continuous[(2, 2)]) = (-wn * wn * STEP, -2.0 * zeta * wn * STEP);
        continuous[(2, 3)] = wn * wn * STEP;
        let sampled = continuous.exp();
        Self {
            a: sampled.fixed_view::<3, 3>(0, 0).into(),
            b: sampled.fixed_view::<3, 1>(0, 3).into(),
            axes: joints.map(|position| Vector3::new(position, 0.0, 0.0)),
            rubbing: (build.friction > 0.0).then(|| std::array::from_fn(rubbing)),
            sent: vec![[0.0; AXES]; build.delay],
            pulses: Parameters::START.pulses(),
            gain: build.gain,
            noise: build.noise,
            random: rand_pcg::Pcg64Mcg::seed_from_u64(1998),
        }
    }

    /// Encoder measurements.
    pub fn read(&mut self) -> Joints {
        std::array::from_fn(|i| {
            let noise: f64 = if self.noise > 0.0 { StandardNormal.sample(&mut self.random) } else { 0.0 };
            (self.axes[i][0] / self.pulses[i] + self.noise * noise).floor() * self.pulses[i]
        })
    }

    /// True positions.
    pub fn positions(&self) -> Joints {
        self.axes.map(|axis| axis[0])
    }

    /// One step with the velocity commands.
    pub fn advance(&mut self, command: &Joints) {
        self.sent.push(*command);
        let command = self.sent.remove(0);
        for (i, (axis, command)) in self.axes.iter_mut().zip(command).enumerate() {
            match &mut self.rubbing {
                Some(drives) => drives[i].advance(axis, self.gain * command),
                None => *axis = self.a * *axis + self.b * (self.gain * command),
            }
        }
    }
}

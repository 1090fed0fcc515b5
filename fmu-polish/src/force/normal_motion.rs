//! Everything that moves the tool along the normal while it presses: force control, ripple, misalignment.

use nalgebra::Vector3;
use serde::{Deserialize, Serialize};

use super::impedance::{Coefficients, ForceLaw, damping};
use super::margin::{PHASE_MARGIN_MIN, phase_margin};
use super::misalignment::MisalignmentEstimate;
use super::repetitive::RepetitiveControl;
use super::ripple::RippleCancellation;
use super::stiffness::Slope;
use super::turning::Turning;
use crate::interface::Parameters;
use crate::path::centre_path::{CentrePath, Frame, PathPosition};

/// The normal motion of a pressing tool.
#[derive(Clone, Debug, Serialize, Deserialize)]
pub struct NormalMotion {
    force_law: ForceLaw,
    slope: Slope,
    /// Stiffness of tool and contact in use, N/m.
    pub stiffness: f64,
    /// Damping in use, N s/m; none for that of the parameters.
    damping: Option<f64>,
    /// the integral works
    following: bool,
    /// the parameters that were evaluated last, and whether the loop is stable
    evaluated: Option<(Tuned, bool)>,
    /// Cancellation of the ripple.
    pub ripple: RippleCancellation,
    turning: Turning,
    /// Repetitive control: learns disturbances that recur with each revolution of the path.
    pub repetitive: RepetitiveControl,
    /// Estimate of the misalignment.
    pub misalignment: MisalignmentEstimate,
}

/// Values that decide the stability of the loop and may change during a cycle: K_f, B_d, T_i and the stiffness.
type Tuned = (f64, f64, f64, f64);

/// Measurements of one sample for the motion along the normal.
#[derive(Clone, Copy, Debug)]
pub struct NormalMeasurement {
    /// Target minus measured force, N.
    pub error: f64,
    /// Force along the normal, N.
    pub force: f64,
    /// Ball center by the encoders, m.
    pub position: Vector3<f64>,
    /// There is a force at all.
    pub touching: bool,
}

impl NormalMotion {
    /// Free, the stiffness nominal.
    pub fn new(p: &Parameters) -> Self {
        let stiffness = p.stiffness_nominal;
        Self {
            force_law: ForceLaw::default(),
            slope: Slope::default(),
            stiffness,
            damping: None,
            following: false,
            evaluated: None,
            ripple: RippleCancellation::new(p, &Coefficients::new(p, p.impedance.damping), stiffness),
            turning: Turning::default(),
            repetitive: RepetitiveControl::default(),
            misalignment: MisalignmentEstimate::new(),
        }
    }

    /// Begins at the contact, without a bump from the approach.
    pub fn touch(&mut self, p: &Parameters) {
        *self = Self::new(p);
        self.force_law.velocity = -p.approach.velocity;
    }

    /// Begins to follow the path with what was learned of the stiffness.
    pub fn follow(&mut self, p: &Parameters) {
        self.stiffness = self.slope.stiffness(p.stiffness_nominal);
        (self.following, self.evaluated) = (true, None);
        self.damping = p.impedance.adaptive.then(|| damping(p, self.stiffness));
    }

    /// The sweep begins, or has another half period: its ripple is learned again.
    pub fn restart_sweep(&mut self, p: &Parameters) {
        self.ripple = RippleCancellation::new(p, &self.law(p), self.stiffness);
    }

    /// Begins to take the force away.
    pub fn unload(&mut self) {
        self.force_law.integral = 0.0;
    }

    /// Velocity (m/s) of the force control alone, while the force builds up or decreases.
    pub fn settle(&mut self, p: &Parameters, error: f64) -> f64 {
        self.force_law.step(&self.law(p), error)
    }

    /// Takes a force `force` (N) at the position `position` (m), for the stiffness.
    pub fn observe_stiffness(&mut self, p: &Parameters, position: &Vector3<f64>, normal: &Vector3<f64>, force: f64) {
        self.slope.update(-position.dot(normal), force, p.force.target);
    }

    /// Velocity (m/s) along the normal at sample `k` of the path.
    pub fn step(&mut self, p: &Parameters, contact: &NormalMeasurement, k: u32, at: &PathState) -> f64 {
        let law = self.law(p);
        let mut velocity = self.force_law.step(&law, contact.error);
        // nothing is integrated or learned in the air
        let sensed = if contact.touching { contact.error } else { 0.0 };
        velocity += self.force_law.integrate(&law, sensed);
        let rotation = self.turning.step(&at.frame.tangent);
        velocity += self.ripple.step(p, k, at.sweep, rotation, contact.error);
        velocity += self.repetitive.step(p, &law, self.stiffness, rotation, sensed);
        if p.misalignment_enable {
            self.observe_surface(contact, at);
            velocity += self.feedforward(p, at);
        }
        velocity
    }

    /// Uses the distance of the surface at the position of the encoders, which lags behind that on the path.
    fn observe_surface(&mut self, contact: &NormalMeasurement, at: &PathState) {
        let lag = (at.frame.centre - contact.position).dot(&at.frame.tangent) / at.frame.ratio;
        let met = at.path.frame(at.path.seek(at.path_position, at.path_position.s - lag));
        let offset = (contact.position - met.centre).dot(&met.normal);
        self.misalignment.update(&met, offset + contact.force / self.stiffness);
    }

    /// Velocity (m/s) of a misaligned surface at the position on the path: it goes through the drives as the path does, so
    /// that the tool, as late along the normal as along the path, is right where it is.
    fn feedforward(&self, p: &Parameters, at: &PathState) -> f64 {
        let next = at.path.seek(at.path_position, at.path_position.s + at.feed * p.sample_period);
        self.misalignment.velocity(p, at.frame, &at.path.frame(next), at.feed)
    }

    /// Whether the loop has its phase margin with the parameters of now; evaluated again when they have changed.
    pub fn stable(&mut self, p: &Parameters) -> bool {
        let whole = self.law(p);
        let law = if self.following { whole } else { Coefficients { integral: 0.0, ..whole } };
        let tuned =
            (p.impedance.gain, self.damping.unwrap_or(p.impedance.damping), p.force.integral_time, self.stiffness);
        match self.evaluated {
            Some((before, stable)) if before == tuned => stable,
            _ => {
                let stable = phase_margin(p, &law, self.stiffness) >= PHASE_MARGIN_MIN;
                self.evaluated = Some((tuned, stable));
                stable
            }
        }
    }

    /// Stiffness that was found over the nominal one, or its reciprocal where that is larger.
    pub fn stiffness_ratio(&self, p: &Parameters) -> f64 {
        let ratio = self.stiffness / p.stiffness_nominal;
        ratio.max(ratio.recip())
    }

    fn law(&self, p: &Parameters) -> Coefficients {
        Coefficients::new(p, self.damping.unwrap_or(p.impedance.damping))
    }
}

/// Where on the path the tool is, and how fast it goes.
#[derive(Clone, Copy, Debug)]
pub struct PathState<'a> {
    /// The path.
    pub path: &'a CentrePath,
    /// The position on it.
    pub path_position: PathPosition,
    /// The path there.
    pub frame: &'a Frame,
    /// Feed of the contact point, m/s.
    pub feed: f64,
    /// K_v of the stick-slip motion, m/s.
    pub sweep: f64,
}

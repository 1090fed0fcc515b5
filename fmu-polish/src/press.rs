//! Everything that moves the tool along the normal while it presses: force law, ripple, misalignment.

use nalgebra::Vector3;
use serde::{Deserialize, Serialize};

use crate::impedance::{Impedance, Law, damping};
use crate::misalignment::Misalignment;
use crate::parameters::Parameters;
use crate::path::{Frame, Path, Place};
use crate::ripple::Ripple;
use crate::stiffness::Slope;

/// The normal motion of a pressing tool.
#[derive(Clone, Debug, Serialize, Deserialize)]
pub struct Press {
    impedance: Impedance,
    slope: Slope,
    /// Stiffness of tool and contact in use, N/m.
    pub stiffness: f64,
    /// Damping in use, N s/m; none for that of the parameters.
    damping: Option<f64>,
    /// Cancellation of the ripple.
    pub ripple: Ripple,
    /// Estimate of the misalignment.
    pub misalignment: Misalignment,
}

/// What is measured along the normal in one sample.
#[derive(Clone, Copy, Debug)]
pub struct Contact {
    /// Wanted less measured force, N.
    pub error: f64,
    /// Force along the normal, N.
    pub force: f64,
    /// Ball centre by the encoders less the desired one, along the normal, m.
    pub offset: f64,
}

impl Press {
    /// Free, the stiffness nominal.
    pub fn new(p: &Parameters) -> Self {
        let stiffness = p.stiffness.nominal;
        Self {
            impedance: Impedance::default(),
            slope: Slope::default(),
            stiffness,
            damping: None,
            ripple: Ripple::new(p, &Law::new(p, p.impedance.damping), stiffness),
            misalignment: Misalignment::new(),
        }
    }

    /// Begins at the contact, without a bump from the approach.
    pub fn touch(&mut self, p: &Parameters) {
        *self = Self::new(p);
        self.impedance.velocity = -p.approach.velocity;
    }

    /// Begins to follow the path with what was learned of the stiffness.
    pub fn follow(&mut self, p: &Parameters) {
        self.stiffness = self.slope.stiffness(p.stiffness.nominal);
        self.damping = p.impedance.adaptive.then(|| damping(p, self.stiffness));
        self.ripple = Ripple::new(p, &self.law(p), self.stiffness);
    }

    /// Begins to take the force away.
    pub fn unload(&mut self) {
        self.impedance.integral = 0.0;
    }

    /// Velocity (m/s) of the force law alone, while the force builds up or goes away.
    pub fn settle(&mut self, p: &Parameters, error: f64) -> f64 {
        self.impedance.step(&self.law(p), error)
    }

    /// Takes a force `force` (N) at the place `position` (m), for the stiffness.
    pub fn feel(&mut self, p: &Parameters, position: &Vector3<f64>, normal: &Vector3<f64>, force: f64) {
        self.slope.update(-position.dot(normal), force, p.force.target);
    }

    /// Velocity (m/s) along the normal at sample `k` of the path.
    pub fn step(&mut self, p: &Parameters, contact: &Contact, k: u32, way: &Way) -> f64 {
        let law = self.law(p);
        let mut velocity = self.impedance.step(&law, contact.error);
        velocity += self.impedance.integrate(&law, contact.error);
        velocity += self.ripple.step(p, k, contact.error);
        if p.misalignment.enable {
            self.misalignment.update(p, way.frame, contact.offset + contact.force / self.stiffness);
            velocity += self.ahead(p, way);
        }
        velocity
    }

    /// Velocity (m/s) of a misaligned surface a little ahead.
    fn ahead(&self, p: &Parameters, way: &Way) -> f64 {
        if way.place.s < p.misalignment.distance_min {
            return 0.0;
        }
        let begin = way.place.s + way.feed * p.misalignment.lead_time;
        let place = way.path.advance(way.place, begin);
        let next = way.path.advance(place, begin + way.feed * p.sample_period);
        self.misalignment.velocity(p, &way.path.frame(place), &way.path.frame(next))
    }

    fn law(&self, p: &Parameters) -> Law {
        Law::new(p, self.damping.unwrap_or(p.impedance.damping))
    }
}

/// Where on the path the tool is, and how fast it goes.
#[derive(Clone, Copy, Debug)]
pub struct Way<'a> {
    /// The path.
    pub path: &'a Path,
    /// The place on it.
    pub place: Place,
    /// The path there.
    pub frame: &'a Frame,
    /// Feed of the contact point, m/s.
    pub feed: f64,
}

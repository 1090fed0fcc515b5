//! Measurement of a sample, and the conditions from its counters and means: contact, settled force, lost contact.

use control_blocks::{Consecutive, ticks};
use nalgebra::Vector3;
use serde::{Deserialize, Serialize};

use super::sensor::MeasuredForce;
use crate::interface::{ErrorOutput, Parameters, State};
use crate::path::centre_path::Frame;

/// Time constant of the mean force error, s.
const ERROR_TIME: f64 = 0.02;
/// Time constant of the mean force, s.
const FORCE_TIME: f64 = 0.1;
/// A force has a direction from here on, over the contact force.
const DIRECTION_RATIO: f64 = 2.0;

/// Consecutive samples that confirm a contact or its end: a single spike is not a contact.
const CONTACT_SAMPLES: u32 = 3;
/// Force error of a settled force, as a fraction of the target: the noise of the sensor stays below it.
const TOLERANCE: f64 = 0.15;
/// Time for which a settled force stays within the tolerance, s: five time constants of the mean error.
const HOLD_TIME: f64 = 0.1;
/// A force is gone below this, over the contact force.
const UNLOADED_RATIO: f64 = 0.5;

/// Measurement of one sample: path, force and errors. It precedes all decisions of the sample.
#[derive(Clone, Copy, Debug)]
pub struct Measurement {
    /// The path at the present position.
    pub frame: Frame,
    /// Measured force.
    pub force: MeasuredForce,
    /// Target minus controlled force, N.
    pub force_error: f64,
    /// E_p = x_d - x, m.
    pub offset: Vector3<f64>,
    /// Components of `offset` along tangent, lateral direction and normal, m.
    pub error: ErrorOutput,
    /// Distance of the surface from the path along the normal, m.
    pub surface: f64,
}

/// Counters and means of the present state; by default nothing is known.
#[derive(Clone, Debug, Default, Serialize, Deserialize)]
pub struct ContactMonitor {
    touching: Consecutive,
    settled: Consecutive,
    lost: Consecutive,
    unloaded: Consecutive,
    free: Consecutive,
    error: f64,
    force: Vector3<f64>,
    /// mean size of the force across the normal, N: friction that changes its sign counts
    lateral: f64,
}

impl ContactMonitor {
    /// Takes one sample of `state`; `steady` says whether the target force has arrived at its target.
    pub fn update(&mut self, p: &Parameters, state: State, now: &Measurement, steady: bool) {
        let weight = |time: f64| 1.0 - (-p.sample_period / time).exp();
        self.touching.update(state == State::Approach && now.force.norm > p.approach.contact_force);
        self.error += weight(ERROR_TIME) * (now.force_error - self.error);
        let small = self.error.abs() < TOLERANCE * p.force.target;
        self.settled.update(state == State::Settle && steady && small);
        self.lost.update(state == State::Follow && now.force.controlled < p.limits.lost_force);
        let none = now.force.controlled < UNLOADED_RATIO * p.approach.contact_force;
        self.unloaded.update(state == State::Unload && none);
        self.free.update(state == State::Retract && now.force.controlled.abs() < p.approach.contact_force);
        self.force += (now.force.vector - self.force) * weight(FORCE_TIME);
        let lateral = now.force.vector - now.frame.normal * now.force.normal;
        self.lateral += (lateral.norm() - self.lateral) * weight(FORCE_TIME);
    }

    /// The tool touches.
    pub fn contact(&self) -> bool {
        self.touching.count() >= CONTACT_SAMPLES
    }

    /// The mean force points into the material along the unit normal `normal`.
    pub fn pulls(&self, normal: &Vector3<f64>) -> bool {
        self.force.dot(normal) < 0.0
    }

    /// The force is settled.
    pub fn settled(&self, p: &Parameters) -> bool {
        self.settled.count() >= ticks(HOLD_TIME, p.sample_period).max(1)
    }

    /// The force is gone while the tool is still at the mold.
    pub fn unloaded(&self) -> bool {
        self.unloaded.count() >= CONTACT_SAMPLES
    }

    /// The force is gone and stays away during the retract.
    pub fn free(&self) -> bool {
        self.free.count() >= CONTACT_SAMPLES
    }

    /// The contact is lost.
    pub fn lost(&self, p: &Parameters) -> bool {
        self.lost.count() >= ticks(p.limits.lost_time, p.sample_period).max(1)
    }

    /// The force does not point along the unit normal `normal`, or it is not as large as the friction shows.
    pub fn misdirected(&self, p: &Parameters, normal: &Vector3<f64>) -> bool {
        // without a force there is no direction
        if self.lost.count() > 0 {
            return false;
        }
        self.force.norm() > DIRECTION_RATIO * p.approach.contact_force && self.angle(normal) > p.limits.force_angle
    }

    /// Angle (rad) between the mean force and the unit normal `normal`, friction to either side counted.
    pub fn angle(&self, normal: &Vector3<f64>) -> f64 {
        self.lateral.atan2(self.force.dot(normal))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A second under the force `force` (N) with the normal z.
    fn under(p: &Parameters, force: Vector3<f64>) -> ContactMonitor {
        let (zero, normal) = (Vector3::zeros(), Vector3::z());
        let frame = Frame { centre: zero, contact: zero, normal, tangent: Vector3::x(), ratio: 1.0, feed_max: 1.0 };
        let error = ErrorOutput { tangential: 0.0, lateral: 0.0, normal: 0.0 };
        let force =
            MeasuredForce { vector: force, unfiltered: force, norm: force.norm(), normal: force.z, controlled: 5.0 };
        let now = Measurement { frame, force, force_error: 0.0, offset: zero, error, surface: 0.0 };
        let mut monitor = ContactMonitor::default();
        (0..1000).for_each(|_| monitor.update(p, State::Follow, &now, true));
        monitor
    }

    #[test]
    fn a_force_has_a_direction_from_twice_the_contact_force_on() {
        for contact in [0.3, 0.5, 2.0] {
            let mut p = Parameters::START;
            p.approach.contact_force = contact;
            let tilted = |weight: f64| under(&p, weight * contact * Vector3::x()).misdirected(&p, &Vector3::z());
            assert_eq!([tilted(1.99), tilted(2.01)], [false, true], "{contact}");
            assert!(!under(&p, 9.0 * contact * Vector3::z()).misdirected(&p, &Vector3::z()));
        }
    }

    #[test]
    fn a_force_pulls_where_it_points_into_the_material_and_none_does_not() {
        let pulls = |force: f64| under(&Parameters::START, force * Vector3::z()).pulls(&Vector3::z());
        assert_eq!([-1.0, 0.0, 1.0].map(pulls), [true, false, false]);
    }
}

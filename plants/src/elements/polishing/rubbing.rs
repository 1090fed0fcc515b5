//! Bookkeeping of a contact that rubs: load, friction, and the accumulated polishing work.

use nalgebra::Vector3;

use crate::element::{Element, Ports};

/// Splits the force of a contact at its normal and accumulates the quantities that determine the removal.
///
/// While the contact carries load, `slid` is the slip distance, `rubbed` the integral of load times slip speed
/// (Preston) and `work` the friction work. `speed` is the slip speed, 0 without contact.
#[derive(Clone, Debug, Default)]
pub struct Rubbing {
    /// m
    slid: f64,
    /// N.m
    rubbed: f64,
    /// J
    work: f64,
}

impl Element for Rubbing {
    fn ports(&self) -> Ports {
        Ports {
            inputs: &["fx", "fy", "fz", "normal_x", "normal_y", "normal_z", "vx", "vy", "vz"],
            outputs: &["load", "friction_x", "friction_y", "friction_z", "speed", "slid", "rubbed", "work"],
        }
    }

    fn step(&mut self, inputs: &[f64], outputs: &mut [f64], h: f64) {
        let &[fx, fy, fz, nx, ny, nz, vx, vy, vz] = inputs else { return };
        let normal = Vector3::new(nx, ny, nz);
        let (force, velocity) = (Vector3::new(fx, fy, fz), Vector3::new(vx, vy, vz));
        let load = force.dot(&normal);
        let friction = force - normal * load;
        let slip = velocity - normal * velocity.dot(&normal);
        let speed = if load > 0.0 { slip.norm() } else { 0.0 };
        self.slid += speed * h;
        self.rubbed += load * speed * h;
        self.work -= friction.dot(&slip) * h;
        let sums = [speed, self.slid, self.rubbed, self.work];
        outputs[0] = load;
        outputs[1..4].copy_from_slice(friction.as_slice());
        outputs[4..].copy_from_slice(&sums);
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn load_and_friction_are_the_parts_of_the_force() {
        let mut out = [0.0; 8];
        // 5 N along (0.6, 0, 0.8), 1 N back along x' while it slides 10 mm/s along x'
        let (normal, along) = ([0.6, 0.0, 0.8], [0.8, 0.0, -0.6]);
        let force = [0, 1, 2].map(|i| 5.0 * normal[i] - along[i]);
        let speed = [0, 1, 2].map(|i| 0.01 * along[i] + 0.3 * normal[i]);
        let inputs = [force, normal, speed].concat();
        let mut rubbing = Rubbing::default();
        for _ in 0..1000 {
            rubbing.step(&inputs, &mut out, 1e-4);
        }
        for (i, wanted) in [5.0, -0.8, 0.0, 0.6, 0.01, 1e-3, 5e-3, 1e-3].into_iter().enumerate() {
            assert!((out[i] - wanted).abs() < 1e-12, "{i}: {} instead of {wanted}", out[i]);
        }
    }

    #[test]
    fn nothing_adds_up_without_load() {
        let (mut rubbing, mut out) = (Rubbing::default(), [9.0; 8]);
        rubbing.step(&[0.0, 0.0, 0.0, 0.0, 0.0, 1.0, 0.1, 0.0, 0.0], &mut out, 1e-4);
        assert_eq!(out, [0.0; 8]);
    }
}

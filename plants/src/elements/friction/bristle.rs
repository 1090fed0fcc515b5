//! Elasto-plastic friction of a part that slides and turns on a table (Dupont, Armstrong and Hayward 2000).

use std::f64::consts::PI;

use nalgebra::Vector3;

use super::stribeck::Stribeck;
use crate::element::{Element, Ports};

/// Friction force and torque on the part, in the frame of the table, from its velocity against the table.
///
/// One bristle with the deflection `z = (x, y, radius yaw)`: purely elastic, without drift, below the break-away
/// deflection; plastic at the steady-state deflection `load mu(|v|) / stiffness`; a smooth mixture between the two.
#[derive(Clone, Debug)]
pub struct Bristle {
    /// normal force, N
    load: f64,
    law: Stribeck,
    /// radius at which the torque acts, m
    radius: f64,
    /// N/m
    stiffness: f64,
    /// N.s/m, on the rate of the deflection
    damping: f64,
    /// break-away deflection over steady-state deflection
    break_away: f64,
    /// deflection, m
    z: Vector3<f64>,
}

impl Bristle {
    /// A bristle under a normal force `load` N with a friction law; the torque acts at `radius` m.
    pub fn new(load: f64, law: Stribeck, radius: f64, stiffness: f64, damping: f64, break_away: f64) -> Self {
        Self { load, law, radius, stiffness, damping, break_away, z: Vector3::zeros() }
    }

    /// fraction of the motion that is plastic, for a deflection and a velocity
    fn plastic(&self, z: Vector3<f64>, v: Vector3<f64>, steady: f64) -> f64 {
        let (length, elastic) = (z.norm(), self.break_away * steady);
        if length <= elastic || z.dot(&v) <= 0.0 {
            0.0
        } else if length >= steady {
            1.0
        } else {
            0.5 + 0.5 * (PI * (length - 0.5 * (steady + elastic)) / (steady - elastic)).sin()
        }
    }
}

impl Element for Bristle {
    fn ports(&self) -> Ports {
        Ports { inputs: &["vx", "vy", "yaw_rate"], outputs: &["fx", "fy", "torque"] }
    }

    fn step(&mut self, inputs: &[f64], outputs: &mut [f64], h: f64) {
        let v = Vector3::new(inputs[0], inputs[1], self.radius * inputs[2]);
        let speed = v.norm();
        let steady = self.load * self.law.coefficient(speed) / self.stiffness;
        // z' = v - plastic |v| z / steady, implicit in z
        let trial = self.z + v * h;
        let decay = 1.0 + h * self.plastic(trial, v, steady) * speed / steady;
        let next = trial / decay;
        let rate = if h > 0.0 { (next - self.z) / h } else { Vector3::zeros() };
        self.z = next;
        let force = next * -self.stiffness - rate * self.damping;
        outputs.copy_from_slice(&[force[0], force[1], self.radius * force[2]]);
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const LAW: Stribeck = Stribeck { at_rest: 0.25, kinetic: 0.2, speed: 1e-3 };

    /// 10 N on feet at 50 mm, 1 um to slide at rest
    fn bristle() -> Bristle {
        Bristle::new(10.0, LAW, 0.05, 2.5e6, 100.0, 0.7)
    }

    /// force after a motion at constant velocity
    fn slide(bristle: &mut Bristle, velocity: [f64; 3], h: f64, steps: usize) -> [f64; 3] {
        let mut out = [0.0; 3];
        for _ in 0..steps {
            bristle.step(&velocity, &mut out, h);
        }
        out
    }

    #[test]
    fn below_break_away_it_is_a_spring() {
        // 0.5 um out, and back
        let mut bristle = bristle();
        let out = slide(&mut bristle, [1e-5, 0.0, 0.0], 1e-4, 500);
        assert!((out[0] + 2.5e6 * 0.5e-6 + 100.0 * 1e-5).abs() < 1e-9, "{out:?}");
        slide(&mut bristle, [-1e-5, 0.0, 0.0], 1e-4, 500);
        assert!(bristle.z.norm() < 1e-18);
    }

    #[test]
    fn sliding_force_is_that_of_the_law_against_the_velocity() {
        for (velocity, h) in [([3e-3, 4e-3, 0.0], 1e-4), ([0.06, -0.08, 0.0], 1e-4), ([3e-4, 4e-4, 0.0], 2e-5)] {
            let out = slide(&mut bristle(), velocity, h, 20_000);
            let speed = Vector3::from(velocity).norm();
            let load = 10.0 * LAW.coefficient(speed);
            for i in 0..2 {
                assert!((out[i] + load * velocity[i] / speed).abs() < 1e-6 * load, "{velocity:?}: {out:?}");
            }
        }
    }

    #[test]
    fn turning_alone_is_held_by_load_times_mu_times_radius() {
        let out = slide(&mut bristle(), [0.0, 0.0, -2.0], 1e-4, 1000);
        assert!((out[2] - 10.0 * 0.2 * 0.05).abs() < 1e-9, "{out:?}");
        assert_eq!(out[0], 0.0);
    }

    #[test]
    fn a_load_below_break_away_does_not_drift() {
        // 60 % of the static force swings a thousand times with the velocity that such a force would cause
        let mut bristle = bristle();
        let (amplitude, mut out) = (0.6e-6, [0.0; 3]);
        for k in 0..100_000 {
            let phase = |k: i32| (std::f64::consts::TAU * f64::from(k) / 100.0).sin();
            bristle.step(&[amplitude * (phase(k + 1) - phase(k)) / 1e-4, 0.0, 0.0], &mut out, 1e-4);
        }
        assert!(bristle.z.norm() < 1e-15, "{:?}", bristle.z);
    }

    #[test]
    fn a_step_of_no_time() {
        let mut bristle = bristle();
        assert_eq!(slide(&mut bristle, [0.1, 0.0, 0.0], 0.0, 1), [0.0; 3]);
    }
}

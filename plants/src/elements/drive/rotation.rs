//! Angle of a shaft that turns at a given speed.

use std::f64::consts::TAU;

use crate::element::{Element, Ports};

/// `angle` at the start of the step and `angle_next` at its end, rad in `[0, 2 pi)`, from `speed` in rad/s.
#[derive(Clone, Debug)]
pub struct Rotation {
    /// present angle of the shaft, rad
    pub angle: f64,
}

impl Element for Rotation {
    fn ports(&self) -> Ports {
        Ports { inputs: &["speed"], outputs: &["angle", "angle_next"] }
    }

    fn step(&mut self, inputs: &[f64], outputs: &mut [f64], h: f64) {
        outputs[0] = self.angle;
        self.angle = (self.angle + inputs[0] * h).rem_euclid(TAU);
        outputs[1] = self.angle;
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn turns_and_wraps() {
        let mut rotation = Rotation { angle: 1.0 };
        let mut out = [0.0; 2];
        // 10 turns and a quarter
        for _ in 0..41 {
            rotation.step(&[TAU / 4.0], &mut out, 1.0);
        }
        assert!((out[0] - 1.0).abs() < 1e-12);
        assert!((out[1] - 1.0 - TAU / 4.0).abs() < 1e-12);
    }

    #[test]
    fn a_step_of_zero_shows_the_start() {
        let mut rotation = Rotation { angle: 1.0 };
        let mut out = [0.0; 2];
        rotation.step(&[300.0], &mut out, 0.0);
        assert_eq!(out, [1.0, 1.0]);
    }
}

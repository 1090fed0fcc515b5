//! The direction of the path, seen along z: how far it has turned, and when it has gone round once.

use control_blocks::Unwrapper;
use nalgebra::Vector3;
use serde::{Deserialize, Serialize};

/// The direction in one sample.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Rotation {
    /// Angle of the tangent, rad.
    pub angle: f64,
    /// By how much it has turned since the last sample, rad.
    pub step: f64,
}

/// Follows the direction; by default before the first sample.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct Turning {
    angle: Unwrapper,
}

impl Turning {
    /// Takes the direction `tangent` of a sample.
    pub fn step(&mut self, tangent: &Vector3<f64>) -> Rotation {
        let step = self.angle.step(tangent.y.atan2(tangent.x)).unwrap_or(0.0);
        Rotation { angle: self.angle.reading().unwrap_or(0.0), step }
    }
}

/// Counts the samples of a whole revolution, in both directions; at its start by default.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct WholeRevolution {
    /// rad
    total: f64,
    samples: u32,
}

impl WholeRevolution {
    /// Adds the rotation `step` (rad) of a sample; returns the samples of the revolution that it ends.
    pub fn ends(&mut self, step: f64) -> Option<u32> {
        self.samples += 1;
        self.total += step.abs();
        if self.total < std::f64::consts::TAU {
            return None;
        }
        Some(std::mem::take(self).samples)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_revolution_is_the_sum_of_its_steps_in_either_direction() {
        for rate in [0.01, -0.01] {
            let (mut turning, mut whole, mut ends) = (Turning::default(), WholeRevolution::default(), Vec::new());
            for k in 0..1300 {
                let angle = 3.0 + rate * f64::from(k);
                let rotation = turning.step(&Vector3::new(angle.cos(), angle.sin(), 0.4));
                let step = if k == 0 { 0.0 } else { rate };
                assert!(
                    (rotation.angle - angle).sin().abs() < 1e-9 && (rotation.step - step).abs() < 1e-9,
                    "{k}: {rotation:?}"
                );
                ends.extend(whole.ends(rotation.step));
            }
            // the first sample has no step
            assert_eq!(ends, [630, 629]);
        }
    }
}

//! A part that lies elsewhere on its table: moved and turned about the vertical.

use nalgebra::Vector2;
use serde::{Deserialize, Serialize};

use crate::path::geometry::{Pose, Vector};

/// p' = c + s + R (p - c), R a reversal about the vertical.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct Displacement {
    /// Shift s of the center, m.
    pub shift: Vector2<f64>,
    /// Turn about the vertical, rad.
    pub angle: f64,
    /// Center c of the rotation, m.
    pub centre: Vector2<f64>,
}

impl Displacement {
    /// Displaced pose of a programmed one.
    pub fn of(&self, pose: &Pose) -> Pose {
        if *self == Self::default() {
            return *pose;
        }
        let rotate = |v: Vector2<f64>| rotated(self.angle, v);
        let (tip, axis) = (self.centre + self.shift + rotate(pose.tip.xy() - self.centre), rotate(pose.axis.xy()));
        Pose { tip: Vector::new(tip.x, tip.y, pose.tip.z), axis: Vector::new(axis.x, axis.y, pose.axis.z) }
    }

    /// Where a position was before the part was displaced.
    pub fn back(&self, point: Vector2<f64>) -> Vector2<f64> {
        self.centre + rotated(-self.angle, point - self.centre - self.shift)
    }
}

/// A vector turned about the vertical.
pub fn rotated(angle: f64, v: Vector2<f64>) -> Vector2<f64> {
    let (sin, cos) = angle.sin_cos();
    Vector2::new(cos * v.x - sin * v.y, sin * v.x + cos * v.y)
}

#[cfg(test)]
mod tests {
    use super::*;

    const POSE: Pose = Pose { tip: Vector::new(0.7, 0.1, -0.2), axis: Vector::new(0.6, 0.0, -0.8) };

    #[test]
    fn a_part_that_is_as_programmed_is_the_same_to_the_bit() {
        assert_eq!(Displacement::default().of(&POSE), POSE);
    }

    #[test]
    fn a_quarter_revolution_about_a_center_is_known_and_is_inverted() {
        let (shift, centre) = (Vector2::new(1e-3, -2e-3), Vector2::new(0.7, 0.0));
        let quarter = Displacement { shift, centre, angle: std::f64::consts::FRAC_PI_2 };
        let moved = quarter.of(&POSE);
        assert!((moved.tip - Vector::new(0.601, -2e-3, -0.2)).norm() < 1e-15, "{moved:?}");
        assert!((moved.axis - Vector::new(0.0, 0.6, -0.8)).norm() < 1e-15, "{moved:?}");
        assert!((quarter.back(moved.tip.xy()) - POSE.tip.xy()).norm() < 1e-15);
    }
}

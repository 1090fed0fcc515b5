//! A position where the part is touched.

use nalgebra::Vector2;
use serde::{Deserialize, Serialize};

use crate::path::geometry::{Pose, Vector};

/// A flat place of the part, as programmed.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct Touch {
    /// Tip that touches there, and its direction.
    pub pose: Pose,
    /// Unit vector out of the part, level.
    pub normal: Vector,
    /// Way along the normal from which the tip comes, and to which it continues inside, m.
    pub approach: f64,
}

impl Touch {
    /// Pose at a distance (m) from the start of the approach towards the part; the programmed position is in the middle.
    pub fn at(&self, distance: f64) -> Pose {
        Pose { tip: self.pose.tip + self.normal * (self.approach - distance), ..self.pose }
    }

    /// Way (m) at which a tip is.
    pub fn distance(&self, tip: &Vector) -> f64 {
        self.approach - (tip - self.pose.tip).dot(&self.normal)
    }

    /// Position and normal from above.
    pub fn level(&self) -> (Vector2<f64>, Vector2<f64>) {
        (self.pose.tip.xy(), self.normal.xy())
    }
}

#[cfg(test)]
pub mod tests {
    use super::*;

    /// A touch of an upright tip, from 5 mm.
    pub fn touch(x: f64, y: f64, angle: f64) -> Touch {
        let pose = Pose { tip: Vector::new(x, y, -0.185), axis: Vector::new(0.0, 0.0, -1.0) };
        Touch { pose, normal: Vector::new(angle.cos(), angle.sin(), 0.0), approach: 5e-3 }
    }

    #[test]
    fn the_approach_goes_from_outside_through_the_programmed_position() {
        let touch = touch(0.7, 0.1, 0.3);
        for (distance, out) in [(0.0, 5e-3), (5e-3, 0.0), (9e-3, -4e-3)] {
            let pose = touch.at(distance);
            assert!((pose.tip - touch.pose.tip - touch.normal * out).norm() < 1e-15 && pose.axis == touch.pose.axis);
            // across the normal the distance is the same
            let aside = pose.tip + Vector::new(-touch.normal.y, touch.normal.x, 1.0);
            assert!((touch.distance(&aside) - distance).abs() < 1e-12);
        }
    }
}

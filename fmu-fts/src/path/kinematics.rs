//! The arm: encoder angle against depth and distance of the tool nose, exact in both directions.
//!
//! phi = b_0 + b is the angle of the arm out of the plane through its axis; z = R_a sin phi is the depth of the nose
//! center, rho = (x_0 - x) - R_a cos phi its distance from the spindle axis.

use serde::{Deserialize, Serialize};

use crate::interface::{Parameters, Tool};

/// Largest sine of phi: the arm is never parallel to the spindle.
const SINE_MAX: f64 = 0.999;
/// Largest sine of phi on a path.
const REACH: f64 = 0.99;

impl Tool {
    /// Place of the selected tool in the arrays.
    pub fn index(&self) -> usize {
        (self.selected - 1) as usize
    }
}

/// The arm with the selected tool.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct Arm {
    /// Length R_a, m.
    pub length: f64,
    /// Angle b_0 at the encoder index, rad.
    pub zero: f64,
    /// Cross-slide offset x_0, m.
    pub center_offset: f64,
}

impl Arm {
    /// The arm as the selected tool's calibration record has it.
    pub fn new(p: &Parameters) -> Self {
        let (tool, i) = (&p.tool, p.tool.index());
        Self { length: tool.arm_length[i], zero: tool.arm_zero[i], center_offset: tool.center_offset[i] }
    }

    /// Encoder angle b (rad) for a depth z (m); depths out of reach give the last angle in reach.
    pub fn angle(&self, depth: f64) -> f64 {
        (depth / self.length).clamp(-SINE_MAX, SINE_MAX).asin() - self.zero
    }

    /// Whether a path may have a depth z (m).
    pub fn reaches(&self, depth: f64) -> bool {
        depth.abs() <= REACH * self.length
    }

    /// Depth z (m) for an encoder angle b (rad).
    pub fn depth(&self, angle: f64) -> f64 {
        self.length * (self.zero + angle).sin()
    }

    /// Lever R_a cos phi = dz/db (m) at an encoder angle b (rad).
    pub fn lever(&self, angle: f64) -> f64 {
        self.length * (self.zero + angle).cos()
    }

    /// Tangent of phi at a depth z (m): by how much the nose moves sideways for a depth.
    pub fn angle_tangent(&self, depth: f64) -> f64 {
        let sine = (depth / self.length).clamp(-SINE_MAX, SINE_MAX);
        sine / (1.0 - sine * sine).sqrt()
    }

    /// Distance rho (m) of the nose center from the spindle axis at a slide position (m) and a depth (m).
    pub fn distance(&self, slide_position: f64, depth: f64) -> f64 {
        let sine = (depth / self.length).clamp(-SINE_MAX, SINE_MAX);
        self.center_offset - slide_position - self.length * (1.0 - sine * sine).sqrt()
    }

    /// Slide position (m) that brings the nose center to a distance (m) from the spindle axis at a depth (m).
    pub fn slide_position(&self, distance: f64, depth: f64) -> f64 {
        self.distance(distance, depth)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn angle_and_depth_are_inverse() {
        let arm = Arm::new(&Parameters::START);
        for k in -79..=79 {
            let z = 1e-3 * f64::from(k);
            assert!((arm.depth(arm.angle(z)) - z).abs() < 1e-15);
        }
    }

    #[test]
    fn the_lever_is_the_slope_of_the_depth() {
        let arm = Arm::new(&Parameters::START);
        let slope = (arm.depth(0.3 + 1e-6) - arm.depth(0.3 - 1e-6)) / 2e-6;
        assert!((arm.lever(0.3) - slope).abs() < 1e-10);
    }

    #[test]
    fn a_stroke_of_15_mm_moves_the_nose_sideways_by_1_42_mm() {
        let arm = Arm::new(&Parameters::START);
        let shift = arm.distance(0.04, 15e-3) - arm.distance(0.04, 0.0);
        assert!((shift - 1.42e-3).abs() < 1e-5, "{shift}");
        assert!((arm.distance(arm.slide_position(0.03, 2e-3), 2e-3) - 0.03).abs() < 1e-15);
    }

    #[test]
    fn depths_out_of_reach_stay_finite() {
        let arm = Arm::new(&Parameters::START);
        assert!(arm.angle(1.0) < 1.5 && arm.angle(-1.0) > -1.7);
        assert!(arm.distance(0.04, 1.0).is_finite());
    }

    #[test]
    fn each_tool_has_its_own_record() {
        let mut p = Parameters::START;
        p.tool.selected = 2;
        p.tool.arm_length[1] = 0.0801;
        let arm = Arm::new(&p);
        assert_eq!(arm.length, 0.0801);
        assert!((arm.angle(0.0) - (std::f64::consts::PI - 0.0523)).abs() < 1e-15);
    }
}

//! Inverse kinematics of the cylindrical robot: tip and tool direction to six axes, on the branch of the last sample.

use std::f64::consts::{PI, TAU};

use crate::interface::Arm;
use crate::path::geometry::{Pose, Vector};

/// Number of axes.
pub const AXES: usize = 6;
/// One number for each axis: column (rad), height (m), arm (m), yaw, pitch, roll (rad).
pub type Joints = [f64; AXES];

/// Sine of the tilt below which the tool is upright and the yaw is free.
const UPRIGHT: f64 = 1e-6;

impl Arm {
    /// Axes that bring the tip there, near those of the sample before; none on the column's axis.
    pub fn inverse(&self, pose: &Pose, before: &Joints) -> Option<Joints> {
        let wrist = pose.tip - pose.axis * self.tool_offset;
        let radius = wrist.x.hypot(wrist.y);
        if radius == 0.0 {
            return None;
        }
        let column = near(wrist.y.atan2(wrist.x), before[0], TAU);
        let (sin, cos) = column.sin_cos();
        let radial = cos * pose.axis.x + sin * pose.axis.y;
        let tangential = cos * pose.axis.y - sin * pose.axis.x;
        let [yaw, pitch] = wrist_angles(radial, tangential, pose.axis.z, before[3]);
        Some([column, wrist.z - self.height, radius - self.reach, yaw, pitch, 0.0])
    }

    /// Pose to which the axes bring the tool; roll changes nothing.
    pub fn forward(&self, joints: &Joints) -> Pose {
        let [column, height, reach, yaw, pitch, _] = *joints;
        let (tilt, azimuth) = (-pitch, column + yaw);
        let axis = Vector::new(tilt.sin() * azimuth.cos(), tilt.sin() * azimuth.sin(), -tilt.cos());
        let radius = reach + self.reach;
        let wrist = Vector::new(radius * column.cos(), radius * column.sin(), height + self.height);
        Pose { tip: wrist + axis * self.tool_offset, axis }
    }

    /// Axes that hold the tool `distance` (m) farther back along itself; where they are when it cannot go there.
    pub fn retracted(&self, joints: &Joints, distance: f64) -> Joints {
        let Pose { tip, axis } = self.forward(joints);
        self.inverse(&Pose { tip: tip - axis * distance, axis }, joints).unwrap_or(*joints)
    }

    /// How far the tip moves for a unit motion of each axis, at most: m/rad or 1.
    pub fn levers(&self, joints: &Joints) -> Joints {
        let tool = self.tool_offset;
        [joints[2] + self.reach, 1.0, 1.0, tool, tool, 0.0]
    }
}

/// Yaw and pitch for a tool direction in the arm's frame.
///
/// Two solutions of the wrist have the same tool direction: (yaw, pitch) and (yaw + pi, -pitch). Taken is the one whose yaw
/// is nearer to that before, so that a tool that oscillates through the vertical does not turn the wrist by half a reversal.
fn wrist_angles(radial: f64, tangential: f64, vertical: f64, before: f64) -> [f64; 2] {
    let tilt = radial.hypot(tangential);
    if tilt < UPRIGHT {
        return [before, 0.0];
    }
    let azimuth = tangential.atan2(radial);
    let yaw = near(azimuth, before, PI);
    let flipped = ((yaw - azimuth) / PI).round().rem_euclid(2.0) == 1.0;
    let sign = if flipped { 1.0 } else { -1.0 };
    [yaw, sign * tilt.atan2(-vertical)]
}

/// The angle nearest to `before` among those that differ from `angle` by whole periods.
fn near(angle: f64, before: f64, period: f64) -> f64 {
    angle + period * ((before - angle) / period).round()
}

#[cfg(test)]
mod tests {
    use super::*;

    const ARM: Arm = Arm { height: 0.9, reach: 0.1, tool_offset: 0.2 };

    #[test]
    fn forward_and_back_from_all_over_the_room() {
        for k in 0..1000 {
            let f = |step: f64| (f64::from(k) * step).fract();
            let joints =
                [8.0 * f(0.618) - 4.0, f(0.37) - 0.5, 0.2 + f(0.71), 8.0 * f(0.29) - 4.0, 3.0 * f(0.83) - 1.5, 0.0];
            if joints[4].abs() < 1e-3 {
                continue;
            }
            let back = ARM.inverse(&ARM.forward(&joints), &joints).unwrap();
            for (a, b) in joints.iter().zip(&back) {
                assert!((a - b).abs() < 1e-9, "{joints:?} {back:?}");
            }
        }
    }

    #[test]
    fn a_tool_is_retracted_along_itself() {
        let joints = [0.7, 0.1, 0.5, 0.4, -0.3, 0.0];
        let (before, after) = (ARM.forward(&joints), ARM.forward(&ARM.retracted(&joints, 0.02)));
        assert!(
            (after.tip - (before.tip - before.axis * 0.02)).norm() < 1e-12 && (after.axis - before.axis).norm() < 1e-12
        );
    }

    #[test]
    fn the_tip_moves_by_the_lever_of_each_axis() {
        let joints = [0.4, 0.1, 0.6, 0.0, 0.0, 0.0];
        let levers = ARM.levers(&joints);
        assert_eq!((levers[0], levers[5]), (0.7, 0.0));
        for i in 0..3 {
            let mut moved = joints;
            moved[i] += 1e-6;
            let distance = (ARM.forward(&moved).tip - ARM.forward(&joints).tip).norm();
            assert!((distance - 1e-6 * levers[i]).abs() < 1e-11, "axis {}: {distance}", i + 1);
        }
    }

    #[test]
    fn many_revolutions_stay_continuous() {
        let mut joints = [0.0, 0.0, 0.5, 0.0, -0.3, 0.0];
        for k in 0..2000 {
            let target = [0.01 * f64::from(k), 0.0, 0.5, -0.02 * f64::from(k), -0.3, 0.0];
            joints = ARM.inverse(&ARM.forward(&target), &joints).unwrap();
            assert!((joints[0] - target[0]).abs() < 1e-9 && (joints[3] - target[3]).abs() < 1e-9);
        }
    }

    #[test]
    fn a_tool_that_passes_through_the_vertical_keeps_its_yaw() {
        let mut joints = [0.3, 0.0, 0.5, 0.7, -0.2, 0.0];
        for k in 0..=400 {
            let target = [0.3, 0.0, 0.5, 0.7, -0.2 + 0.001 * f64::from(k), 0.0];
            joints = ARM.inverse(&ARM.forward(&target), &joints).unwrap();
            assert!((joints[3] - 0.7).abs() < 1e-9, "{joints:?}");
            assert!((joints[4] - target[4]).abs() < 1e-9, "{joints:?}");
        }
    }

    #[test]
    fn on_the_column_there_is_no_angle() {
        let pose = Pose { tip: Vector::new(0.0, 0.0, 0.5), axis: Vector::new(0.0, 0.0, -1.0) };
        assert_eq!(ARM.inverse(&pose, &[0.0; AXES]), None);
    }
}

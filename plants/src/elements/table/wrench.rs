//! Force in the world frame on a part that rests on a turning table, as forces on the joints of both.

use crate::element::{Element, Ports};

/// Joint forces of `fx`, `fy` at the point `(place, 0)` of the world frame.
///
/// `x`, `y` and `torque` act on the part in the frame of the table, about its center `(cx, cy)`; `table` is the
/// torque on the table, which carries the part.
#[derive(Clone, Copy, Debug)]
pub struct Wrench;

impl Element for Wrench {
    fn ports(&self) -> Ports {
        Ports { inputs: &["fx", "fy", "place", "cx", "cy", "angle"], outputs: &["table", "x", "y", "torque"] }
    }

    fn step(&mut self, inputs: &[f64], outputs: &mut [f64], _h: f64) {
        let [fx, fy, place, cx, cy, angle] = [inputs[0], inputs[1], inputs[2], inputs[3], inputs[4], inputs[5]];
        let (sin, cos) = angle.sin_cos();
        let torque = (place - cx) * fy + cy * fx;
        outputs.copy_from_slice(&[place * fy, cos * fx + sin * fy, cos * fy - sin * fx, torque]);
    }
}

#[cfg(test)]
mod tests {
    use super::super::turntable::Turntable;
    use super::*;

    #[test]
    fn joint_forces_do_the_work_of_the_force() {
        // virtual work: the power of the force is that of the joint forces for any motion of the joints
        let (angle, x, y, place) = (0.7, 3e-3, -2e-3, 0.051);
        let (fx, fy) = (-2.0, 0.4);
        let (rate, vx, vy, yaw_rate) = (2.0, 0.01, -0.03, 0.5);
        let mut pose = [0.0; 8];
        Turntable.step(&[angle, rate, x, y, 0.2, vx, vy, yaw_rate, 0.0, 0.0], &mut pose, 1e-4);
        let [cx, cy, vcx, vcy, _, turn_rate, ..] = pose;
        let mut out = [0.0; 4];
        Wrench.step(&[fx, fy, place, cx, cy, angle], &mut out, 1e-4);
        let (px, py) = (vcx + turn_rate * cy, vcy + turn_rate * (place - cx));
        let power = fx * px + fy * py;
        let joints = out[0] * rate + out[1] * vx + out[2] * vy + out[3] * yaw_rate;
        assert!((power - joints).abs() < 1e-15, "{power} and {joints} W");
    }
}

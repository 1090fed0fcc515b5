//! A part that rests on a turning table, in the world frame.

use crate::element::{Element, Ports};

/// Position and velocity of the center of the part in the world frame, from its position `x`, `y`, `yaw` on the table.
///
/// The axis of the table is displaced by `error_x`, `error_y` (error motion of the spindle), without its velocity.
#[derive(Clone, Copy, Debug)]
pub struct Turntable;

impl Element for Turntable {
    fn ports(&self) -> Ports {
        Ports {
            inputs: &["angle", "rate", "x", "y", "yaw", "vx", "vy", "yaw_rate", "error_x", "error_y"],
            outputs: &["cx", "cy", "vcx", "vcy", "orientation", "turn_rate", "eccentricity", "slip_speed"],
        }
    }

    fn step(&mut self, inputs: &[f64], outputs: &mut [f64], _h: f64) {
        let [angle, rate, x, y, yaw] = [inputs[0], inputs[1], inputs[2], inputs[3], inputs[4]];
        let [vx, vy, yaw_rate, error_x, error_y] = [inputs[5], inputs[6], inputs[7], inputs[8], inputs[9]];
        let (sin, cos) = angle.sin_cos();
        let turn = |x: f64, y: f64| (cos * x - sin * y, sin * x + cos * y);
        let (cx, cy) = turn(x, y);
        let (vcx, vcy) = turn(vx - rate * y, vy + rate * x);
        let place = [cx + error_x, cy + error_y, vcx, vcy, angle + yaw, rate + yaw_rate];
        outputs[..6].copy_from_slice(&place);
        outputs[6..].copy_from_slice(&[x.hypot(y), vx.hypot(vy)]);
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::f64::consts::FRAC_PI_2;

    fn seen(inputs: [f64; 10]) -> [f64; 8] {
        let mut out = [0.0; 8];
        Turntable.step(&inputs, &mut out, 1e-4);
        out
    }

    #[test]
    fn a_quarter_turn_takes_x_to_y() {
        let out = seen([FRAC_PI_2, 2.0, 3e-3, 4e-3, 0.1, 0.0, 0.0, 0.5, 1e-6, -2e-6]);
        let wanted = [-4e-3 + 1e-6, 3e-3 - 2e-6, -6e-3, -8e-3, FRAC_PI_2 + 0.1, 2.5, 5e-3, 0.0];
        for (value, wanted) in out.iter().zip(wanted) {
            assert!((value - wanted).abs() < 1e-15, "{out:?}");
        }
    }

    #[test]
    fn velocity_is_the_derivative_of_the_place() {
        let at =
            |t: f64| seen([0.3 + 2.0 * t, 2.0, 1e-3 + 0.05 * t, -2e-3 - 0.02 * t, 0.0, 0.05, -0.02, 0.0, 0.0, 0.0]);
        let (before, now, after) = (at(-1e-4), at(0.0), at(1e-4));
        for i in 0..2 {
            assert!((now[2 + i] - (after[i] - before[i]) / 2e-4).abs() < 1e-8, "axis {i}");
        }
    }
}

//! Position loop in encoder pulses: v = Kp q (e + c).

use crate::kinematics::{AXES, Joints};
use crate::parameters::Parameters;

/// Whole pulses of each axis for positions (rad or m).
pub fn pulses(p: &Parameters, positions: &Joints) -> Joints {
    let axes = p.axes();
    std::array::from_fn(|i| (positions[i] / axes[i].pulse).round())
}

/// Velocity commands (rad/s or m/s) for an error and a compensation in pulses, within the limits.
pub fn command(p: &Parameters, error: &Joints, compensation: &Joints) -> Joints {
    let axes = p.axes();
    std::array::from_fn(|i| {
        let velocity = p.servo.gain[i] * axes[i].pulse * (error[i] + compensation[i]);
        velocity.clamp(-axes[i].velocity_max, axes[i].velocity_max)
    })
}

/// First axis whose error is a fault, from 0.
pub fn strayed(p: &Parameters, error: &Joints) -> Option<usize> {
    let axes = p.axes();
    (0..AXES).find(|&i| error[i].abs() * axes[i].pulse > axes[i].error_max)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_velocity_is_the_gain_times_error_and_compensation() {
        let p = Parameters::DEFAULT;
        let v = command(&p, &[100.0, 0.0, 1000.0, 0.0, 0.0, -3.0], &[0.0, 0.0, 200.0, 0.0, 0.0, 1.0]);
        assert!((v[0] - 13.0 * 100.0 * p.axis1.pulse).abs() < 1e-15);
        assert!((v[2] - 13.0 * 1200.0 * 5e-6).abs() < 1e-15);
        assert!((v[5] + 13.0 * 2.0 * p.axis6.pulse).abs() < 1e-15);
        let fast = command(&p, &[1e9; AXES], &[0.0; AXES]);
        assert_eq!(fast, p.axes().map(|axis| axis.velocity_max));
    }

    #[test]
    fn an_error_beyond_its_limit_names_the_axis() {
        let p = Parameters::DEFAULT;
        let mut error = [0.0; AXES];
        assert_eq!(strayed(&p, &error), None);
        error[4] = -0.51 / p.axis5.pulse;
        assert_eq!(strayed(&p, &error), Some(4));
    }
}

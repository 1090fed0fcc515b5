//! Position loop in encoder pulses: v = Kp q (e + c).

use crate::interface::Parameters;
use crate::path::kinematics::Joints;

impl Parameters {
    /// Encoder pulse of each axis, rad or m.
    pub fn pulses(&self) -> Joints {
        self.axis.map(|axis| axis.pulse)
    }
}

/// Whole pulses of each axis for positions (rad or m).
pub fn pulses(p: &Parameters, positions: &Joints) -> Joints {
    std::array::from_fn(|i| (positions[i] / p.axis[i].pulse).round())
}

/// Velocity commands (rad/s or m/s) for an error and a compensation in pulses, within the limits.
pub fn command(p: &Parameters, error: &Joints, compensation: &Joints) -> Joints {
    std::array::from_fn(|i| {
        let velocity = p.servo_gain[i] * p.axis[i].pulse * (error[i] + compensation[i]);
        velocity.clamp(-p.axis[i].velocity_max, p.axis[i].velocity_max)
    })
}

/// Whether no axis moves between two measurements (rad or m): a thousandth of its largest velocity, and one pulse of noise.
pub fn at_rest(p: &Parameters, now: &Joints, before: &Joints) -> bool {
    now.iter()
        .zip(before)
        .zip(&p.axis)
        .all(|((now, before), axis)| (now - before).abs() <= 1e-3 * axis.velocity_max * p.sample_period + axis.pulse)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::path::kinematics::AXES;

    #[test]
    fn the_velocity_is_the_gain_times_error_and_compensation() {
        let mut p = Parameters::START;
        let v = command(&p, &[100.0, 0.0, 1000.0, 0.0, 0.0, -3.0], &[0.0, 0.0, 200.0, 0.0, 0.0, 1.0]);
        assert!((v[0] - 13.0 * 100.0 * p.axis[0].pulse).abs() < 1e-15);
        assert!((v[2] - 13.0 * 1200.0 * 5e-6).abs() < 1e-15);
        assert!((v[5] + 13.0 * 2.0 * p.axis[5].pulse).abs() < 1e-15);
        p.servo_gain = [13.0, 14.0, 15.0, 16.0, 17.0, 18.0];
        for (i, v) in command(&p, &[10.0; AXES], &[0.0; AXES]).into_iter().enumerate() {
            assert!((v - (13.0 + i as f64) * 10.0 * p.axis[i].pulse).abs() < 1e-12);
        }
        let fast = command(&p, &[1e9; AXES], &[0.0; AXES]);
        assert_eq!(fast, p.axis.map(|axis| axis.velocity_max));
    }

    #[test]
    fn each_axis_rests_up_to_a_thousandth_of_its_speed_and_a_pulse() {
        let mut p = Parameters::START;
        p.axis.iter_mut().enumerate().for_each(|(i, axis)| axis.velocity_max *= 1.0 + i as f64);
        for (i, axis) in p.axis.iter().enumerate() {
            let maximum = 1e-3 * axis.velocity_max * p.sample_period + axis.pulse;
            for sign in [1.0, -1.0] {
                let moved = |distance: f64| std::array::from_fn(|k| if k == i { 0.3 + sign * distance } else { 0.3 });
                assert!(at_rest(&p, &moved(0.99 * maximum), &[0.3; AXES]), "{i}");
                assert!(!at_rest(&p, &moved(1.01 * maximum), &[0.3; AXES]), "{i}");
            }
        }
    }

    #[test]
    fn a_pulse_of_noise_is_rest_and_a_slow_motion_is_not() {
        let p = Parameters::START;
        let mut now = [0.3; AXES];
        assert!(at_rest(&p, &now, &now.map(|position| position + 1e-6)));
        // 2 mm/s
        now[2] += 2e-5;
        assert!(!at_rest(&p, &now, &[0.3; AXES]));
    }
}

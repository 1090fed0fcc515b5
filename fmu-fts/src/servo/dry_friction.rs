//! Dry friction, configured and fed forward: its torque reverses with the reference motion, without the delay of feedback.

use control_blocks::Trajectory;

use crate::interface::Parameters;

/// Below this speed the torque goes through zero with a slope, rad/s; so that a held arm is left in peace.
const FRICTION_SPEED: f64 = 0.02;

/// Torque (N.m) for a reference motion of the hub, ahead by the delays of encoder and drive.
pub fn dry_friction(p: &Parameters, motion: Trajectory) -> f64 {
    let servo = &p.servo;
    let late = (f64::from(p.loop_delay()) + 0.5) * p.sample_period + 1.0 / servo.current_bandwidth;
    let velocity = motion.velocity + late * motion.acceleration;
    servo.dry_friction * (velocity / FRICTION_SPEED).clamp(-1.0, 1.0)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn torque(velocity: f64, acceleration: f64) -> f64 {
        let mut p = Parameters::START;
        p.servo.dry_friction = 0.01;
        dry_friction(&p, Trajectory { position: 0.3, velocity, acceleration })
    }

    #[test]
    fn it_has_the_sign_of_the_speed_and_is_zero_at_rest() {
        assert_eq!(torque(0.0, 0.0), 0.0);
        assert_eq!((torque(1.0, 0.0), torque(-1.0, 0.0)), (0.01, -0.01));
        assert!((torque(0.01, 0.0) - 0.005).abs() < 1e-15);
    }

    #[test]
    fn it_is_ahead_by_the_delay_half_a_sample_and_the_current_loop() {
        let p = Parameters::START;
        let late = 1.5e-4 + 1.0 / p.servo.current_bandwidth;
        for acceleration in [10.0, -20.0] {
            let expected = 0.01 * late * acceleration / 0.02;
            assert!((torque(0.0, acceleration) - expected).abs() < 1e-12, "{}", torque(0.0, acceleration));
        }
    }

    #[test]
    fn it_turns_before_the_motion_does() {
        // 230 us before the turn of a motion with 300 rad/s2
        assert!(torque(0.06, -300.0) < 0.0);
        assert!(torque(0.1, -300.0) > 0.0);
    }
}

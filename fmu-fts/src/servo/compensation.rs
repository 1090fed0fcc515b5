//! What the arm does beside the nominal loop and is told beforehand: the bend of its flexure, and dry friction.
//!
//! Flexure: what the hub, where the encoder is, must do for the tool to be on the path. Dry friction: its torque turns
//! with the wanted motion, at once, where feedback would have to find out.

use control_blocks::Trajectory;
use nalgebra::Complex;

use crate::interface::Parameters;

/// Up to this share of the natural frequency the flexure is compensated; above, as there.
const SHARE_MAX: f64 = 0.7;

/// Motion of the hub over motion of the tool at `omega` (rad/s); 1 without compensation.
pub fn hub_over_tool(p: &Parameters, omega: f64) -> Complex<f64> {
    if !p.tip.compensation || p.tip.frequency == 0.0 {
        return Complex::new(1.0, 0.0);
    }
    let share = (omega / p.tip.frequency).clamp(-SHARE_MAX, SHARE_MAX);
    let spring = Complex::new(1.0, 2.0 * p.tip.damping * share);
    (spring - share * share) / spring
}

/// Below this speed the torque goes through zero with a slope, rad/s; so that a held arm is left in peace.
const FRICTION_SPEED: f64 = 0.02;

/// Torque (N.m) for a wanted motion of the hub, ahead by what the drive is late.
pub fn dry_friction(p: &Parameters, motion: Trajectory) -> f64 {
    let servo = &p.servo;
    let late = (f64::from(p.io_delay) + 0.5) * p.sample_period + 1.0 / servo.current_bandwidth;
    let velocity = motion.velocity + late * motion.acceleration;
    servo.dry_friction * (velocity / FRICTION_SPEED).clamp(-1.0, 1.0)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_hub_moves_less_by_the_square_of_the_frequency() {
        let mut p = Parameters::START;
        p.tip.damping = 0.0;
        assert_eq!(hub_over_tool(&p, 0.0), Complex::new(1.0, 0.0));
        let ratio = hub_over_tool(&p, 0.25 * p.tip.frequency);
        assert!((ratio - (1.0 - 0.0625)).norm() < 1e-15);
        assert_eq!(hub_over_tool(&p, 1e9), hub_over_tool(&p, 0.7 * p.tip.frequency));
    }

    #[test]
    fn hub_and_tool_are_a_spring_and_a_damper() {
        let mut p = Parameters::START;
        p.tip.damping = 0.1;
        for share in [0.1, 0.3, 0.69, -0.5] {
            // the tool is pulled by spring and damper alone: s^2 y = (w^2 + 2 d w s) (x - y)
            let (s, w) = (Complex::new(0.0, share * p.tip.frequency), p.tip.frequency);
            let (hub, tool) = (hub_over_tool(&p, share * w), Complex::new(1.0, 0.0));
            let pull = (s * 2.0 * p.tip.damping * w + w * w) * (hub - tool);
            assert!((pull / (s * s * tool) - 1.0).norm() < 1e-9, "{share}: {hub}");
        }
    }

    #[test]
    fn negative_frequencies_are_mirrored() {
        let p = Parameters::START;
        assert_eq!(hub_over_tool(&p, -2000.0), hub_over_tool(&p, 2000.0).conj());
    }

    #[test]
    fn rigid_or_not_compensated_is_one() {
        let mut p = Parameters::START;
        p.tip.compensation = false;
        assert_eq!(hub_over_tool(&p, 3000.0), Complex::new(1.0, 0.0));
        let mut p = Parameters::START;
        p.tip.frequency = 0.0;
        assert_eq!(hub_over_tool(&p, 3000.0), Complex::new(1.0, 0.0));
    }

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

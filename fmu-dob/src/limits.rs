//! Limits of an off-nominal machine.

use crate::interface::Parameters;

/// Minimum limit of the following error (m), and its ratio to the error of the hardest acceleration.
const FOLLOWING: (f64, f64) = (20e-6, 3.0);

/// Maximum distance (m) from the reference, in addition to the lag: `expert.limits.following_error`, or three times the
/// error of the delayed velocity at the hardest acceleration.
pub fn following_limit(p: &Parameters) -> f64 {
    if p.limits.following_error > 0.0 {
        return p.limits.following_error;
    }
    let braking = 2.0 * p.servo.damping * hardest(p) / (p.servo.bandwidth * p.observer.velocity_bandwidth);
    f64::max(FOLLOWING.0, FOLLOWING.1 * braking)
}

/// Hardest acceleration of a cycle, m/s2.
fn hardest(p: &Parameters) -> f64 {
    p.retract.deceleration.max(p.approach.acceleration)
}

/// Maximum disturbance (N): `expert.limits.disturbance`, or the larger of half the force of the drive and of
/// `guard.force` with the force of the hardest acceleration.
pub fn disturbance_limit(p: &Parameters) -> f64 {
    if p.limits.disturbance > 0.0 {
        return p.limits.disturbance;
    }
    f64::max(0.5 * p.stage.force_constant * p.stage.current_max, p.guard_force + p.stage.mass * hardest(p))
}

/// Maximum second difference (m) of the position: by disturbance and drive together in a sample, and by four errors of
/// `limits.jump`.
pub fn bend_limit(p: &Parameters) -> f64 {
    let force = disturbance_limit(p) + p.stage.force_constant * p.stage.current_max;
    force / p.stage.mass * p.sample_period * p.sample_period + 4.0 * p.limits.jump
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_slow_servo_and_a_hard_braking_may_be_farther_from_the_reference() {
        let near = |p: &Parameters, expected: f64| assert!((following_limit(p) / expected - 1.0).abs() < 1e-9);
        let mut p = Parameters::START;
        near(&p, 3.0 * 2.0 * 2.0 / (188.0 * 3142.0));
        p.servo.bandwidth = 50.0;
        near(&p, 3.0 * 2.0 * 2.0 / (50.0 * 3142.0));
        p.retract.deceleration = 0.2;
        near(&p, 20e-6);
        p.limits.following_error = 7e-6;
        near(&p, 7e-6);
    }

    #[test]
    fn the_disturbance_of_a_machine_is_half_its_drive_or_what_its_motion_needs() {
        let mut p = Parameters::START;
        assert_eq!(disturbance_limit(&p), 50.0);
        p.retract.deceleration = 20.0;
        assert_eq!(disturbance_limit(&p), 200.4);
        p.limits.disturbance = 7.0;
        assert_eq!(disturbance_limit(&p), 7.0);
    }

    #[test]
    fn no_force_bends_a_path_by_more_than_disturbance_and_drive_together() {
        // 150 N on 10 kg for 0.1 ms: 150 nm, and four times 10 nm
        assert!((bend_limit(&Parameters::START) / 190e-9 - 1.0).abs() < 1e-9);
    }
}

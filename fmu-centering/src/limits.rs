//! Speed and look-ahead limits of the machine, eq. 2 and 4 to 9.

use std::f64::consts::{FRAC_2_PI, FRAC_PI_2, TAU};
use std::ops::RangeInclusive;

use control_blocks::stopping_distance;

use crate::interface::{Law, Parameters};

/// Gravity as the paper takes it, m/s2.
pub const GRAVITY: f64 = 9.807;

/// From push to push, in addition to the travel of the probe to its position: settling and stroke (s), and a revolution
/// each of measuring and waiting with a tenth to spare.
const CYCLE_TIME: f64 = 5.0;
const CYCLE_REVOLUTIONS: f64 = 2.2;
/// Fraction of the friction that accelerates the rim of a ring during the ramp of the table; 0.8 remain at right angles.
const RIM_RATIO: f64 = 0.6;
/// Move of the slide that tests the probe, m (default: a thousand times its noise); and its minimum, at which a resolution
/// of 20 um does not decide.
const TRIAL_MOVE: f64 = 2e-4;
pub const TRIAL_MOVE_MIN: f64 = 1e-4;

/// Spindle speed (rad/s) at which the centrifugal force equals the friction `mu` at the eccentricity `e` m.
pub fn speed_limit(mu: f64, e: f64) -> f64 {
    // eq. 2
    (mu * GRAVITY / e).sqrt()
}

/// Largest velocity (m/s) of the surface along the probe: radius `r`, eccentricity `e` <= r (m), speed `w` (rad/s).
pub fn surface_velocity(e: f64, r: f64, w: f64) -> f64 {
    let velocity = |angle: f64| {
        let (sine, cosine) = angle.sin_cos();
        // eq. 5
        e * w.abs() * sine * (1.0 + e * cosine / (r * r - e * e * sine * sine).sqrt())
    };
    // a smooth function of the angle: its maximum within 1e-5
    (0..360).map(|k| velocity(FRAC_PI_2 * f64::from(k) / 360.0)).fold(0.0, f64::max)
}

/// Velocity (m/s) of the surface that no ring of radius `r` reaches while the friction `mu` holds it, at the speed `w`.
pub fn held_surface_velocity(mu: f64, r: f64, w: f64) -> f64 {
    // eq. 2 for the eccentricity
    let e = mu * GRAVITY / (w * w);
    surface_velocity(e.min(r), r, w)
}

/// Acceleration (rad/s2) of the commanded table speed: friction accelerates the rim of the ring.
pub fn spindle_acceleration(p: &Parameters) -> f64 {
    if p.spindle_acceleration > 0.0 {
        return p.spindle_acceleration;
    }
    RIM_RATIO * p.limits.friction * GRAVITY / p.ring.radius
}

/// Stroke (m) of the probe before the pusher that the fastest permissible approach needs.
pub fn look_ahead(p: &Parameters) -> f64 {
    // eq. 32: the axis is inside the ring
    let (e, r) = (p.ring.eccentricity_max.min(p.ring.radius), p.ring.radius);
    let surface = surface_velocity(e, r, speed_limit(p.limits.friction, e));
    // eq. 7 to 9
    stopping_distance(p.approach.velocity + surface, p.slide.acceleration_max)
}

/// Maximum duration of a cycle, s, with the spindle at `speed` rad/s.
pub fn cycle_time(p: &Parameters, speed: f64) -> f64 {
    if p.limits.cycle_time > 0.0 {
        return p.limits.cycle_time;
    }
    let revolution = TAU / speed.abs().max(p.limits.spindle_speed_min);
    // after a push that loses the ring the whole travel is repeated
    let cycle = CYCLE_TIME + p.null() / p.follow.velocity_max + CYCLE_REVOLUTIONS * revolution;
    p.approach.travel_max / p.approach.velocity + f64::from(p.limits.pushes + 1) * cycle
}

/// Bandwidth (rad/s) of the slowest servo that keeps to the limit of following: it lags by a / w^2 while it accelerates, by
/// twice that in the other direction when it reverses; with a reserve.
pub fn slowest_servo(p: &Parameters) -> f64 {
    (3.0 * p.slide.acceleration_max / p.limits.following_error).sqrt()
}

/// Damping ratios of a servo of the bandwidth w (rad/s) that this controller can work with.
///
/// Under an acceleration a that reverses with every half period the following error is (a / w^2) coth(pi zeta / (2
/// sqrt(1 - zeta^2))). It must be below `limits.following_error`. In a push the surface position is fed back by an
/// integral of the gain k, with the servo k w^2 / (s (s^2 + 2 zeta w s + w^2)): at w, where its phase is -180 degrees,
/// it is k / (2 zeta w), which must leave a factor 2; and at k, beyond which it is below 1, the servo takes atan(2 zeta
/// x / (1 - x^2)) of its phase, x = k / w, which must be at most 45 degrees.
pub fn servo_damping(p: &Parameters, bandwidth: f64) -> RangeInclusive<f64> {
    let ratio = p.slide.acceleration_max / (bandwidth * bandwidth * p.limits.following_error);
    let growth = FRAC_2_PI * ratio.min(1.0).atanh();
    let following = if growth.is_finite() { growth / (1.0 + growth * growth).sqrt() } else { 1.0 };
    let x = match p.law {
        Law::Default => p.stroke.feedback / bandwidth,
        Law::Paper => 0.0,
    };
    following.max(x)..=(1.0 - x * x) / (2.0 * x)
}

/// Travel of the slide in the test of the probe, m: half of the distance that keeps the probe on the ring; 0.2 mm suffice.
pub fn trial_move(p: &Parameters) -> f64 {
    TRIAL_MOVE.min(0.5 * (p.null() - p.dead_zone() - p.probe.contact))
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::f64::consts::TAU;

    #[test]
    fn the_papers_numbers() {
        // eq. 3: mu 0.05, e 25 mm
        let speed = speed_limit(0.05, 0.025);
        assert!((speed * 60.0 / TAU - 42.3).abs() < 0.05, "{speed}");
        // eq. 6: r 30 mm
        let surface = surface_velocity(0.025, 0.030, speed);
        assert!((surface - 0.1543).abs() < 2e-4, "{surface}");
        // eq. 9
        let mut p = Parameters::PAPER;
        p.ring.radius = 0.030;
        let distance = look_ahead(&p);
        assert!((distance - 0.0147).abs() < 5e-5, "{distance}");
    }

    #[test]
    fn without_eccentricity_the_surface_does_not_move() {
        assert_eq!(surface_velocity(0.0, 0.05, 4.0), 0.0);
        assert!(speed_limit(0.05, 0.0).is_infinite());
    }

    #[test]
    fn a_surface_that_is_too_fast_shows_a_ring_that_is_not_held() {
        // 45 rpm: 22.1 mm are held
        let w = 45.0 * TAU / 60.0;
        let maximum = held_surface_velocity(0.05, 0.05, w);
        assert!(surface_velocity(0.022, 0.05, w) < maximum && surface_velocity(0.0222, 0.05, w) > maximum);
        assert!(held_surface_velocity(0.05, 0.05, 1e-9).is_finite());
        assert!(held_surface_velocity(0.05, 0.05, 0.0).is_finite());
        // at most twice e w, for a ring whose rim is on the axis
        assert!((surface_velocity(0.05, 0.05, 1.0) - 0.1).abs() < 1e-3);
    }

    #[test]
    fn the_budget_of_a_centering_goes_with_the_speed_of_the_spindle() {
        let mut p = Parameters::START;
        // 1.25 s, and 26 cycles of 5 s, 4.5 mm at 20 mm/s and 6.6 s
        assert!((cycle_time(&p, TAU / 3.0) - 308.7).abs() < 1e-9);
        assert!((cycle_time(&p, 0.0) - 1.25 - 26.0 * (5.225 + 2.2 * TAU / 0.1)).abs() < 1e-9);
        p.limits.cycle_time = 7.0;
        assert_eq!(cycle_time(&p, 0.0), 7.0);
    }

    #[test]
    fn the_test_of_the_probe_keeps_it_on_the_ring() {
        let mut p = Parameters::START;
        assert_eq!(trial_move(&p), 2e-4);
        // 4.5 - 4.05 - 0.2 mm
        p.park.dead_zone = 4.05e-3;
        assert!((trial_move(&p) - 1.25e-4).abs() < 1e-15);
    }

    #[test]
    fn a_table_comes_to_its_speed_by_a_part_of_the_friction() {
        let mut p = Parameters::START;
        // 0.6 of 0.49 m/s2 at 50 mm
        assert!((spindle_acceleration(&p) - 5.8842).abs() < 1e-4);
        p.spindle_acceleration = 3.0;
        assert_eq!(spindle_acceleration(&p), 3.0);
    }

    #[test]
    fn both_directions_are_equally_fast() {
        assert_eq!(surface_velocity(0.01, 0.05, 4.0), surface_velocity(0.01, 0.05, -4.0));
    }

    #[test]
    fn a_servo_is_damped_enough_for_its_limits_and_not_too_much() {
        let mut p = Parameters::START;
        let range = servo_damping(&p, 200.0);
        // k / (2 zeta w) = 1/2; tan of 45 degrees is 2 zeta x / (1 - x^2)
        let x = p.stroke.feedback / 200.0;
        assert!((p.stroke.feedback / (2.0 * range.start() * 200.0) - 0.5).abs() < 1e-12, "{range:?}");
        assert!((2.0 * range.end() * x / (1.0 - x * x) - 1.0).abs() < 1e-12, "{range:?}");
        // without feedback the slide alone decides, by its largest error
        p.stroke.feedback = 0.0;
        for (bandwidth, expected) in [(slowest_servo(&p), 0.2155), (2.0 * slowest_servo(&p), 0.0530)] {
            let range = servo_damping(&p, bandwidth);
            let zeta = range.start();
            let peak = (FRAC_PI_2 * zeta / (1.0 - zeta * zeta).sqrt()).tanh().recip();
            let lag = p.slide.acceleration_max / (bandwidth * bandwidth) * peak;
            assert!((lag / p.limits.following_error - 1.0).abs() < 1e-9 && (zeta - expected).abs() < 1e-4, "{range:?}");
            assert_eq!(*range.end(), f64::INFINITY);
        }
        // a servo that is too slow at any damping, and the control law without feedback
        assert_eq!(*servo_damping(&p, 0.5 * slowest_servo(&p)).start(), 1.0);
        (p.stroke.feedback, p.law) = (60.0, Law::Paper);
        assert_eq!(*servo_damping(&p, 200.0).end(), f64::INFINITY);
    }
}

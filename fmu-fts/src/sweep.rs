//! Motion at constant speed while a calibration part is cut: grooves of equal height only change the radius of an arc.

use crate::parameters::Parameters;
use crate::quintic::Motion;

/// Time in which the speed is reached and left, s.
const RAMP_TIME: f64 = 0.02;

/// The motion one sample after `before`, towards rest at `goal` (rad), with `calibration.sweep_speed`.
pub fn sweep(p: &Parameters, before: Motion, goal: f64) -> Motion {
    let (speed, dt) = (p.calibration.sweep_speed, p.sample_period);
    let (slope, away) = (speed / RAMP_TIME, goal - before.angle);
    // less than two samples of braking
    if away.abs() <= 2.0 * slope * dt * dt && before.velocity.abs() <= 3.0 * slope * dt {
        return Motion { angle: goal, ..Motion::default() };
    }
    // what can still be stopped in time, with a fourth of the deceleration in reserve
    let wanted = speed.min((1.5 * slope * away.abs()).sqrt()).copysign(away);
    let velocity = before.velocity + (wanted - before.velocity).clamp(-slope * dt, slope * dt);
    let angle = before.angle + 0.5 * (before.velocity + velocity) * dt;
    Motion { angle, velocity, acceleration: (velocity - before.velocity) / dt }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn goes_at_constant_speed_and_stops_at_the_goal() {
        let p = Parameters::DEFAULT;
        let speed = p.calibration.sweep_speed;
        let (mut motion, mut steady, mut ticks) = (Motion { angle: 0.5, ..Motion::default() }, 0, 0);
        while motion.angle != 0.4 {
            let next = sweep(&p, motion, 0.4);
            assert!((next.velocity - motion.velocity).abs() <= 3.0 * speed / RAMP_TIME * p.sample_period);
            assert!(next.angle <= motion.angle && next.angle >= 0.4 && next.velocity.abs() <= speed);
            steady += u32::from(next.velocity == -speed);
            (motion, ticks) = (next, ticks + 1);
        }
        let shortest = 0.1 / speed / p.sample_period;
        assert!(f64::from(steady) > 0.98 * shortest && f64::from(ticks) < 1.02 * shortest, "{steady} of {ticks}");
        assert_eq!(motion, Motion { angle: 0.4, ..Motion::default() });
        assert_eq!(sweep(&p, motion, 0.4), motion);
    }

    #[test]
    fn a_motion_in_progress_is_taken_over_without_a_jump() {
        let p = Parameters::DEFAULT;
        let mut motion = Motion { angle: 0.5, velocity: 2.0 * p.calibration.sweep_speed, ..Motion::default() };
        for _ in 0..400 {
            let next = sweep(&p, motion, 1.0);
            assert!((next.velocity - motion.velocity).abs() <= 1.01 * p.calibration.sweep_speed / RAMP_TIME * 1e-4);
            motion = next;
        }
        assert_eq!(motion.velocity, p.calibration.sweep_speed);
    }
}

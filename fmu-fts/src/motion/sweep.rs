//! Motion at constant speed while a calibration part is cut: grooves of equal height only change the radius of an arc.

use control_blocks::Trajectory;

use crate::interface::Parameters;

/// Time in which the speed is reached and left, s.
const RAMP_TIME: f64 = 0.02;

/// The motion one sample after `before`, towards rest at `goal` (rad), with `expert.calibration.sweep_speed`.
pub fn sweep(p: &Parameters, before: Trajectory, goal: f64) -> Trajectory {
    let (speed, dt) = (p.calibration.sweep_speed, p.sample_period);
    let (slope, away) = (speed / RAMP_TIME, goal - before.position);
    // less than two samples of braking
    if away.abs() <= 2.0 * slope * dt * dt && before.velocity.abs() <= 3.0 * slope * dt {
        return Trajectory::resting(goal);
    }
    // what can still be stopped in time, with a fourth of the deceleration in reserve
    let target = speed.min((1.5 * slope * away.abs()).sqrt()).copysign(away);
    let mut next = before;
    next.step(target, slope, dt);
    next
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn goes_at_constant_speed_and_stops_at_the_goal() {
        let p = Parameters::START;
        let speed = p.calibration.sweep_speed;
        let (mut motion, mut steady, mut ticks) = (Trajectory::resting(0.5), 0, 0);
        while motion.position != 0.4 {
            let next = sweep(&p, motion, 0.4);
            assert!((next.velocity - motion.velocity).abs() <= 3.0 * speed / RAMP_TIME * p.sample_period);
            assert!(next.position <= motion.position && next.position >= 0.4 && next.velocity.abs() <= speed);
            steady += u32::from(next.velocity == -speed);
            (motion, ticks) = (next, ticks + 1);
        }
        let shortest = 0.1 / speed / p.sample_period;
        assert!(f64::from(steady) > 0.98 * shortest && f64::from(ticks) < 1.02 * shortest, "{steady} of {ticks}");
        assert_eq!(motion, Trajectory::resting(0.4));
        assert_eq!(sweep(&p, motion, 0.4), motion);
    }

    #[test]
    fn a_motion_in_progress_is_taken_over_without_a_jump() {
        let p = Parameters::START;
        let mut motion =
            Trajectory { position: 0.5, velocity: 2.0 * p.calibration.sweep_speed, ..Trajectory::default() };
        for _ in 0..400 {
            let next = sweep(&p, motion, 1.0);
            assert!((next.velocity - motion.velocity).abs() <= 1.01 * p.calibration.sweep_speed / RAMP_TIME * 1e-4);
            motion = next;
        }
        assert_eq!(motion.velocity, p.calibration.sweep_speed);
    }
}

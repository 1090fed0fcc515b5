//! Setpoint of the slide: a minimum-jerk motion that ends at rest.

use control_blocks::{Quintic, Trajectory, quintic_duration};
use serde::{Deserialize, Serialize};

use crate::interface::Parameters;

/// A motion and the time since its start.
#[derive(Clone, Debug, Serialize, Deserialize)]
pub struct Setpoint {
    path: Quintic,
    /// s
    elapsed: f64,
}

impl Setpoint {
    /// At rest at `position`, m.
    pub fn resting(position: f64) -> Self {
        Self { path: Quintic::resting(position), elapsed: 0.0 }
    }

    /// Position (m) of this sample with its derivatives.
    pub fn at(&self) -> Trajectory {
        self.path.at(self.elapsed)
    }

    /// Whether the motion is complete, or the setpoint is at rest.
    pub fn over(&self) -> bool {
        let now = self.at();
        now.velocity == 0.0 && now.acceleration == 0.0
    }

    /// Starts the motion to the target.
    pub fn go(&mut self, p: &Parameters) {
        let distance = (p.motion.target - self.at().position).abs();
        self.begin(p.motion.target, quintic_duration(distance, p.motion.velocity_max).max(p.sample_period));
    }

    /// Starts a stop.
    pub fn stop(&mut self, p: &Parameters) {
        let now = self.at();
        // the mean velocity of a constant deceleration is half the initial velocity
        self.begin(now.position + 0.5 * now.velocity * p.motion.stop_time, p.motion.stop_time);
    }

    /// Advances by `dt` s.
    pub fn advance(&mut self, dt: f64) {
        self.elapsed += dt;
    }

    fn begin(&mut self, goal: f64, duration: f64) {
        *self = Self { path: Quintic::new(self.at(), goal, duration), elapsed: 0.0 };
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const P: Parameters = Parameters::START;

    /// Largest velocity (m/s) until the motion is over, and where it ends, m.
    fn run(setpoint: &mut Setpoint) -> (f64, f64) {
        let mut fastest = 0.0_f64;
        for _ in 0..10_000 {
            setpoint.advance(P.sample_period);
            fastest = fastest.max(setpoint.at().velocity.abs());
        }
        (fastest, setpoint.at().position)
    }

    #[test]
    fn a_motion_keeps_its_velocity_and_ends_on_the_target() {
        let mut setpoint = Setpoint::resting(0.01);
        setpoint.go(&P);
        let (fastest, end) = run(&mut setpoint);
        assert!((fastest / P.motion.velocity_max - 1.0).abs() < 1e-4, "{fastest}");
        assert_eq!(end, P.motion.target);
        assert!(setpoint.over());
    }

    #[test]
    fn a_stop_is_never_faster_than_the_motion_before() {
        let mut setpoint = Setpoint::resting(0.0);
        setpoint.go(&P);
        (0..469).for_each(|_| setpoint.advance(P.sample_period));
        let before = setpoint.at();
        setpoint.stop(&P);
        let (fastest, end) = run(&mut setpoint);
        assert!(fastest <= before.velocity && end > before.position && end < P.motion.target);
    }

    #[test]
    fn a_motion_to_the_current_position_has_no_length() {
        let mut setpoint = Setpoint::resting(P.motion.target);
        setpoint.go(&P);
        assert_eq!(run(&mut setpoint), (0.0, P.motion.target));
    }
}

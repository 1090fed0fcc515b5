//! Motion to `hold_angle`: a quintic whenever the wanted angle changes, continuous from any motion.

use control_blocks::{Quintic, Trajectory, quintic_duration};
use serde::{Deserialize, Serialize};

use crate::interface::Parameters;

/// The motion in progress.
#[derive(Clone, Debug, Serialize, Deserialize)]
pub struct HoldMotion {
    quintic: Quintic,
    ticks: u32,
}

impl HoldMotion {
    /// At rest at an angle (rad).
    pub fn at(angle: f64) -> Self {
        Self { quintic: Quintic::resting(angle), ticks: 0 }
    }

    /// Starts from `motion` to rest at `goal` (rad).
    pub fn go(&mut self, p: &Parameters, motion: Trajectory, goal: f64) {
        let distance = (goal - motion.position).abs();
        let duration = f64::max(p.approach_time, quintic_duration(distance, p.hold_speed));
        *self = Self { quintic: Quintic::new(motion, goal, duration), ticks: 0 };
    }

    /// Reference (rad) of this sample; `goal` is the wanted angle.
    pub fn step(&mut self, p: &Parameters, goal: f64) -> Trajectory {
        if goal != self.quintic.goal() {
            let motion = self.now(p);
            self.go(p, motion, goal);
        }
        self.coast(p)
    }

    /// Goes on to the angle that was wanted last.
    pub fn coast(&mut self, p: &Parameters) -> Trajectory {
        self.ticks = self.ticks.saturating_add(1);
        self.now(p)
    }

    /// Whether the motion has come to its end.
    pub fn arrived(&self, p: &Parameters) -> bool {
        self.quintic.over(f64::from(self.ticks) * p.sample_period)
    }

    fn now(&self, p: &Parameters) -> Trajectory {
        self.quintic.at(f64::from(self.ticks) * p.sample_period)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn keeps_the_speed_and_arrives() {
        let p = Parameters::START;
        let mut hold = HoldMotion::at(0.0);
        let mut fastest: f64 = 0.0;
        for _ in 0..20_000 {
            assert!(!hold.arrived(&p) || fastest > 0.0);
            fastest = fastest.max(hold.step(&p, 1.0).velocity.abs());
        }
        assert!((fastest - p.hold_speed).abs() < 1e-6, "{fastest}");
        assert!(hold.arrived(&p));
        assert_eq!(hold.step(&p, 1.0), Trajectory::resting(1.0));
    }

    #[test]
    fn a_new_goal_on_the_way_is_reached_without_a_jump() {
        let p = Parameters::START;
        let mut hold = HoldMotion::at(0.0);
        let mut before = Trajectory::default();
        for k in 0..20_000 {
            let now = hold.step(&p, if k < 700 { 0.2 } else { -0.3 });
            let predicted = before.position + 0.5 * (before.velocity + now.velocity) * p.sample_period;
            assert!((now.position - predicted).abs() < 1e-8, "sample {k}");
            assert!((now.velocity - before.velocity).abs() < 0.02, "sample {k}");
            before = now;
        }
        assert_eq!(before.position, -0.3);
    }
}

//! Motion onto the moving path: the held motion fades out, the path fades in, on a quintic.

use control_blocks::{Trajectory, minimum_jerk, minimum_jerk_rates};
use serde::{Deserialize, Serialize};

use crate::interface::Parameters;

/// How much of the path is in the motion, with its derivatives to the time.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Blend {
    /// Share of the path, 0 to 1.
    pub share: f64,
    /// First derivative, 1/s.
    pub first: f64,
    /// Second derivative, 1/s2.
    pub second: f64,
}

impl Blend {
    /// On the path.
    pub const FULL: Self = Self { share: 1.0, first: 0.0, second: 0.0 };

    /// From `held` to `path`.
    pub fn motion(&self, held: Trajectory, path: Trajectory) -> Trajectory {
        let (angle, velocity) = (path.position - held.position, path.velocity - held.velocity);
        let acceleration = path.acceleration - held.acceleration;
        Trajectory {
            position: held.position + self.share * angle,
            velocity: held.velocity + self.share * velocity + self.first * angle,
            acceleration: held.acceleration
                + self.share * acceleration
                + 2.0 * self.first * velocity
                + self.second * angle,
        }
    }
}

/// Progress of the motion; by default at its beginning.
#[derive(Clone, Debug, Default, Serialize, Deserialize)]
pub struct Transition {
    ticks: u32,
}

impl Transition {
    /// One sample farther.
    pub fn step(&mut self, p: &Parameters) -> Blend {
        self.ticks = self.ticks.saturating_add(1);
        if self.arrived(p) {
            return Blend::FULL;
        }
        // begins and ends with no velocity and no acceleration
        let s = self.time(p);
        let [first, second] = minimum_jerk_rates(s, 1.0 / p.approach_time);
        Blend { share: minimum_jerk(s), first, second }
    }

    /// Whether the path is reached.
    pub fn arrived(&self, p: &Parameters) -> bool {
        self.time(p) >= 1.0
    }

    fn time(&self, p: &Parameters) -> f64 {
        f64::from(self.ticks) * p.sample_period / p.approach_time
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn begins_with_the_held_motion_and_ends_on_the_path() {
        let p = Parameters::START;
        let path = |t: f64| Trajectory {
            position: 0.02 * (125.0 * t).sin(),
            velocity: 2.5 * (125.0 * t).cos(),
            acceleration: -312.5 * (125.0 * t).sin(),
        };
        let held = |t: f64| Trajectory { position: 0.3 - 0.1 * t, velocity: -0.1, acceleration: 0.0 };
        let mut transition = Transition::default();
        let mut before = held(0.0);
        for k in 1..=3000 {
            assert!(!transition.arrived(&p));
            let t = 1e-4 * f64::from(k);
            let now = transition.step(&p).motion(held(t), path(t));
            let predicted = before.position + 0.5e-4 * (before.velocity + now.velocity);
            assert!((now.position - predicted).abs() < 1e-7, "sample {k}");
            let predicted = before.velocity + 0.5e-4 * (before.acceleration + now.acceleration);
            assert!((now.velocity - predicted).abs() < 1e-4, "sample {k}");
            before = now;
        }
        assert!(transition.arrived(&p));
        assert!((before.position - path(0.3).position).abs() < 1e-15);
        assert_eq!(transition.step(&p), Blend::FULL);
    }
}

//! Motion onto the moving path and off it: the fraction of the path in the motion is a quintic of the time, the rest is
//! held.
//!
//! The motion stays between the path and the held angle: it overshoots neither, whatever the speed of the path. The
//! path keeps its feedforward while it fades, so that the arm follows.

use control_blocks::{Quintic, Trajectory};
use serde::{Deserialize, Serialize};

use crate::interface::Parameters;

/// How much of the path is in the motion, with its derivatives to the time.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Blend {
    /// Fraction of the path, 0 to 1.
    pub weight: f64,
    /// First derivative, 1/s.
    pub first: f64,
    /// Second derivative, 1/s2.
    pub second: f64,
}

impl Blend {
    /// From `held` to `path`.
    pub fn motion(&self, held: Trajectory, path: Trajectory) -> Trajectory {
        let (angle, velocity) = (path.position - held.position, path.velocity - held.velocity);
        let acceleration = path.acceleration - held.acceleration;
        Trajectory {
            position: held.position + self.weight * angle,
            velocity: held.velocity + self.weight * velocity + self.first * angle,
            acceleration: held.acceleration
                + self.weight * acceleration
                + 2.0 * self.first * velocity
                + self.second * angle,
        }
    }
}

/// Fraction of the path over the time; by default none.
#[derive(Clone, Debug, Serialize, Deserialize)]
pub struct Transition {
    weight: Quintic,
    ticks: u32,
}

impl Default for Transition {
    fn default() -> Self {
        // long over
        Self { weight: Quintic::resting(0.0), ticks: u32::MAX }
    }
}

impl Transition {
    /// From the present share onto the path, within `expert.approach.time`.
    pub fn approach(&mut self, p: &Parameters) {
        *self = Self { weight: Quintic::new(self.now(p), 1.0, p.approach_time), ticks: 0 };
    }

    /// From the present share off the path, within `duration` (s).
    pub fn leave(&mut self, p: &Parameters, duration: f64) {
        *self = Self { weight: Quintic::new(self.now(p), 0.0, duration), ticks: 0 };
    }

    /// One sample farther.
    pub fn step(&mut self, p: &Parameters) -> Blend {
        self.ticks = self.ticks.saturating_add(1);
        let Trajectory { position, velocity, acceleration } = self.now(p);
        Blend { weight: position, first: velocity, second: acceleration }
    }

    /// Whether the path is reached.
    pub fn arrived(&self, p: &Parameters) -> bool {
        self.over(p) && self.weight.goal() == 1.0
    }

    /// Whether nothing of the path is left.
    pub fn gone(&self, p: &Parameters) -> bool {
        self.over(p) && self.weight.goal() == 0.0
    }

    fn over(&self, p: &Parameters) -> bool {
        self.weight.over(f64::from(self.ticks) * p.sample_period)
    }

    fn now(&self, p: &Parameters) -> Trajectory {
        self.weight.at(f64::from(self.ticks) * p.sample_period)
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
        transition.approach(&p);
        for k in 1..=3000 {
            assert!(!transition.arrived(&p) && !transition.gone(&p));
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
        assert_eq!(transition.step(&p), Blend { weight: 1.0, first: 0.0, second: 0.0 });
    }

    #[test]
    fn nothing_goes_beyond_the_path_during_the_retract() {
        let p = Parameters::START;
        let mut transition = Transition::default();
        transition.approach(&p);
        (0..3000).for_each(|_| {
            transition.step(&p);
        });
        transition.leave(&p, 0.3);
        for k in 0..3000 {
            assert!(!transition.gone(&p), "sample {k}");
            let weight = transition.step(&p).weight;
            assert!((0.0..=1.0).contains(&weight), "sample {k}: {weight}");
        }
        assert!(transition.gone(&p) && !transition.arrived(&p));
    }

    #[test]
    fn the_way_back_begins_anywhere_without_a_jump() {
        let p = Parameters::START;
        for reversal in [1, 700, 1500, 2999] {
            let mut transition = Transition::default();
            let mut before = 0.0;
            for k in 0..6000 {
                if k == 0 || k == reversal {
                    if k == 0 { transition.approach(&p) } else { transition.leave(&p, 0.3) }
                }
                let weight = transition.step(&p).weight;
                assert!((weight - before).abs() < 1e-3 && (-1e-12..=1.0).contains(&weight), "{reversal} {k}: {weight}");
                before = weight;
            }
            assert!(transition.gone(&p));
        }
    }
}

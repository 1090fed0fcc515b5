//! Motion onto the moving path: the distance to it goes to zero on a quintic.

use serde::{Deserialize, Serialize};

use crate::parameters::Parameters;
use crate::quintic::{Motion, Quintic, smooth_step};

/// The distance to the path.
#[derive(Clone, Debug, Serialize, Deserialize)]
pub struct Approach {
    distance: Quintic,
    ticks: u32,
}

impl Approach {
    /// From `motion` to a path that moves like `path`.
    pub fn new(p: &Parameters, motion: Motion, path: Motion) -> Self {
        Self { distance: Quintic::new(motion - path, 0.0, p.approach.time), ticks: 0 }
    }

    /// On the path.
    pub fn done() -> Self {
        Self { distance: Quintic::resting(0.0), ticks: u32::MAX }
    }

    /// Distance to the path in this sample.
    pub fn step(&mut self, p: &Parameters) -> Motion {
        self.ticks = self.ticks.saturating_add(1);
        self.distance.at(self.time(p))
    }

    /// How much of feedforward and cancellation is put out, 0 to 1.
    pub fn blend(&self, p: &Parameters) -> f64 {
        smooth_step(self.distance.share(self.time(p)))
    }

    /// Whether the path is reached.
    pub fn arrived(&self, p: &Parameters) -> bool {
        self.distance.share(self.time(p)) >= 1.0
    }

    fn time(&self, p: &Parameters) -> f64 {
        f64::from(self.ticks) * p.sample_period
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn begins_where_the_arm_is_and_ends_on_the_path() {
        let p = Parameters::DEFAULT;
        let path = |t: f64| Motion {
            angle: 0.02 * (125.0 * t).sin(),
            velocity: 2.5 * (125.0 * t).cos(),
            acceleration: -312.5 * (125.0 * t).sin(),
        };
        let rest = Motion { angle: 0.3, ..Motion::default() };
        let mut approach = Approach::new(&p, rest, path(0.0));
        let mut before = rest;
        for k in 1..=3000 {
            assert!(!approach.arrived(&p));
            let now = path(1e-4 * f64::from(k)) + approach.step(&p);
            let predicted = before.angle + 0.5e-4 * (before.velocity + now.velocity);
            assert!((now.angle - predicted).abs() < 1e-7, "sample {k}");
            before = now;
        }
        assert!(approach.arrived(&p));
        assert_eq!(approach.blend(&p), 1.0);
        assert_eq!(approach.step(&p), Motion::default());
        assert!(Approach::done().arrived(&p));
    }
}

//! Mean force of a stage at rest, once the observer has settled.

use control_blocks::{Welford, ticks};
use serde::{Deserialize, Serialize};

use crate::interface::Parameters;

/// The observer has settled after this many times 1 / `observer.bandwidth`: exp(-6) of a force is left.
const SETTLING: f64 = 6.0;
/// Time of the mean, s: five revolutions of a spindle at 30 000 rpm.
const TIME: f64 = 0.01;

/// The mean, sample by sample.
#[derive(Clone, Copy, Debug, Default, Serialize, Deserialize)]
pub struct RestForce {
    samples: u32,
    force: Welford,
}

impl RestForce {
    /// Takes one force (N) of the stage at rest.
    pub fn update(&mut self, p: &Parameters, force: f64) {
        self.samples = self.samples.saturating_add(1);
        if self.samples > ticks(SETTLING / p.observer.bandwidth, p.sample_period) && !self.known(p) {
            self.force.push(force);
        }
    }

    /// Whether the mean is complete.
    pub fn known(&self, p: &Parameters) -> bool {
        self.samples > ticks(SETTLING / p.observer.bandwidth + TIME, p.sample_period)
    }

    /// The mean force, N.
    pub fn mean(&self) -> f64 {
        self.force.mean()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_mean_is_that_after_the_settling() {
        let p = Parameters::START;
        let mut force = RestForce::default();
        let samples = (0..1000).find(|k| {
            force.update(&p, if *k < 96 { 50.0 } else { 1.0 + 2.0 * f64::from(*k % 2) });
            force.known(&p)
        });
        // 9.6 ms and 10 ms
        assert_eq!(samples, Some(196));
        assert!((force.mean() - 2.0).abs() < 1e-12, "{}", force.mean());
        // and so it stays
        (0..100).for_each(|_| force.update(&p, 50.0));
        assert!((force.mean() - 2.0).abs() < 1e-12, "{}", force.mean());
    }
}

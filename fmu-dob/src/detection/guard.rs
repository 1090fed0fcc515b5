//! Force guard: detects a contact before the detector is armed, or one that the detector misses.

use control_blocks::{Consecutive, Welford};
use serde::{Deserialize, Serialize};

use crate::detection::monitor::ROW;
use crate::interface::Parameters;
use crate::monitoring::rest_force::RestForce;

/// Relative error of the inertial force: 30 % of mass or thrust.
const INERTIA_ERROR: f64 = 0.3;

/// Compares the force with that at rest before the approach, and from learning on with its mean just before.
#[derive(Clone, Debug, Default, Serialize, Deserialize)]
pub struct ForceGuard {
    rest: RestForce,
    settled: Welford,
    before: f64,
    row: Consecutive,
}

impl ForceGuard {
    /// Takes one notched force (N) at rest before the approach; whether their mean is known.
    pub fn tare(&mut self, p: &Parameters, notched: f64) -> bool {
        self.rest.update(p, notched);
        self.before = self.rest.mean();
        self.rest.known(p)
    }

    /// Takes one notched force (N) at constant speed before learning.
    pub fn settle(&mut self, notched: f64) {
        self.settled.push(notched);
    }

    /// From now on the reference is the mean at constant speed.
    pub fn learn(&mut self) {
        self.before = self.settled.mean();
    }

    /// Notched force without contact, N.
    pub fn before(&self) -> f64 {
        self.before
    }

    /// Whether the notched force (N) exceeds its level before by too much in [`ROW`] consecutive samples; the force of
    /// the `acceleration` (m/s2) may be a part of it.
    pub fn exceeded(&mut self, p: &Parameters, acceleration: f64, notched: f64) -> bool {
        let limit = p.guard_force + INERTIA_ERROR * p.stage.mass * acceleration;
        self.row.update(notched - self.before > limit) >= ROW
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn settled() -> ForceGuard {
        let mut guard = ForceGuard::default();
        [2.9, 3.1, 3.0].iter().for_each(|f| guard.settle(*f));
        guard.learn();
        guard
    }

    /// Samples until `force` is a contact.
    fn samples(guard: &mut ForceGuard, acceleration: f64, force: f64) -> Option<usize> {
        (1..100).find(|_| guard.exceeded(&Parameters::START, acceleration, force))
    }

    #[test]
    fn looks_only_at_the_change_and_only_at_a_push_of_three_samples() {
        assert_eq!(samples(&mut settled(), 0.0, 3.39), None);
        assert_eq!(samples(&mut settled(), 0.0, 3.41), Some(3));
        assert_eq!(samples(&mut settled(), 0.0, -9.0), None);
    }

    #[test]
    fn one_sample_below_restarts_the_count() {
        let mut guard = settled();
        let hits = [9.0, 9.0, 3.0, 9.0, 9.0, 9.0].map(|force| guard.exceeded(&Parameters::START, 0.0, force));
        assert_eq!(hits, [false, false, false, false, false, true]);
    }

    #[test]
    fn before_learning_the_force_at_rest_is_the_reference_and_inertia_is_allowed_for() {
        let mut guard = ForceGuard::default();
        while !guard.tare(&Parameters::START, 1.0) {}
        assert_eq!(guard.before(), 1.0);
        // 0.4 N, and 0.3 of 10 kg 0.05 m/s2
        assert_eq!(samples(&mut guard, 0.05, 1.54), None);
        assert_eq!(samples(&mut guard, 0.05, 1.56), Some(3));
    }
}

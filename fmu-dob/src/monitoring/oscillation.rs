//! A stage that oscillates although its reference does not accelerate: a loop at the limit of stability, below the
//! current limit.
//!
//! The inertial force of such a stage is noise, at most a quarter of `guard.force`, and temporarily the ringing of its
//! structure. Both are fast: half a period shorter than the 1 / g of the observer is not caused by the loop. After a
//! motion the force crosses zero once or twice in a loop with the margins of the check, and twice per period forever in
//! an unstable one.

use control_blocks::{Consecutive, Reversals, ticks};
use serde::{Deserialize, Serialize};

use crate::interface::Parameters;
use crate::motion::servo::OSCILLATION_TIME;

/// Changes of the inertial force from beyond `guard.force` to beyond it the other way.
#[derive(Clone, Copy, Debug, Serialize, Deserialize)]
pub struct OscillationMonitor {
    /// minimum samples of a half period, and maximum of an oscillation
    minimum: u32,
    maximum: u32,
    /// consecutive samples beyond `guard.force` on either side
    beyond: [Consecutive; 2],
    reversals: Reversals,
    count: u32,
}

impl OscillationMonitor {
    /// Nothing seen so far.
    pub fn new(p: &Parameters) -> Self {
        Self {
            minimum: ticks(p.observer.bandwidth.recip(), p.sample_period),
            maximum: ticks(OSCILLATION_TIME, p.sample_period),
            beyond: [Consecutive::NONE; 2],
            reversals: Reversals::default(),
            count: 0,
        }
    }

    /// Begins again, after an acceleration for instance.
    pub fn clear(&mut self) {
        (self.beyond, self.reversals, self.count) = ([Consecutive::NONE; 2], Reversals::default(), 0);
    }

    /// Takes the inertial force (N) of a sample; whether it has changed its side.
    pub fn update(&mut self, p: &Parameters, inertia: f64) -> bool {
        let row = self.beyond[0].update(inertia >= p.guard_force).max(self.beyond[1].update(-inertia >= p.guard_force));
        let lasting = row >= self.minimum;
        let force = if lasting { inertia } else { 0.0 };
        let before = self.count;
        self.count = self.reversals.update(force, p.guard_force, self.maximum);
        self.count > before
    }

    /// Consecutive reversals.
    pub fn count(&self) -> u32 {
        self.count
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Changes of side in 300 samples of a force that has `size` and changes its side every `half` samples, and those
    /// counted.
    fn swung(size: f64, half: u32) -> (usize, u32) {
        let p = Parameters::START;
        let mut oscillation = OscillationMonitor::new(&p);
        let sides = (0..300u32).filter(|k| {
            let side = if (k / half).is_multiple_of(2) { 1.0 } else { -1.0 };
            oscillation.update(&p, side * size * p.guard_force)
        });
        (sides.count(), oscillation.count())
    }

    #[test]
    fn an_oscillation_beyond_the_force_of_a_contact_is_counted_by_its_half_periods() {
        assert_eq!(swung(1.0, 30), (9, 9));
        assert_eq!(swung(0.99, 30), (0, 0));
    }

    #[test]
    fn what_is_quicker_than_the_observer_is_no_oscillation_of_the_loop() {
        // 1 / g is 15.9 samples
        assert_eq!([5, 15, 16].map(|half| swung(9.0, half).1), [0, 0, 17]);
    }

    #[test]
    fn an_acceleration_ends_a_run_of_samples() {
        let p = Parameters::START;
        let mut oscillation = OscillationMonitor::new(&p);
        (0..60).for_each(|k| _ = oscillation.update(&p, if k < 30 { 9.0 } else { -9.0 }));
        assert_eq!(oscillation.count(), 1);
        oscillation.clear();
        assert_eq!(oscillation.count(), 0);
    }
}

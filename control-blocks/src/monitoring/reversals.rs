//! A loop that drives its actuator from one limit to the other: the limit cycle of an unstable loop.
//!
//! A reversal is a sample at one limit, where the last sample at a limit was at the other one. A stable loop has one or
//! two in a large motion (accelerate, brake); an unstable one has two in each period forever.

use serde::{Deserialize, Serialize};

/// The last limit that was touched, and the reversals so far.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct Reversals {
    positive: Option<bool>,
    quiet: u32,
    count: u32,
}

impl Reversals {
    /// Adds one command; consecutive reversals, each at most `window` samples after the one before.
    pub fn update(&mut self, command: f64, limit: f64, window: u32) -> u32 {
        self.quiet = self.quiet.saturating_add(1);
        if self.quiet > window {
            self.count = 0;
        }
        if command.abs() >= limit {
            let positive = command > 0.0;
            if self.positive.is_some_and(|before| before != positive) {
                (self.count, self.quiet) = (self.count.saturating_add(1), 0);
            }
            self.positive = Some(positive);
        }
        self.count
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn maximum(command: impl Fn(u32) -> f64) -> Option<u32> {
        let mut reversals = Reversals::default();
        (0..1000).map(|k| reversals.update(command(k), 1.0, 100)).max()
    }

    #[test]
    fn a_limit_cycle_is_counted_by_its_half_periods() {
        // a period of 40 samples: a reversal every 20
        assert_eq!(maximum(|k| if k % 40 < 20 { 1.0 } else { -1.0 }), Some(49));
    }

    #[test]
    fn accelerate_and_brake_is_one() {
        assert_eq!(maximum(|k| if k < 200 { 1.0 } else { -1.0 }), Some(1));
    }

    #[test]
    fn below_the_limit_nothing_is_counted() {
        assert_eq!(maximum(|k| if k % 40 < 20 { 0.99 } else { -0.99 }), Some(0));
    }

    #[test]
    fn rare_reversals_are_no_oscillation() {
        assert_eq!(maximum(|k| if k % 400 < 200 { 1.0 } else { -1.0 }), Some(1));
    }
}

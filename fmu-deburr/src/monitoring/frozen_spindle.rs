//! A frozen tool speed on the path, which flickered before.
//!
//! A valid speed flickers by its noise and its last bit. Its longest constant interval by chance is measured while the
//! tool idles before the path. One that is constant for ten times as long is frozen, at idle or under load. A speed
//! that never flickers gives no evidence, nor does one that flickers between two adjacent steps: in the middle of a
//! step it may be constant. A tool under load may have any speed. Therefore its reversals and their rarity are used,
//! and not every change.

use serde::{Deserialize, Serialize};

use crate::interface::{Fault, Parameters};
use crate::monitoring::finding::{Finding, Numbers};

/// Shortest constant interval that is a fault, s (default; three time constants of the tool).
const FROZEN_MIN: f64 = 0.5;
/// Constant interval that is a fault, in the longest interval without a reversal (derived: n samples consecutive have
/// the chance p^n; if the longest comes once in fifty samples, this comes once in 50^10).
const LONGER: u32 = 10;
/// Smallest change that is a reversal, in the smallest change that was read: two steps.
const REVERSAL: f64 = 1.5;
/// Samples and reversals that have to show it.
const OBSERVED_MIN: u32 = 50;
const REVERSALS_MIN: u32 = 3;

/// The tool measurement between two samples.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct FrozenSpindle {
    before: Option<f64>,
    /// smallest change that was read, rad/s
    bit: f64,
    /// extreme speed since the last reversal (rad/s), and whether it increased
    farthest: f64,
    up: bool,
    /// samples since it changed, and since it turned from up to down or back: a tool that starts does not flicker
    still: u32,
    steady: u32,
    /// samples before the path since the first reversal, number of reversals, and the longest interval between two
    observed: u32,
    reversals: u32,
    longest: u32,
}

impl Default for FrozenSpindle {
    /// Nothing read.
    fn default() -> Self {
        Self {
            before: None,
            bit: f64::MAX,
            farthest: 0.0,
            up: true,
            still: 0,
            steady: 0,
            observed: 0,
            reversals: 0,
            longest: 0,
        }
    }
}

impl FrozenSpindle {
    /// Takes the tool speed (rad/s) of a sample before the path, where the tool idles.
    pub fn idles(&mut self, speed: f64) {
        let frozen = self.take(speed);
        // a tool that starts, or is stopped at the end, does not measure the interval
        if self.reversals > 0 {
            self.observed = self.observed.saturating_add(1);
            self.longest = self.longest.max(frozen.unwrap_or_default());
        }
        self.reversals = self.reversals.saturating_add(u32::from(frozen.is_some()));
    }

    /// Takes the tool speed (rad/s) of a sample on the path; what is wrong with it.
    pub fn cuts(&mut self, p: &Parameters, speed: f64) -> Finding {
        self.take(speed);
        let minimum = (FROZEN_MIN / p.sample_period).ceil() as u32;
        let maximum = minimum.max(LONGER.saturating_mul(self.longest));
        if self.observed < OBSERVED_MIN || self.reversals < REVERSALS_MIN || self.still <= maximum {
            return Finding::NONE;
        }
        let seconds = |samples: u32| f64::from(samples) * p.sample_period;
        let numbers = Numbers { value: seconds(self.still), limit: seconds(maximum), ..Numbers::START };
        Finding { fault: Fault::SpindleFrozen, numbers }
    }

    /// Takes a measurement; at a reversal the samples since the last one.
    fn take(&mut self, speed: f64) -> Option<u32> {
        let before = self.before.replace(speed);
        let change = before.map_or(0.0, |before| (speed - before).abs());
        (self.still, self.steady) = (self.still.saturating_add(1), self.steady.saturating_add(1));
        if change > 0.0 {
            (self.still, self.bit) = (0, self.bit.min(change));
        }
        if before.is_none() || (speed >= self.farthest) == self.up {
            self.farthest = speed;
            return None;
        }
        let reversals = (speed - self.farthest).abs() > REVERSAL * self.bit;
        let steady = self.steady - 1;
        if reversals {
            (self.farthest, self.up, self.steady) = (speed, !self.up, 0);
        }
        reversals.then_some(steady)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const P: Parameters = Parameters::START;

    /// Reading in sample `k` that goes up and down by two steps of `length` samples each.
    fn flickering(k: u32, length: u32) -> f64 {
        1884.0 + 0.5 * [0.0, 1.0, 2.0, 1.0][(k / length % 4) as usize]
    }

    /// Monitor after `samples` of it before the path, from the first reversal on.
    fn idled(samples: u32, length: u32) -> FrozenSpindle {
        let mut tool = FrozenSpindle::default();
        (0..4 * length + 1 + samples).for_each(|k| tool.idles(flickering(k, length)));
        tool
    }

    /// Sample on the path in which a speed that is constant from the first one on is a fault.
    fn detected(mut tool: FrozenSpindle) -> Option<(u32, Finding)> {
        (0..1000).map(|k| (k, tool.cuts(&P, 1850.0))).find(|(_, found)| found.is_fault())
    }

    #[test]
    fn one_that_flickered_and_freezes_is_reported_after_half_a_second() {
        let (after, found) = detected(idled(50, 1)).unwrap();
        // the first sample on the path is a change
        assert_eq!((after, found.fault, found.numbers.axis), (51, Fault::SpindleFrozen, 0));
        assert!((found.numbers.value - 0.51).abs() < 1e-9 && (found.numbers.limit - 0.5).abs() < 1e-9);
    }

    #[test]
    fn one_that_is_constant_at_times_may_be_constant_for_ten_times_as_long() {
        // 17 samples from a reversal to the next
        assert_eq!(detected(idled(90, 9)).unwrap().0, 171);
    }

    #[test]
    fn how_long_the_tool_took_to_start_is_no_measure() {
        let mut tool = FrozenSpindle::default();
        (0..300).for_each(|k| tool.idles(7.0 * f64::from(k)));
        (0..60).for_each(|k| tool.idles(flickering(k, 1)));
        assert_eq!(detected(tool).unwrap().0, 51);
        // nor is it seen for longer by that
        let mut tool = FrozenSpindle::default();
        (0..300).for_each(|k| tool.idles(7.0 * f64::from(k)));
        (0..20).for_each(|k| tool.idles(flickering(k, 1)));
        assert_eq!(detected(tool), None);
    }

    #[test]
    fn one_that_freezes_before_the_path_is_reported_there() {
        let mut tool = idled(100, 1);
        (0..200).for_each(|_| tool.idles(1850.0));
        assert!(tool.cuts(&P, 1850.0).is_fault());
    }

    #[test]
    fn one_that_never_flickers_or_was_seen_for_too_short_shows_nothing() {
        assert_eq!(detected(idled(300, 1000)), None);
        assert_eq!(detected(idled(49, 1)), None);
        // two adjacent steps
        let mut tool = FrozenSpindle::default();
        (0..100).for_each(|k| tool.idles(1884.0 + 0.5 * f64::from(k % 2)));
        assert_eq!(detected(tool), None);
        // a tool that starts
        let mut tool = FrozenSpindle::default();
        (0..100).for_each(|k| tool.idles(18.84 * f64::from(k)));
        assert_eq!(detected(tool), None);
    }

    #[test]
    fn three_reversals_show_how_long_it_may_be_constant_and_two_do_not() {
        // one in 40 samples, the first in the 80th: 39 consecutive without
        let after = |samples: u32| {
            let mut tool = FrozenSpindle::default();
            (0..=samples).for_each(|k| tool.idles(flickering(k, 20)));
            detected(tool).map(|(k, _)| k)
        };
        assert_eq!([159, 160].map(after), [None, Some(391)]);
    }

    #[test]
    fn one_that_flickers_on_the_path_lives() {
        let mut tool = idled(100, 1);
        for k in 0..10_000 {
            assert!(!tool.cuts(&P, 1850.0 + 0.5 * f64::from(k / 50 % 2)).is_fault(), "{k}");
        }
    }
}

//! Noise of one measurement as the residuals have it: their median, which dirt hardly moves, beside what was told.
//!
//! What was told may be wrong by a factor, either way, so it is the logarithms that are averaged.

use serde::{Deserialize, Serialize};

/// Measurements that what was told is worth (our choice: a twentieth of a revolution at 20 rpm and 66 Hz).
const TOLD: f64 = 10.0;
/// Measurements that all before a push are worth after it (our choice: half a revolution).
const MEMORY: f64 = 100.0;
/// Least share of what was known so far that is believed: steps of an encoder may all be the same.
const LEAST: f64 = 0.1;
/// Standard deviation over the median of the magnitude, of a normal distribution.
const OVER_MEDIAN: f64 = 1.4826;
/// Variance of a deviation that the median tells over that of one that all squares tell, of a normal distribution.
const OF_MEDIAN: f64 = 2.72;

/// Standard deviation of one measurement, and how many measurements it is worth.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct Noise {
    /// Standard deviation, m.
    pub sigma: f64,
    worth: f64,
}

impl Noise {
    /// As the parameters tell it, m.
    pub const fn told(sigma: f64) -> Self {
        Self { sigma, worth: TOLD }
    }

    /// After measurements whose residuals have the median magnitude `median` (m) beside a model that takes `free` of the `count`
    /// for itself; no more than `most` (m).
    #[must_use]
    pub fn after(&self, median: f64, count: f64, free: f64, most: f64) -> Self {
        let left = count - free;
        if left <= 0.0 {
            return *self;
        }
        // a fit makes its residuals smaller by what it is free to take
        let found = OVER_MEDIAN * median * (count / left).sqrt();
        let worth = self.worth + left;
        let sigma = self.sigma * (found / self.sigma).max(LEAST).powf(left / worth);
        Self { sigma: sigma.min(most), worth }
    }

    /// For what comes after a push: the ring is the same, but what was measured may have been a quiet part of it.
    #[must_use]
    pub fn remembered(&self) -> Self {
        Self { worth: self.worth.min(MEMORY), ..*self }
    }

    /// Standard deviation of `sigma` itself, m.
    pub fn deviation(&self) -> f64 {
        self.sigma * (OF_MEDIAN / (2.0 * self.worth)).sqrt()
    }
}

/// Median of some magnitudes, which are brought into another order; 0 of none.
pub fn median(magnitudes: &mut [f64]) -> f64 {
    let middle = magnitudes.len() / 2;
    if magnitudes.is_empty() { 0.0 } else { *magnitudes.select_nth_unstable_by(middle, f64::total_cmp).1 }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_was_told_and_what_was_found_meet_by_their_worth() {
        // as many measurements as what was told is worth, of four times the deviation
        let noise = Noise::told(1e-7).after(4e-7 / OVER_MEDIAN, TOLD, 0.0, 1.0);
        assert!((noise.sigma - 2e-7).abs() < 1e-20);
        assert_eq!(noise.worth, 2.0 * TOLD);
        // 2.72 of them tell as much as one of which the square is known
        assert!((noise.deviation() / noise.sigma - (1.36 / (2.0 * TOLD)).sqrt()).abs() < 1e-12);
    }

    #[test]
    fn what_a_fit_takes_for_itself_is_missing_in_its_residuals() {
        let noise = Noise::told(1e-7);
        let (all, half) = (noise.after(1e-7, 80.0, 0.0, 1.0), noise.after(1e-7, 80.0, 40.0, 1.0));
        assert!(half.sigma > all.sigma && half.worth < all.worth);
        // half of them are free: found is larger by the root of two
        let found = OVER_MEDIAN * 2.0_f64.sqrt();
        assert!((half.sigma - 1e-7 * found.powf(40.0 / 50.0)).abs() < 1e-20);
        // no more measurements than the model takes tell nothing
        for free in [80.0, 90.0] {
            assert_eq!(noise.after(1e-3, 80.0, free, 1.0), noise);
        }
    }

    #[test]
    fn residuals_that_are_all_the_same_make_no_ring_without_noise() {
        let noise = Noise::told(1e-7).after(0.0, 200.0, 0.0, 1.0);
        assert!((noise.sigma - 1e-7 * LEAST.powf(200.0 / 210.0)).abs() < 1e-20);
    }

    #[test]
    fn no_ring_is_rougher_than_the_roughest() {
        assert_eq!(Noise::told(1e-7).after(1.0, 200.0, 0.0, 2e-6).sigma, 2e-6);
    }

    #[test]
    fn a_push_keeps_the_noise_and_half_a_revolution_of_its_worth() {
        let long = Noise { sigma: 1e-7, worth: 300.0 };
        assert_eq!(long.remembered(), Noise { sigma: 1e-7, worth: MEMORY });
        assert_eq!(Noise::told(1e-7).remembered(), Noise::told(1e-7));
    }

    #[test]
    fn the_median_is_that_of_the_middle() {
        assert_eq!(median(&mut [5.0, 1.0, 3.0]), 3.0);
        assert_eq!(median(&mut [1e9, 1.0, 2.0, 3.0, 1e9]), 3.0);
        assert_eq!(median(&mut []), 0.0);
    }
}

//! The last positions as measured: they show a link that has fallen behind, and a wrong scale.
//!
//! When the position is suddenly n samples late, each of the next n values repeats an earlier one including its noise;
//! any other jump back has other noise. A jump by exactly n samples of motion repeats a noise of half a step by chance
//! in half of the samples.
//!
//! The second difference is force: no machine changes its path by more than its maximum force per sample. It needs no
//! velocity, so it distinguishes noise in the wrong unit from a real disturbance in the first samples. One bad sample
//! is in three differences: the fourth largest is used once more than twice as many are known.

use serde::{Deserialize, Serialize};

/// Number of stored positions.
const KEPT: usize = 32;
/// Minimum number of consecutive repeated values that is significant.
const DELAY_MIN: u32 = 3;
/// Second differences that one bad sample is in.
const SPIKE: usize = 3;

/// The last positions, the newest first, and those that repeat.
#[derive(Clone, Debug, Serialize, Deserialize)]
pub struct RecentReadings {
    readings: [f64; KEPT],
    /// where in the ring the next one goes
    next: usize,
    /// one bit per delay by which all positions since the jump were measured before
    delays: u32,
}

impl Default for RecentReadings {
    fn default() -> Self {
        Self { readings: [f64::NAN; KEPT], next: 0, delays: 0 }
    }
}

impl RecentReadings {
    /// Takes a position (m; NaN if there is none), the `doubted`th consecutive one where the stage cannot be; 0: a
    /// plausible one.
    pub fn update(&mut self, reading: f64, doubted: u32) {
        if doubted == 0 {
            self.delays = u32::MAX << DELAY_MIN;
        } else {
            let other = |delay: &u32| *delay >= doubted && self.before(*delay as usize) != reading;
            let ended = (DELAY_MIN..KEPT as u32).filter(other).fold(0, |all, delay| all | 1 << delay);
            self.delays &= !ended;
        }
        self.readings[self.next] = reading;
        self.next = (self.next + 1) % KEPT;
    }

    /// The reading `samples` before the one to come, m.
    fn before(&self, samples: usize) -> f64 {
        self.readings[(self.next + KEPT - samples) % KEPT]
    }

    /// Delay (samples) of the last positions, of which `doubted` consecutive ones are implausible; none if they are not
    /// late.
    pub fn late(&self, doubted: u32) -> Option<u32> {
        (doubted >= DELAY_MIN && self.delays != 0).then(|| self.delays.trailing_zeros())
    }

    /// Largest second difference of the positions (m); once more than six are known, without those of one bad sample.
    pub fn bend(&self) -> f64 {
        let bend = |k| self.before(k) - 2.0 * self.before(k + 1) + self.before(k + 2);
        let (mut largest, mut known) = ([0.0_f64; SPIKE + 1], 0);
        // comparing with NaN raises the flag of an invalid operation
        for mut bend in (1..=KEPT - 2).map(|k| bend(k).abs()).filter(|bend| !bend.is_nan()) {
            known += 1;
            for kept in &mut largest {
                (*kept, bend) = (kept.max(bend), kept.min(bend));
            }
        }
        largest[if known > 2 * SPIKE { SPIKE } else { 0 }]
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// 10 nm in a sample, with noise of some steps of 1 nm.
    fn position(k: u32) -> f64 {
        1e-9 * f64::from(10 * k + k * k % 7 % 3)
    }

    /// Detected delay at each of eight samples that are `late`, after the first 40 that were not.
    fn detected(late: u32, offset: f64) -> Vec<Option<u32>> {
        let mut recent = RecentReadings::default();
        (0..40).for_each(|k| recent.update(position(k), 0));
        let samples = (1..=8).map(|doubted| {
            recent.update(position(39 + doubted - late) + offset, doubted);
            recent.late(doubted)
        });
        samples.collect()
    }

    #[test]
    fn a_link_that_falls_behind_is_detected_with_its_delay_from_the_third_sample_on() {
        for late in [3, 4, 10, 31] {
            let samples = detected(late, 0.0);
            assert_eq!(samples[..2], [None, None]);
            assert!(samples[2..].iter().all(|delay| *delay == Some(late)), "{late}: {samples:?}");
        }
    }

    #[test]
    fn a_jump_whose_readings_were_not_read_before_is_not_late() {
        // later than stored, too few repeats, half a step off, and forwards
        for (late, offset) in [(32, 0.0), (2, 0.0), (10, 5e-10), (0, 1e-7)] {
            assert_eq!(detected(late, offset), [None; 8], "{late} {offset}");
        }
    }

    #[test]
    fn the_first_and_the_last_consecutive_sample_must_have_been_read_too() {
        for other in [[5e-10, 0.0, 0.0], [0.0, 0.0, 5e-10]] {
            let mut recent = RecentReadings::default();
            (0..40).for_each(|k| recent.update(position(k), 0));
            (0..3).for_each(|k| recent.update(position(37 + k) + other[k as usize], k + 1));
            assert_eq!(recent.late(3), None, "{other:?}");
        }
    }

    #[test]
    fn of_all_delays_that_explain_the_positions_the_shortest_is_detected() {
        let mut recent = RecentReadings::default();
        (0..40).for_each(|_| recent.update(0.0, 0));
        (1..=5).for_each(|doubted| recent.update(0.0, doubted));
        assert_eq!(recent.late(5), Some(3));
    }

    #[test]
    fn a_lost_reading_is_none_that_was_read_before() {
        let mut recent = RecentReadings::default();
        (1..=8).for_each(|doubted| recent.update(f64::NAN, doubted));
        assert_eq!((recent.late(8), recent.bend()), (None, 0.0));
    }

    #[test]
    fn the_fourth_largest_bend_is_kept_as_long_as_its_readings() {
        let mut recent = RecentReadings::default();
        let unit = 2f64.powi(-30);
        let bends = (0..50u32).map(|k| {
            recent.update(unit * f64::from(3 * k + u32::from([9, 19].contains(&k))), 0);
            recent.bend() / unit
        });
        let bends: Vec<f64> = bends.collect();
        // each is bent by once, twice and once: one alone is a bad sample, the fourth largest of both together is once
        assert!(bends[..19].iter().all(|bend| *bend == 0.0), "{bends:?}");
        assert_eq!(bends[19..23], [1.0, 1.0, 1.0, 1.0]);
        // the first ones are discarded one by one
        assert_eq!(bends[38..44], [1.0, 1.0, 1.0, 0.0, 0.0, 0.0]);
    }

    #[test]
    fn one_bad_sample_bends_nothing_and_noise_in_another_unit_does() {
        let mut recent = RecentReadings::default();
        (0..32).for_each(|k| recent.update(position(k) + if k == 20 { 1e-3 } else { 0.0 }, 0));
        assert!(recent.bend() < 1e-8, "{} m", recent.bend());
        let mut millimetres = RecentReadings::default();
        for k in 0..16 {
            millimetres.update(1e3 * position(k), 0);
            assert!(k < 2 || millimetres.bend() > 0.9e-6, "{k}: {} m", millimetres.bend());
        }
    }
}

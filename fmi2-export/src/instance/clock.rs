//! The tick clock: counts sample periods for any sequence of communication steps without drift.

use serde::{Deserialize, Serialize};
use std::ops::Range;

/// A position closer than this to a tick is that tick. In ticks.
pub const SNAP: f64 = 1e-6;

/// Longest communication step, in ticks: keeps a wrong step size from hanging the master.
pub const MAX_TICKS: f64 = 1e9;

/// Position in whole ticks and a fraction of one, so that hours lose no resolution.
#[derive(Clone, Copy, Debug, Serialize, Deserialize)]
pub struct Clock {
    /// Sample period, s.
    pub period: f64,
    /// Whole ticks passed since the start.
    whole: u64,
    /// Part of a tick passed since then, 0 <= fraction < 1.
    fraction: f64,
    #[serde(skip)]
    even: Even,
}

/// The last step that led from a tick to a tick: the next one is mostly as long.
#[derive(Clone, Copy, Debug)]
struct Even {
    /// Its length, s; no number before the first.
    step: f64,
    /// Its ticks.
    ticks: u64,
}

impl Default for Even {
    fn default() -> Self {
        Self { step: f64::NAN, ticks: 0 }
    }
}

impl Clock {
    pub fn new(period: f64) -> Self {
        Self { period, whole: 0, fraction: 0.0, even: Even::default() }
    }

    /// Whether a step is as long as the last one from a tick to a tick, which was right.
    #[inline]
    pub fn is_usual(&self, h: f64) -> bool {
        h == self.even.step
    }

    /// Whether the numbers make sense; restored state bytes may hold anything.
    pub fn is_sane(&self) -> bool {
        self.period.is_finite() && self.period > 0.0 && (0.0..1.0).contains(&self.fraction)
    }

    /// Moves by a communication step of `h` seconds and returns the ticks in `[here, here + h)`.
    ///
    /// Positions are rounded to a tick when within [`SNAP`], or within a thousandth of the step
    /// when that is less, so that rounding of `h` never costs a tick and tiny steps still advance.
    #[inline]
    pub fn advance(&mut self, h: f64) -> Range<u64> {
        let first = self.whole;
        if self.is_usual(h) && self.fraction == 0.0 {
            self.whole += self.even.ticks;
            return first..self.whole;
        }
        self.advance_unevenly(h)
    }

    #[cold]
    fn advance_unevenly(&mut self, h: f64) -> Range<u64> {
        let first = self.next_tick();
        let steps = h / self.period;
        let end = self.fraction + steps;
        let snap = SNAP.min(1e-3 * steps);
        // whole numbers by conversion: `round` and `floor` are library calls on plain x86-64
        let nearest = (end + 0.5) as i64;
        let (whole, fraction) =
            if (end - nearest as f64).abs() <= snap { (nearest, 0.0) } else { (end as i64, end - (end as i64) as f64) };
        if (self.fraction, fraction) == (0.0, 0.0) {
            self.even = Even { step: h, ticks: whole as u64 };
        }
        self.whole += whole as u64;
        self.fraction = fraction;
        first..self.next_tick()
    }

    /// Advances past the ticks at or before `time` and returns them; `start` is the time of the first.
    ///
    /// For importers that stop at the time of a tick, which [`next_time`](Self::next_time) returns, or less than [`SNAP`]
    /// earlier.
    pub fn come_to(&mut self, start: f64, time: f64) -> Range<u64> {
        let first = self.next_tick();
        let passed = (time - start) / self.period + SNAP;
        let passed = if passed < 0.0 { 0 } else { (passed as u64).saturating_add(1) };
        // far from the start the quotient is too coarse: compare with the time that was returned
        let returned = first + u64::from(time >= self.next_time(start));
        let end = passed.max(returned);
        (self.whole, self.fraction) = (end, 0.0);
        first..end
    }

    /// Time of the next tick; `start` is the time of the first.
    pub fn next_time(&self, start: f64) -> f64 {
        start + self.time_of(self.next_tick())
    }

    /// Present position, s from the start.
    #[inline]
    pub fn position(&self) -> f64 {
        // a signed number converts in one instruction
        (self.whole as i64 as f64 + self.fraction) * self.period
    }

    /// Seconds from the present position to a tick; negative for a tick of the past.
    pub fn until(&self, tick: u64) -> f64 {
        ((tick as f64 - self.whole as f64) - self.fraction) * self.period
    }

    /// Time of a tick since the start, s.
    pub fn time_of(&self, tick: u64) -> f64 {
        tick as f64 * self.period
    }

    fn next_tick(&self) -> u64 {
        self.whole + u64::from(self.fraction > 0.0)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn count(clock: &mut Clock, h: f64, steps: usize) -> u64 {
        (0..steps).map(|_| clock.advance(h).count() as u64).sum()
    }

    #[test]
    fn one_tick_for_each_step_of_one_period() {
        let mut clock = Clock::new(1e-4);
        for k in 0..2_000_000 {
            assert_eq!(clock.advance(1e-4), k..k + 1);
        }
    }

    #[test]
    fn thirds_tenfolds_and_odd_multiples_count_exactly() {
        assert_eq!(count(&mut Clock::new(1e-4), 1e-4 / 3.0, 3_000_000), 1_000_000);
        assert_eq!(count(&mut Clock::new(1e-4), 1e-3, 1000), 10_000);
        assert_eq!(count(&mut Clock::new(1e-4), 0.7e-4, 1_000_000), 700_000);
        assert_eq!(count(&mut Clock::new(1e-4), 3.3e-4, 100_000), 330_000);
    }

    #[test]
    fn steps_from_differences_of_rounded_times_lose_no_tick() {
        // a master that hands over t[k+1] - t[k] with t near 1e5 s
        let mut clock = Clock::new(1e-4);
        let mut ticks = 0;
        let t = |k: u64| 1e5 + k as f64 * 1e-4;
        for k in 0..100_000 {
            ticks += clock.advance(t(k + 1) - t(k)).count();
        }
        assert_eq!(ticks, 100_000);
    }

    #[test]
    fn a_shortened_last_step_runs_the_tick_at_its_start_only() {
        let mut clock = Clock::new(1e-2);
        assert_eq!(clock.advance(1e-2), 0..1);
        assert_eq!(clock.advance(1e-2 * (1.0 - 1e-7)), 1..2);
        assert_eq!(clock.advance(0.25e-2), 2..3);
        assert_eq!(clock.advance(0.25e-2), 3..3);
        assert_eq!(clock.advance(0.5e-2), 3..3);
        assert_eq!(clock.advance(1e-2), 3..4);
    }

    #[test]
    fn a_position_close_to_a_tick_is_that_tick_from_both_sides() {
        for error in [-9e-7, -1e-9, 1e-9, 9e-7] {
            let mut clock = Clock::new(1e-2);
            clock.advance(1e-2 * (1.0 + error));
            assert_eq!(clock.until(1), 0.0, "{error}");
        }
        let mut clock = Clock::new(1e-2);
        clock.advance(1e-2 * (1.0 - 1e-5));
        assert!((clock.until(1) - 1e-7).abs() < 1e-15);
    }

    #[test]
    fn tiny_steps_advance() {
        let mut clock = Clock::new(1.0);
        assert_eq!(count(&mut clock, 1e-8, 100), 1);
        assert!((clock.until(1) - (1.0 - 1e-6)).abs() < 1e-12);
    }

    #[test]
    fn an_importer_that_stops_at_the_returned_time_gets_one_tick_only() {
        for (start, period) in [(0.0, 1e-4), (0.1, 1e-4), (-3.0, 0.7e-3), (1e5, 1e-4), (1e9, 1e-7)] {
            let mut clock = Clock::new(period);
            for k in 0..10_000 {
                let time = clock.next_time(start);
                assert_eq!(clock.come_to(start, time), k..k + 1, "{start} {period}");
                assert!(clock.next_time(start) >= time);
            }
        }
    }

    #[test]
    fn nothing_is_due_between_two_ticks_and_all_that_was_passed_is() {
        let mut clock = Clock::new(1e-2);
        assert_eq!(clock.come_to(0.0, -1.0), 0..0);
        assert_eq!(clock.come_to(0.0, 0.0), 0..1);
        assert_eq!(clock.come_to(0.0, 0.0), 1..1);
        assert_eq!(clock.come_to(0.0, 0.999e-2), 1..1);
        assert_eq!(clock.come_to(0.0, 1e-2 * (1.0 - 1e-7)), 1..2);
        assert_eq!(clock.come_to(0.0, 4.5e-2), 2..5);
        assert_eq!(clock.come_to(0.0, 3e-2), 5..5);
        assert_eq!(clock.next_time(0.0), 5e-2);
    }

    #[test]
    fn tick_times_do_not_accumulate_rounding() {
        let clock = Clock::new(1e-4);
        assert_eq!(clock.time_of(36_000_000), 36_000_000.0 * 1e-4);
    }
}

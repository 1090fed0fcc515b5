//! Loops slower than the control step: counted with integers, so that no period is lost or added over any time.

use serde::{Deserialize, Serialize};

use crate::interface::Parameters;

impl Parameters {
    /// Whole samples in `time` s, rounded.
    pub fn ticks(&self, time: f64) -> u32 {
        control_blocks::ticks(time, self.sample_period)
    }
}

/// Fraction of a sample by which a period may be early: times are rounded.
const ROUNDING: f64 = 1e-6;

/// Loops that run in this step.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Due {
    /// Following and launching.
    pub control: bool,
    /// Collecting.
    pub collect: bool,
    /// Model fit.
    pub model: bool,
}

/// Counts the steps; all loops run in the first one.
#[derive(Clone, Debug, Default, Serialize, Deserialize)]
pub struct Clock {
    ticks: u64,
}

impl Clock {
    /// Loops that run in this step.
    pub fn advance(&mut self, p: &Parameters) -> Due {
        let tick = self.ticks;
        self.ticks += 1;
        let due = |rate: f64| {
            let ratio = rate * p.sample_period;
            tick == 0 || beats(tick, ratio) > beats(tick - 1, ratio)
        };
        Due { control: due(p.rates.control), collect: due(p.rates.collect), model: due(p.rates.model) }
    }

    /// Time of this step since the first, s.
    pub fn time(&self, p: &Parameters) -> f64 {
        (self.ticks - 1) as f64 * p.sample_period
    }
}

/// Periods after step 0 up to and including `tick`, at `ratio` periods per step.
fn beats(tick: u64, ratio: f64) -> u64 {
    (tick as f64 * ratio + ROUNDING) as u64
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_loop_has_its_rate_for_ever() {
        let p = Parameters::PAPER;
        // an hour, and an hour after a year
        for start in [0, 31_536_000_000] {
            let mut clock = Clock { ticks: start };
            let mut counts = [0; 3];
            for _ in 0..3_600_000 {
                let due = clock.advance(&p);
                for (count, due) in counts.iter_mut().zip([due.control, due.collect, due.model]) {
                    *count += i32::from(due);
                }
            }
            assert_eq!(counts, [360_000, 237_600, 36_000]);
        }
    }

    #[test]
    fn beats_that_do_not_divide_the_tick_are_at_most_a_tick_late() {
        let p = Parameters::PAPER;
        let mut clock = Clock::default();
        let collected: Vec<u32> = (0..1000).filter(|_| clock.advance(&p).collect).collect();
        assert_eq!(collected.len(), 66);
        for (k, tick) in collected.iter().enumerate() {
            let late = f64::from(*tick) - 1000.0 * k as f64 / 66.0;
            assert!((-1e-3..1.0).contains(&late), "beat {k}: {late} ticks late");
        }
    }

    #[test]
    fn a_loop_can_run_in_every_tick() {
        let mut p = Parameters::PAPER;
        p.rates.control = 1000.0;
        let mut clock = Clock::default();
        assert!((0..1_000_000).all(|_| clock.advance(&p).control));
    }

    #[test]
    fn the_first_tick_is_at_time_zero() {
        let p = Parameters::PAPER;
        let mut clock = Clock::default();
        for k in 0..5 {
            clock.advance(&p);
            assert_eq!(clock.time(&p), f64::from(k) * 1e-3);
        }
    }
}

//! Cutting-load control, eq. 5: the feed falls when the tool is slowed down.

use control_blocks::{Consecutive, ticks};
use serde::{Deserialize, Serialize};

use crate::interface::{Load, LoadOutput, Parameters};

/// Sample period for which K1 and K2 are specified, the paper's, s.
const PERIOD: f64 = 0.01;
/// Time at the slowest feed after which the load is too high, s: longer than a change of the feed takes to lower it.
const OVERLOAD_TIME: f64 = 0.2;

/// The regulated feed between two samples.
#[derive(Clone, Debug, Serialize, Deserialize)]
pub struct LoadControl {
    /// `V_n`, m/s
    feed: f64,
    /// `N_(n-1)`, rad/s
    before: Option<f64>,
    /// samples at the slowest feed
    slowest: Consecutive,
}

impl LoadControl {
    /// Before the first sample, at the programmed speed (m/s).
    pub fn new(programmed: f64) -> Self {
        Self { feed: programmed, before: None, slowest: Consecutive::NONE }
    }

    /// Desired feed (m/s) for the tool speed `n` (rad/s) while the feed is `realised` (m/s), at most `programmed` (m/s).
    pub fn step(&mut self, p: &Parameters, n: f64, realised: f64, programmed: f64) -> f64 {
        let Load { k1, k2, speed_min, .. } = p.load;
        let nominal = p.load.scale * p.load.spindle_speed;
        let before = self.before.replace(n).unwrap_or(n);
        // eq. 5, with the sign of K2 that damps: a falling speed lowers the feed
        let period = p.sample_period / PERIOD;
        let change = period * (-k1 * (nominal - n) / nominal - k2 * (before - n) / (p.sample_period * nominal));
        // the feed moves on from where it is: no wind-up against its acceleration
        let margin = 2.0 * p.feed.acceleration * p.sample_period;
        let from = if change < 0.0 { self.feed.min(realised + margin) } else { self.feed.max(realised - margin) };
        let minimum = speed_min.min(programmed);
        self.feed = (from + change).clamp(minimum, programmed);
        // a feed that is asked to be slow is no overload
        let free = self.feed > minimum || programmed <= speed_min;
        self.slowest.update(!free);
        self.feed
    }

    /// Outputs of the load control; only a run is overloaded.
    pub fn report(&self, p: &Parameters, runs: bool) -> LoadOutput {
        LoadOutput { feed: self.feed, overload: runs && self.overloaded(p) }
    }

    /// Whether the slowest feed is still too fast.
    fn overloaded(&self, p: &Parameters) -> bool {
        self.slowest.count() > ticks(OVERLOAD_TIME, p.sample_period)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const NOMINAL: f64 = Load::START.spindle_speed;

    #[test]
    fn without_load_the_feed_stays_at_the_programmed_speed() {
        let p = Parameters::START;
        let mut load = LoadControl::new(0.1);
        for k in 0..1000 {
            let realised = f64::min(0.1, 0.005 * f64::from(k));
            assert_eq!(load.step(&p, 1.04 * NOMINAL, realised, 0.1), 0.1);
        }
    }

    #[test]
    fn one_sample_is_eq_5() {
        let p = Parameters::START;
        let mut load = LoadControl::new(0.06);
        load.step(&p, NOMINAL, 0.06, 0.1);
        let n = 0.999 * NOMINAL;
        let expected = 0.06 - 0.092 * 0.001 - 0.0138 * 0.001 / 0.01;
        assert!((load.step(&p, n, 0.06, 0.1) - expected).abs() < 1e-12);
    }

    #[test]
    fn the_feed_falls_as_fast_at_any_sample_period() {
        let after = |period: f64| {
            let mut p = Parameters::START;
            (p.sample_period, p.feed.acceleration) = (period, 50.0);
            let mut load = LoadControl::new(0.1);
            let steps = (0.2 / period).round() as usize;
            // the tool falls by 1 % in 0.2 s
            (0..=steps).fold(0.1, |feed, k| load.step(&p, NOMINAL * (1.0 - 0.01 * k as f64 / steps as f64), feed, 0.1))
        };
        assert!((after(0.01) - after(0.001)).abs() < 2e-3 && after(0.01) < 0.085, "{} {}", after(0.01), after(0.001));
    }

    #[test]
    fn a_falling_feed_starts_where_it_is() {
        let p = Parameters::START;
        let mut load = LoadControl::new(0.1);
        load.step(&p, NOMINAL, 0.02, 0.1);
        assert!(load.step(&p, 0.99 * NOMINAL, 0.02, 0.1) < 0.03);
    }

    #[test]
    fn a_rising_feed_starts_where_it_is() {
        let p = Parameters::START;
        let mut load = LoadControl::new(0.004);
        load.step(&p, NOMINAL, 0.08, 0.1);
        // two samples of acceleration below the actual feed
        assert!(load.step(&p, 1.001 * NOMINAL, 0.08, 0.1) > 0.07);
    }

    #[test]
    fn overload_is_reported_after_a_time_at_the_slowest_feed() {
        let p = Parameters::START;
        let mut load = LoadControl::new(0.1);
        let after = (0..100).position(|_| {
            let feed = load.step(&p, 0.5 * NOMINAL, 0.004, 0.1);
            load.overloaded(&p) && feed == p.load.speed_min
        });
        assert_eq!(after, Some(20));
        load.step(&p, 1.04 * NOMINAL, 0.004, 0.1);
        assert!(!load.overloaded(&p));
        (0..100).for_each(|_| assert_eq!(load.step(&p, 1.04 * NOMINAL, 0.0, 0.0), 0.0));
        assert!(!load.overloaded(&p));
    }
}

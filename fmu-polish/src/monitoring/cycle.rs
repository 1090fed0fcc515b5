//! The time limit of a cycle: every cycle ends.

use control_blocks::{Progress, ticks};
use serde::{Deserialize, Serialize};

use crate::interface::{Parameters, State};
use crate::path::centre_path::CentrePath;

/// Planned times of the path that it may take: the overrides slow it.
const PATHS: f64 = 4.0;

/// Samples of a cycle, and how many it may have.
#[derive(Clone, Copy, Debug, Default, Serialize, Deserialize)]
pub struct CycleTime {
    progress: Progress,
    limit: u32,
}

impl CycleTime {
    /// A new cycle that may take `time` s.
    pub fn restart(&mut self, p: &Parameters, time: f64) {
        self.progress.restart();
        self.limit = ticks(time, p.sample_period);
    }

    /// Takes one sample; no state gives time back.
    pub fn update(&mut self, state: State, taring: bool) {
        if state.moving() || taring {
            self.progress.count();
        }
    }

    /// The cycle has used up its time.
    pub fn over(&self) -> bool {
        self.progress.samples() > u64::from(self.limit)
    }

    /// Time of the cycle so far and the longest one, s.
    pub fn seconds(&self, p: &Parameters) -> (f64, f64) {
        (self.progress.samples() as f64 * p.sample_period, f64::from(self.limit) * p.sample_period)
    }
}

/// Longest time of a cycle, s: `limits.cycle_time`, or what its parts may take.
pub fn budget(p: &Parameters, path: &CentrePath) -> f64 {
    if p.limits.cycle_time > 0.0 {
        return p.limits.cycle_time;
    }
    let down = p.approach.travel_max / p.approach.velocity;
    let out = p.retract.distance / p.retract.velocity;
    // settling, unloading, and until the force stays away during the retract
    p.tare_time + down + 3.0 * p.settle.time_max + out + PATHS * path.time(p)
}

#[cfg(test)]
mod tests {
    use nalgebra::Vector3;

    use super::*;
    use crate::path::cl_data::Point;

    /// 3 s of tare, 4 s down, 5 s to settle, 7 s out.
    fn cycle() -> (Parameters, CentrePath) {
        let mut p = Parameters { tare_time: 3.0, ..Parameters::START };
        (p.approach.travel_max, p.approach.velocity) = (2e-3, 0.5e-3);
        p.settle.time_max = 5.0;
        (p.retract.distance, p.retract.velocity) = (0.7e-3, 0.1e-3);
        let at = |x: f64| Point { contact: Vector3::new(x, 0.0, 0.0), normal: Vector3::z(), feed: 2e-3, line: 0 };
        let path = CentrePath::new(&p, &[at(0.0), at(10e-3), at(20e-3)]);
        (p, path)
    }

    #[test]
    fn a_cycle_has_the_time_of_all_its_parts_or_the_configured_one() {
        let (mut p, path) = cycle();
        let parts = 3.0 + 4.0 + 3.0 * 5.0 + 7.0;
        assert!((budget(&p, &path) - parts - 4.0 * path.time(&p)).abs() < 1e-9, "{}", budget(&p, &path));
        p.limits.cycle_time = 17.0;
        assert_eq!(budget(&p, &path), 17.0);
    }

    #[test]
    fn only_a_cycle_takes_time_and_it_may_take_all_of_it() {
        let (mut p, path) = cycle();
        p.limits.cycle_time = 8.0 * p.sample_period;
        let mut time = CycleTime::default();
        time.restart(&p, budget(&p, &path));
        let all = State::ALL.iter().copied();
        for (k, state) in all.clone().filter(|state| state.moving()).chain([State::Unload, State::Settle]).enumerate() {
            assert_eq!(time.seconds(&p), (k as f64 * p.sample_period, 8.0 * p.sample_period));
            time.update(state, false);
            assert!(!time.over());
        }
        all.filter(|state| !state.moving()).for_each(|state| time.update(state, false));
        assert!(!time.over());
        time.update(State::Idle, true);
        assert!(time.over());
    }
}

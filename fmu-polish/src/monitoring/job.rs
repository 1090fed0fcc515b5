//! The time that a job may take: every job ends.

use control_blocks::{Progress, ticks};
use serde::{Deserialize, Serialize};

use crate::interface::{Parameters, State};
use crate::path::centre_path::CentrePath;

/// Planned times of the path that it may take: the overrides slow it.
const PATHS: f64 = 4.0;

/// Samples of a job, and how many it may have.
#[derive(Clone, Copy, Debug, Default, Serialize, Deserialize)]
pub struct JobTime {
    progress: Progress,
    limit: u32,
}

impl JobTime {
    /// A new job along `path`.
    pub fn restart(&mut self, p: &Parameters, path: &CentrePath) {
        self.progress.restart();
        self.limit = ticks(budget(p, path), p.sample_period);
    }

    /// Takes one sample; no state gives time back.
    pub fn update(&mut self, state: State, taring: bool) {
        if state.moving() || taring {
            self.progress.count();
        }
    }

    /// The job has used up its time.
    pub fn over(&self) -> bool {
        self.progress.samples() > u64::from(self.limit)
    }

    /// Time of the job so far and the longest one, s.
    pub fn seconds(&self, p: &Parameters) -> (f64, f64) {
        (self.progress.samples() as f64 * p.sample_period, f64::from(self.limit) * p.sample_period)
    }
}

/// Longest time of a job, s: `limits.job_time`, or what its parts may take.
pub fn budget(p: &Parameters, path: &CentrePath) -> f64 {
    if p.limits.job_time > 0.0 {
        return p.limits.job_time;
    }
    let down = p.approach.travel_max / p.approach.velocity;
    let out = p.retract.distance / p.retract.velocity;
    // settling, unloading, and until the force stays away on the way out
    p.tare_time + down + 3.0 * p.settle.time_max + out + PATHS * path.time(p)
}

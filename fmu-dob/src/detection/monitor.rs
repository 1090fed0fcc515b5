//! One signal against the threshold that its noise before contact has set.

use control_blocks::Consecutive;
use serde::{Deserialize, Serialize};

use crate::detection::threshold::Statistics;
use crate::interface::{Parameters, ThresholdOutput};

/// A signal, its statistics before contact, its threshold and how often in a row it was above.
#[derive(Clone, Debug, Serialize, Deserialize)]
pub struct Monitor {
    signal: f64,
    statistics: Statistics,
    threshold: ThresholdOutput,
    row: Consecutive,
}

impl Monitor {
    /// Nothing learned so far.
    pub fn new() -> Self {
        Self {
            signal: 0.0,
            statistics: Statistics::default(),
            threshold: ThresholdOutput::START,
            row: Consecutive::NONE,
        }
    }

    /// Learns from the newest sample.
    pub fn learn(&mut self) {
        self.statistics.push(self.signal);
    }

    /// Sets the threshold from what was learned, one of `tests` signals side by side.
    pub fn arm(&mut self, p: &Parameters, tests: usize) {
        self.threshold = self.statistics.threshold(p, tests);
    }

    /// Whether the signal has been above its threshold for `threshold.row` samples in a row.
    pub fn test(&mut self, p: &Parameters) -> bool {
        let above = self.signal > self.threshold.value;
        self.row.update(above) >= p.threshold.row.unsigned_abs()
    }

    /// Forgets what was learned.
    pub fn forget(&mut self) {
        (self.statistics, self.threshold) = (Statistics::default(), ThresholdOutput::START);
    }

    /// Takes one sample of the signal.
    pub fn take(&mut self, signal: f64) {
        self.signal = signal;
    }

    /// Forgets how often in a row it was above.
    pub fn clear(&mut self) {
        self.row = Consecutive::NONE;
    }

    /// Learned statistics and threshold; all zero before they are learned.
    pub fn threshold(&self) -> ThresholdOutput {
        self.threshold
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn row_starts_again_below_the_threshold() {
        let p = Parameters::PAPER;
        let mut monitor = Monitor::new();
        monitor.threshold.value = 1.0;
        let hits: Vec<bool> = [2.0, 2.0, 0.0, 2.0, 2.0, 2.0]
            .iter()
            .map(|x| {
                monitor.signal = *x;
                monitor.test(&p)
            })
            .collect();
        assert_eq!(hits, [false, false, false, false, false, true]);
    }
}

//! Compares one signal with the threshold that was learned from its noise before contact.

use control_blocks::Consecutive;
use serde::{Deserialize, Serialize};

use crate::detection::threshold::Statistics;
use crate::interface::{Parameters, ThresholdOutput};

/// Consecutive samples above the threshold that are a contact, as in the paper: with more the depth grows by 10 nm
/// each.
pub const ROW: u32 = 3;

/// A signal, its statistics before contact, its threshold and the number of consecutive samples above it.
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

    /// Sets the threshold from what was learned.
    pub fn arm(&mut self, p: &Parameters) {
        self.threshold = self.statistics.threshold(p);
    }

    /// Whether the signal has been above its threshold for [`ROW`] consecutive samples.
    pub fn test(&mut self) -> bool {
        let above = self.signal > self.threshold.value;
        self.row.update(above) >= ROW
    }

    /// Discards what was learned.
    pub fn forget(&mut self) {
        (self.statistics, self.threshold) = (Statistics::default(), ThresholdOutput::START);
    }

    /// Takes one sample of the signal.
    pub fn take(&mut self, signal: f64) {
        self.signal = signal;
    }

    /// Restarts the count of consecutive samples above the threshold.
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
    fn counting_starts_again_below_the_threshold() {
        let mut monitor = Monitor::new();
        monitor.threshold.value = 1.0;
        let hits: Vec<bool> = [2.0, 2.0, 0.0, 2.0, 2.0, 2.0]
            .iter()
            .map(|x| {
                monitor.signal = *x;
                monitor.test()
            })
            .collect();
        assert_eq!(hits, [false, false, false, false, false, true]);
    }
}

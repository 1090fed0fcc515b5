//! Cumulative sum of the normalised innovation: collects a small change of one sign over time.

use serde::{Deserialize, Serialize};

use crate::interface::Cusum;

/// One-sided cumulative sum g = max(0, g + x - drift).
#[derive(Clone, Debug, Default, Serialize, Deserialize)]
pub struct CumulativeSum {
    sum: f64,
}

impl CumulativeSum {
    /// Takes one normalised sample; true above the alarm level.
    pub fn test(&mut self, p: &Cusum, x: f64) -> bool {
        self.sum = f64::max(0.0, self.sum + x - p.drift);
        self.sum > p.threshold
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn alarms_when_the_excess_adds_up() {
        let p = Cusum::START;
        let mut cusum = CumulativeSum::default();
        // nothing is saved up on the quiet side
        assert!((0..1000).all(|_| !cusum.test(&p, -1.0)));
        // 22 / (1.25 - 0.25) = 22 samples reach the level, the next one is above
        let ticks = (1..100).find(|_| cusum.test(&p, 1.25)).unwrap();
        assert_eq!(ticks, 23);
    }
}

//! Copy of the patterns of a bank during learning. If learning ends early, the previous patterns of the speeds that
//! are not yet learned are restored.

use serde::{Deserialize, Serialize};

use crate::bank::pattern_bank::PatternBank;
use crate::path::kinematics::{AXES, Joints};

/// Copy of the compensations of all patterns of a bank.
#[derive(Clone, Debug, Serialize, Deserialize)]
pub struct KeptPatterns {
    compensations: Vec<Vec<Joints>>,
    usable: usize,
    /// they come from the identified drives, not from before the learning
    renewed: bool,
}

impl KeptPatterns {
    /// With memory for the patterns of a bank.
    pub fn new(bank: &PatternBank) -> Self {
        let compensations = bank.planned().iter().map(|pattern| vec![[0.0; AXES]; pattern.len()]).collect();
        Self { compensations, usable: 0, renewed: false }
    }

    /// Begins to learn, from zero or from the present patterns; no pattern is usable until it is learned.
    pub fn begin(&mut self, bank: &mut PatternBank, from_bank: bool) {
        self.renewed = false;
        self.keep(bank, from_bank);
    }

    /// Continues to learn from other patterns, of which the copy replaces the previous one.
    pub fn renew(&mut self, bank: &mut PatternBank) {
        self.renewed = true;
        self.keep(bank, true);
    }

    fn keep(&mut self, bank: &mut PatternBank, from_bank: bool) {
        self.usable = bank.patterns().len();
        for (index, kept) in self.compensations.iter_mut().enumerate() {
            for (sample, kept) in bank.pattern_mut(index).samples.iter_mut().zip(kept) {
                *kept = sample.compensation;
                if !from_bank {
                    sample.compensation = [0.0; AXES];
                }
            }
        }
        bank.limit(0);
    }

    /// Ends the learning before all speeds are learned: restores the others. Returns whether any pattern is new.
    pub fn end(&self, bank: &mut PatternBank) -> bool {
        let learned = bank.patterns().len();
        for (index, kept) in self.compensations.iter().enumerate().skip(learned) {
            let samples = bank.pattern_mut(index).samples.iter_mut();
            samples.zip(kept).for_each(|(sample, kept)| sample.compensation = *kept);
        }
        bank.limit(learned.max(self.usable));
        learned > 0 || self.renewed
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::bank::pattern_bank::tests::numbered;

    #[test]
    fn learning_that_is_interrupted_leaves_what_was_there() {
        for from_bank in [false, true] {
            let mut bank = numbered(|k| k as f64);
            let mut kept = KeptPatterns::new(&bank);
            kept.begin(&mut bank, from_bank);
            assert!(bank.patterns().is_empty());
            assert_eq!(bank.pattern(3).samples[7].compensation[0], if from_bank { 7.0 } else { 0.0 });
            assert!(!kept.end(&mut bank));
            assert_eq!(bank, numbered(|k| k as f64));
            kept.begin(&mut bank, from_bank);
            bank.pattern_mut(0).samples[7].compensation = [55.0; AXES];
            bank.learned(0);
            bank.pattern_mut(1).samples[7].compensation = [66.0; AXES];
            assert!(kept.end(&mut bank));
            let values: Vec<f64> = bank.patterns().iter().map(|pattern| pattern.samples[7].compensation[0]).collect();
            assert_eq!(values, [55.0, 7.0, 7.0, 7.0, 7.0]);
        }
    }

    #[test]
    fn patterns_that_were_renewed_are_those_that_stay() {
        let mut bank = numbered(|k| k as f64);
        let mut kept = KeptPatterns::new(&bank);
        kept.begin(&mut bank, false);
        bank.fill(|pattern| pattern.samples[7].compensation = [33.0; AXES]);
        kept.renew(&mut bank);
        assert!(bank.patterns().is_empty());
        bank.pattern_mut(1).samples[7].compensation = [66.0; AXES];
        assert!(kept.end(&mut bank));
        assert_eq!(bank.patterns().len(), 5);
        assert!(bank.patterns().iter().all(|pattern| pattern.samples[7].compensation == [33.0; AXES]));
    }
}

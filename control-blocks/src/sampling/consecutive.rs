//! Consecutive samples in which a condition holds: n' = n + 1 while it holds, otherwise 0.

use serde::{Deserialize, Serialize};

/// Counter of consecutive samples; 0 before the first. It saturates at the largest number.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
pub struct Consecutive(u32);

impl Consecutive {
    /// No sample so far.
    pub const NONE: Self = Self(0);

    /// Adds one sample; the number of consecutive samples, including this one, in which the condition holds.
    pub fn update(&mut self, holds: bool) -> u32 {
        self.0 = if holds { self.0.saturating_add(1) } else { 0 };
        self.0
    }

    /// Consecutive samples until now.
    pub fn count(self) -> u32 {
        self.0
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn one_sample_without_begins_again() {
        let mut run = Consecutive::default();
        let counts = [true, true, false, true, true, true].map(|holds| run.update(holds));
        assert_eq!(counts, [1, 2, 0, 1, 2, 3]);
        assert_eq!(run.count(), 3);
    }

    #[test]
    fn years_of_samples_do_not_begin_again() {
        let mut run = Consecutive(u32::MAX);
        assert_eq!(run.update(true), u32::MAX);
    }
}

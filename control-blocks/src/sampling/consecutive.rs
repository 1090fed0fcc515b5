//! How many samples in a row a condition holds: n' = n + 1 while it does, else 0.

use serde::{Deserialize, Serialize};

/// Counter of samples in a row; none before the first. It stops at the largest number instead of starting again.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
pub struct Consecutive(u32);

impl Consecutive {
    /// No sample so far.
    pub const NONE: Self = Self(0);

    /// Takes one sample; in how many in a row, this one included, the condition holds.
    pub fn update(&mut self, holds: bool) -> u32 {
        self.0 = if holds { self.0.saturating_add(1) } else { 0 };
        self.0
    }

    /// Samples in a row until now.
    pub fn count(self) -> u32 {
        self.0
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn one_sample_without_begins_again() {
        let mut row = Consecutive::default();
        let counts = [true, true, false, true, true, true].map(|holds| row.update(holds));
        assert_eq!(counts, [1, 2, 0, 1, 2, 3]);
        assert_eq!(row.count(), 3);
    }

    #[test]
    fn years_of_samples_do_not_begin_again() {
        let mut row = Consecutive(u32::MAX);
        assert_eq!(row.update(true), u32::MAX);
    }
}

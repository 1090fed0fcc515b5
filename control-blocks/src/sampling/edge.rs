//! Rising edges of a Boolean input.

use serde::{Deserialize, Serialize};

/// Stores a Boolean input from one sample to the next; false before the first.
#[derive(Clone, Copy, Debug, Default, Serialize, Deserialize)]
pub struct Edge {
    before: bool,
}

impl Edge {
    /// Whether the input is true now and was false before.
    pub fn rises(&mut self, now: bool) -> bool {
        let before = std::mem::replace(&mut self.before, now);
        now && !before
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn only_the_first_sample_after_off_rises() {
        let mut edge = Edge::default();
        let seen: Vec<bool> = [true, true, false, true, false].map(|now| edge.rises(now)).into();
        assert_eq!(seen, [true, false, false, true, false]);
    }
}

//! Hard force guard: catches the contact that the learning phase would mistake for noise.

use control_blocks::Welford;
use serde::{Deserialize, Serialize};

/// Compares the force with its mean just before learning; before that mean exists, the deviation must do.
#[derive(Clone, Debug, Default, Serialize, Deserialize)]
pub struct ForceGuard {
    base: Welford,
}

impl ForceGuard {
    /// Takes one notched force (N) before learning into the mean.
    pub fn settle(&mut self, notched: f64) {
        self.base.push(notched);
    }

    /// Whether the notched force (N) is more than `limit` (N) above its mean.
    pub fn exceeded(&self, limit: f64, notched: f64) -> bool {
        notched - self.base.mean() > limit
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn looks_only_at_the_change_and_only_at_a_push() {
        let mut guard = ForceGuard::default();
        [2.9, 3.1, 3.0].iter().for_each(|f| guard.settle(*f));
        assert!(!guard.exceeded(0.4, 3.39));
        assert!(guard.exceeded(0.4, 3.41));
        assert!(!guard.exceeded(0.4, -9.0));
    }
}

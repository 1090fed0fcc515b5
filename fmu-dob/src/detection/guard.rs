//! Hard force guard: catches the contact that the learning phase would mistake for noise.

use control_blocks::Welford;
use serde::{Deserialize, Serialize};

use crate::interface::Guard;

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

    /// Whether the notched force (N) is too far above its mean.
    pub fn exceeded(&self, p: &Guard, notched: f64) -> bool {
        notched - self.base.mean() > p.force
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn looks_only_at_the_change_and_only_at_a_push() {
        let mut guard = ForceGuard::default();
        [2.9, 3.1, 3.0].iter().for_each(|f| guard.settle(*f));
        let p = Guard::START;
        assert!(!guard.exceeded(&p, 3.39));
        assert!(guard.exceeded(&p, 3.41));
        assert!(!guard.exceeded(&p, -9.0));
    }
}

//! Which values a controller works with: those that it was told, or those that a commission has derived.

use serde::{Deserialize, Serialize};

/// Values that a commission may replace, all of them at once.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct InForce<V> {
    told: V,
    derived: V,
    now: V,
    proposed: Option<V>,
    renewed: bool,
}

impl<V: Copy + PartialEq> InForce<V> {
    /// What was told is in force.
    pub fn new(told: V) -> Self {
        Self { told, derived: told, now: told, proposed: None, renewed: false }
    }

    /// Those that were told.
    pub fn told(&self) -> V {
        self.told
    }

    /// Those that the last good commission derives; before the first those that were told.
    pub fn derived(&self) -> V {
        self.derived
    }

    /// Those in force.
    pub fn now(&self) -> V {
        self.now
    }

    /// Whether what was told is in force.
    pub fn as_told(&self) -> bool {
        self.now == self.told
    }

    /// Proposes values, which come into force if the parameters with them fit each other.
    pub fn propose(&mut self, values: V) {
        self.proposed = Some(values);
    }

    /// What was proposed since this was last asked; asked before a sample, when the parameters are at hand to be checked with it.
    pub fn take_proposed(&mut self) -> Option<V> {
        self.proposed.take()
    }

    /// Brings values into force.
    pub fn bring(&mut self, values: V) {
        self.renewed |= values != self.now;
        self.now = values;
    }

    /// A good commission derives these; they are in force where they are to be applied, else what was told.
    pub fn conclude(&mut self, derived: V, apply: bool) {
        self.derived = derived;
        self.bring(if apply { derived } else { self.told });
    }

    /// Brings what was told back into force, and forgets what was proposed.
    pub fn restore(&mut self) {
        self.proposed = None;
        self.bring(self.told);
    }

    /// Whether other values are in force since this was last asked.
    pub fn take_renewed(&mut self) -> bool {
        std::mem::take(&mut self.renewed)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_is_derived_is_in_force_where_it_is_applied_and_what_was_told_comes_back() {
        let mut values = InForce::new(1);
        assert!(values.as_told() && !values.take_renewed() && values.derived() == 1);
        values.conclude(2, false);
        assert_eq!((values.derived(), values.now(), values.take_renewed()), (2, 1, false));
        values.conclude(3, true);
        assert_eq!((values.told(), values.derived(), values.now(), values.as_told()), (1, 3, 3, false));
        assert!(values.take_renewed() && !values.take_renewed());
        values.restore();
        assert_eq!((values.derived(), values.now(), values.take_renewed()), (3, 1, true));
    }

    #[test]
    fn what_is_proposed_is_asked_for_once_and_not_in_force() {
        let mut values = InForce::new(1);
        values.propose(2);
        assert_eq!((values.now(), values.take_proposed(), values.take_proposed()), (1, Some(2), None));
        values.propose(3);
        values.restore();
        assert_eq!((values.take_proposed(), values.take_renewed()), (None, false));
    }

    #[test]
    fn what_is_in_force_already_renews_nothing() {
        let mut values = InForce::new(1);
        values.bring(1);
        assert!(!values.take_renewed());
        values.bring(2);
        values.bring(2);
        assert!(values.take_renewed());
    }
}

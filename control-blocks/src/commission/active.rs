//! Active values of a controller: configured, or derived by a commissioning run.

use serde::{Deserialize, Serialize};

/// Values that a commissioning run may replace, all of them together.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct ActiveValues<V> {
    configured: V,
    derived: V,
    now: V,
    proposed: Option<V>,
    renewed: bool,
}

impl<V: Copy + PartialEq> ActiveValues<V> {
    /// The configured values are active.
    pub fn new(configured: V) -> Self {
        Self { configured, derived: configured, now: configured, proposed: None, renewed: false }
    }

    /// The configured values.
    pub fn configured(&self) -> V {
        self.configured
    }

    /// The values derived by the last good run; before the first the configured ones.
    pub fn derived(&self) -> V {
        self.derived
    }

    /// The active values.
    pub fn now(&self) -> V {
        self.now
    }

    /// Whether the configured values are active.
    pub fn as_configured(&self) -> bool {
        self.now == self.configured
    }

    /// Proposes values, which become active if the parameters with them fit each other.
    pub fn propose(&mut self, values: V) {
        self.proposed = Some(values);
    }

    /// Values proposed since the last call; called before a sample, when the parameters are available for the check.
    pub fn take_proposed(&mut self) -> Option<V> {
        self.proposed.take()
    }

    /// Makes values active.
    pub fn bring(&mut self, values: V) {
        self.renewed |= values != self.now;
        self.now = values;
    }

    /// Stores the values of a good run; they are active if they are to be applied, otherwise the configured ones.
    pub fn conclude(&mut self, derived: V, apply: bool) {
        self.derived = derived;
        self.bring(if apply { derived } else { self.configured });
    }

    /// Restores the configured values, and discards proposals.
    pub fn restore(&mut self) {
        self.proposed = None;
        self.bring(self.configured);
    }

    /// Whether the active values have changed since the last call.
    pub fn take_renewed(&mut self) -> bool {
        std::mem::take(&mut self.renewed)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn derived_values_are_active_where_applied_and_configured_ones_can_be_restored() {
        let mut values = ActiveValues::new(1);
        assert!(values.as_configured() && !values.take_renewed() && values.derived() == 1);
        values.conclude(2, false);
        assert_eq!((values.derived(), values.now(), values.take_renewed()), (2, 1, false));
        values.conclude(3, true);
        assert_eq!((values.configured(), values.derived(), values.now(), values.as_configured()), (1, 3, 3, false));
        assert!(values.take_renewed() && !values.take_renewed());
        values.restore();
        assert_eq!((values.derived(), values.now(), values.take_renewed()), (3, 1, true));
    }

    #[test]
    fn what_is_proposed_is_requested_once_and_not_in_force() {
        let mut values = ActiveValues::new(1);
        values.propose(2);
        assert_eq!((values.now(), values.take_proposed(), values.take_proposed()), (1, Some(2), None));
        values.propose(3);
        values.restore();
        assert_eq!((values.take_proposed(), values.take_renewed()), (None, false));
    }

    #[test]
    fn what_is_in_force_already_renews_nothing() {
        let mut values = ActiveValues::new(1);
        values.bring(1);
        assert!(!values.take_renewed());
        values.bring(2);
        values.bring(2);
        assert!(values.take_renewed());
    }
}

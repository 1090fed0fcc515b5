//! Reactions to faults.

use serde::{Deserialize, Serialize};

/// Reaction of a machine to a fault, in ascending order of severity: of two faults the more severe reaction applies
/// (`Ord::max`).
///
/// ```
/// use control_blocks::Reaction;
/// assert_eq!(Reaction::Retract.max(Reaction::DriveOff), Reaction::DriveOff);
/// ```
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Serialize, Deserialize)]
pub enum Reaction {
    /// The machine is under control and something is in its path: stop along the planned motion, then retract.
    Retract,
    /// The machine is under control and may stay where it is: stop along the planned motion and hold.
    Stop,
    /// No command is known to help: the commands are zero and the drive is disabled.
    DriveOff,
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn reactions_are_ordered_by_severity() {
        assert_eq!(Reaction::Retract.max(Reaction::DriveOff), Reaction::DriveOff);
        assert_eq!(Reaction::DriveOff.max(Reaction::Stop), Reaction::DriveOff);
        assert_eq!(Reaction::Stop.max(Reaction::Retract), Reaction::Stop);
    }
}

//! How a job ends that a fault has stopped.

use serde::{Deserialize, Serialize};

/// The gentlest first: a later fault may ask for more, and never for less (`Ord::max`).
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Serialize, Deserialize)]
pub enum SafeEnd {
    /// The machine is under control and something is in its way: stop along the planned motion, then go back.
    Retract,
    /// The machine is under control and may stay where it is: stop along the planned motion and stand there.
    Stop,
    /// Nothing that the controller could command is known to help: no command, and the drive is switched off.
    DriveOff,
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_graver_fault_asks_for_more_and_a_lighter_one_gives_nothing_back() {
        assert_eq!(SafeEnd::Retract.max(SafeEnd::DriveOff), SafeEnd::DriveOff);
        assert_eq!(SafeEnd::DriveOff.max(SafeEnd::Stop), SafeEnd::DriveOff);
        assert_eq!(SafeEnd::Stop.max(SafeEnd::Retract), SafeEnd::Stop);
    }
}

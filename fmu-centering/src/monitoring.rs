//! Monitors in addition to the control law: response of the drive, frozen probe, early contact of the pusher, and the test
//! of the probe before the ring is reported as centered.

mod drive;
mod early_contact;
mod frozen;
mod numbers;
mod trial;

pub use drive::DriveMonitor;
pub use early_contact::EarlyContact;
pub use frozen::{FrozenProbe, PRESSED_IN_PUSH, Phase};
pub use numbers::Numbers;
pub use trial::{ProbeTrial, RATIO_ERROR, plausible_ratio};

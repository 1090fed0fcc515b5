//! What is watched beside the law: the drive's answer, a probe that stands, a ring that is met too
//! early, and the test of the probe before the ring counts as centered.

mod drive;
mod early_contact;
mod frozen;
mod numbers;
mod trial;

pub use drive::DriveMonitor;
pub use early_contact::EarlyContact;
pub use frozen::{FrozenProbe, PRESSED_IN_PUSH, Phase};
pub use numbers::Numbers;
pub use trial::{ProbeTrial, SHARE_ERROR, believable_share};

//! What is watched beside the law: the drive's answer, a probe that stands, and its test before the ring counts as centred.

mod drive;
mod frozen;
mod numbers;
mod trial;

pub use drive::DriveMonitor;
pub use frozen::{FrozenProbe, PRESSED_IN_PUSH, Phase};
pub use numbers::Numbers;
pub use trial::{ProbeTrial, SHARE_ERROR, believable_share};

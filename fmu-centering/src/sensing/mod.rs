//! What the encoders tell, when it counts, and whether it can be believed.

mod calm;
mod despike;
mod drive;
mod frozen;
mod rates;
mod reading;
mod spindle;
mod trial;

pub use calm::Calm;
pub use despike::{Despiker, LAG, Measurement};
pub use drive::DriveMonitor;
pub use frozen::{FrozenProbe, PRESSED_IN_PUSH, Phase};
pub use rates::{Clock, Due};
pub use reading::{Reader, Reading, Sample};
pub use spindle::Spindle;
pub use trial::{ProbeTrial, believable_share};

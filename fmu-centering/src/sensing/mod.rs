//! What the encoders tell, when it counts, and whether it can be believed.

mod frozen;
mod rates;
mod reading;
mod spindle;

pub use frozen::Frozen;
pub use rates::{Clock, Due};
pub use reading::{Reader, Reading, Sample};
pub use spindle::Spindle;

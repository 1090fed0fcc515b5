//! Measurements of the encoders: sampling, plausibility, and the quantities that follow from them.

mod calm;
mod despike;
mod probe_delay;
mod rates;
mod reading;
mod servo;
mod spindle;

pub use calm::Calm;
pub use despike::{Despiker, LAG, Measurement};
pub use probe_delay::ProbeDelay;
pub use rates::{Clock, Due};
pub use reading::{Freedom, RESOLUTION, Reader, Reading, Sample};
pub use servo::{Fit, Servo, ServoEstimator, TERMS};
pub use spindle::Spindle;

//! The two control laws with one interface: published and default.

mod active;
mod centering;

pub use active::ActiveLaw;
pub use centering::{CenteringLaw, Conclusion, Decision, Launch, Observation};

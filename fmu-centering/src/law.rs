//! The two laws behind one face: the paper's and the default.

mod active;
mod centring;

pub use active::ActiveLaw;
pub use centring::{CentringLaw, Conclusion, Launch, Observation, Verdict};

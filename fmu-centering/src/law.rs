//! The two laws behind one face: the paper's and the default.

mod active;
mod centering;

pub use active::ActiveLaw;
pub use centering::{CenteringLaw, Conclusion, Launch, Observation, Verdict};

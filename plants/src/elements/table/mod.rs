//! Parts that rest on a turning table, probed and pushed from outside.

mod outline;
mod tip;
mod turntable;
mod wrench;

pub use outline::Outline;
pub use tip::Tip;
pub use turntable::Turntable;
pub use wrench::Wrench;

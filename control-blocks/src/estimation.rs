//! What is learned from samples, in constant time and memory.

pub mod angle;
pub mod canceller;
pub mod running_line;
pub mod welford;

//! Estimates from samples, in constant time and memory.

pub mod allan;
pub mod angle;
pub mod canceller;
pub mod least_squares;
pub mod periodic;
pub mod running_line;
pub mod welford;

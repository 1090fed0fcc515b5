//! Iterative learning control: the control patterns, how repetitions renew them, and the lookup between their speeds.

pub mod drive;
pub mod errors;
pub mod feedforward;
pub(crate) mod friction;
pub(crate) mod identification;
pub mod learner;
pub mod lookup;
pub(crate) mod nominal;
pub(crate) mod norm_optimal;
pub mod pattern;
pub mod rates;
pub(crate) mod regression;
pub mod renewal;
pub mod speeds;
pub(crate) mod zero_phase;

//! Following the path: onto it, feedforward, cancellation of what repeats, and the statistics of the error.

pub mod adaptive;
pub mod chooser;
pub mod feedforward;
pub mod phasors;
pub mod resonators;
pub mod spindle;
pub mod statistics;
pub mod tracker;
pub mod transition;

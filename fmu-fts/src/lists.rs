//! Parameters that are written as lists in a text.

pub mod frequencies;
pub mod harmonics;

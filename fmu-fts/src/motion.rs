//! Motions of the arm off the path.

pub mod ending;
pub mod hold;
pub mod sweep;

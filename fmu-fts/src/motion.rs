//! Motions of the arm beside the path.

pub mod ending;
pub mod hold;
pub mod sweep;

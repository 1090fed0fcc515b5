//! Motions of the arm beside the path.

pub mod hold;
pub mod sweep;

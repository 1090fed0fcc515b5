//! Monitors: each sees one kind of failure that a law alone would follow without a word.
//!
//! They say that something is wrong and give the number behind it; what to call it and how to end is the controller's.

pub mod following;
pub mod frozen;
pub mod jump;
pub mod progress;
pub mod response;
pub mod reversals;
pub mod reaction;

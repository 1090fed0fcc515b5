//! Monitors: each detects one kind of failure that a control law alone would follow undetected.
//!
//! They report a violation and its value; the controller names the fault and selects the reaction.

pub mod following;
pub mod frozen;
pub mod jump;
pub mod progress;
pub mod reaction;
pub mod response;
pub mod reversals;

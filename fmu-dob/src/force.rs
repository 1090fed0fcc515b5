//! From position and current to the force on the tool, eq. 1 and 2.

pub mod deviation;
pub mod notch;
pub mod observer;

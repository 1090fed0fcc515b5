//! Reference of the stage, and the servo that follows it.

pub mod depth_limit;
pub mod reference;
pub mod servo;
pub mod stability;
pub mod travel;

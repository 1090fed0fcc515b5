//! What the stage shall do, and the current that makes it do so.

pub mod depth_limit;
pub mod reference;
pub mod servo;
pub mod stability;
pub mod travel;

//! Where the part lies, found by touches: the motion that touches, what it tells, and the path that follows from it.

pub mod fit;
pub mod plan;
pub mod registrar;

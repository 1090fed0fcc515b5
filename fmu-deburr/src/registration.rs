//! Where the part lies, found by touches: the motion that touches, what it tells, and the path that follows from it.

pub mod displacement;
pub mod fit;
pub mod plan;
pub mod registrar;
pub mod touch;

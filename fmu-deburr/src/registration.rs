//! Position of the part, found by touches: the motion, its evaluation, and the displaced path.

pub mod fit;
pub mod plan;
pub mod registrar;

//! What is watched beside the law: the drive's answer, a reading at rest, the force at rest.

pub mod drive;
pub mod heard;
pub mod life;
pub mod monitors;
pub mod numbers;
pub mod rest;
pub mod rest_force;
pub mod swing;

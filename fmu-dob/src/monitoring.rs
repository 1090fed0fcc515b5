//! Monitors next to the control law: response of the drive, position at rest, force at rest, oscillation.

pub mod drive;
pub mod life;
pub mod monitors;
pub mod numbers;
pub mod oscillation;
pub mod recent;
pub mod rest;
pub mod rest_force;

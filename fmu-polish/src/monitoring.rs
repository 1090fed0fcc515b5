//! Monitors of a cycle, independent of the control laws: axes, force and time.

pub mod axis;
pub mod cycle;
pub mod force;
mod noise;
pub mod numbers;
mod oscillation;
pub mod rest;

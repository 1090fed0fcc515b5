//! Monitors of a cycle in which every control law works: axes, force and time.

pub mod axis;
pub mod cycle;
pub mod force;
mod noise;
pub mod numbers;
mod oscillation;
pub mod rest;

//! What goes wrong in a cycle although every law does its work: axes, force and time.

pub mod axis;
pub mod cycle;
pub mod force;
mod noise;
pub mod numbers;
mod oscillation;
pub mod rest;

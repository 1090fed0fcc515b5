//! The machine measured by its own controller: a bounded motion, what it tells, and what is made of it.

pub mod commissioner;
pub mod estimation;
pub mod experiment;
mod friction;
pub mod plan;
pub mod strokes;
pub mod values;

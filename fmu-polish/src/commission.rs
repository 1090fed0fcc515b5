//! The machine measured by its own controller: a bounded motion, what it tells, and what is made of it.

pub mod experiment;
pub mod identification;
pub mod plan;
pub mod response;
pub mod rubbing;
pub mod values;

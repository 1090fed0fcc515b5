//! Identification of the machine by its own controller: a bounded motion, its evaluation, and the use of the results.

pub mod commissioning_run;
pub mod estimation;
pub mod experiment;
mod friction;
pub mod plan;
pub mod strokes;
pub mod values;

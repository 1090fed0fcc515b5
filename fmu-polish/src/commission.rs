//! The commissioning run: a bounded motion, its measurements, and the derived parameters.

pub mod experiment;
pub mod identification;
pub mod plan;
pub mod response;
pub mod rubbing;
pub mod values;

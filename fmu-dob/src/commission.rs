//! The commissioning run: a bounded motion, the identification from it, and the parameters derived from that.

pub mod experiment;
pub mod identification;
pub mod noise;
pub mod plan;
pub mod response;
pub mod values;

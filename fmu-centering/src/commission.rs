//! Commissioning run: strokes of the slide before the ring, the identification of its servo, and the derived parameters.

mod experiment;
mod identification;
pub mod plan;
pub mod response;
mod values;

pub use identification::Identification;
pub use values::{DELAY_STD_MAX, STD_MAX};

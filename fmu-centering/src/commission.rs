//! The machine measured by its own controller: strokes of the slide before the ring, what they tell, and what is made of it.

mod commissioner;
mod experiment;
pub mod plan;
pub mod response;
mod values;

pub use commissioner::Commissioner;

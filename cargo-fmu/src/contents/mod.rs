//! The content of an FMU in addition to its library and description: what people and tools see of it.

pub mod chapters;
pub mod guide;
pub mod licences;
mod markup;
pub mod picture;
pub mod reference;
pub mod sources;
mod state_chart;
pub mod terminals;

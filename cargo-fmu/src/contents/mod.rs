//! What an FMU holds beside its library and description: what people and tools are shown of it.

pub mod guide;
pub mod licences;
mod markup;
pub mod picture;
pub mod reference;
mod sources;
mod state_chart;
pub mod terminals;

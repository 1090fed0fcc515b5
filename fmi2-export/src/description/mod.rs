//! The files that a library describes itself with.

mod block_diagram;
mod cells;
pub mod documentation;
pub mod files;
pub mod model_description;
pub mod pages;
mod xml;

//! Blocks that at least two of the controllers share, one per file. They know neither FMI nor any controller.
#![forbid(unsafe_code)]

pub mod edge;
pub mod input;
pub mod parameter_error;
pub mod trajectory;

pub use edge::Edge;
pub use input::believable;
pub use parameter_error::{ParameterError, require};
pub use trajectory::{Trajectory, stopping_distance};

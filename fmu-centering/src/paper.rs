//! The published control law: one revolution of data, one sine, one push, repeated.

mod crossing;
mod kalman;
mod law;
mod model;
mod offset;
mod plan;
mod push;

pub use law::PaperLaw;
